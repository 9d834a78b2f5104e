/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a tier that was asked for would ignore is refused, with its key and the tier, by run, check
 * and study; what it can do, and the deck's name alone, are no conflict. */
#include <stdio.h>
#include <string.h>

#include "program.h"

static const struct {
  const char *key, *value;
} KEYS[] = {{"circuit.r1", "100 ohm"},
            {"circuit.off_resistance", "1 Mohm"},
            {"circuit.thyristor", "latch"},
            {"supply.resistance", "0 ohm"},
            {"supply.inductance", "0.5 mH"},
            {"run.method", "gear"},
            {"run.trtol", "7"},
            {"run.first_step", "1e-7"},
            {"run.pivrel", "0.05"},
            {"run.leave_circuit", "never"}};

/* Its key stands at line 4, or, in a section of its own, at line 5, column 3. */
static void write_scene(const char *tier, const char *key, const char *value) {
  char section[32], text[256];
  const char *dot = strchr(key, '.');
  snprintf(section, sizeof section, "%.*s:\n", (int)(dot - key), key);
  bool run = !strcmp(section, "run:\n");
  snprintf(text, sizeof text, "run:\n  until: 20 ms\n  tier: %s\n%s  %s: %s\n", tier,
           run ? "" : section, dot + 1, value);
  write_file("s.yaml", text);
}

static void refuse_key(const char *key, const char *value, const char *tier) {
  char name[32], at[64], words[128];
  const char *says[] = {key, name};
  snprintf(name, sizeof name, "tier %s", tier);
  snprintf(at, sizeof at, "s.yaml:%d:3: %s: ", strncmp(key, "run", 3) ? 5 : 4, key);
  write_scene(tier, key, value);
  refuse("run s.yaml -o out", key, at, says, __LINE__);
  ran r = run("check s.yaml");
  EXPECT(r.status == 2 && strstr(r.err, at), "check: %d, %s", r.status, r.err);
  free_ran(&r);
  write_scene("auto", key, value);
  snprintf(words, sizeof words, "run s.yaml -o out --tier %s", tier);
  refuse(words, key, at, says, __LINE__);
  snprintf(words, sizeof words, "run paper -o out --tier %s --set '%s=%s'", tier, key, value);
  snprintf(at, sizeof at, "--set %s=", key);
  refuse(words, key, at, says, __LINE__);
  remove("s.yaml");
}

static void keys_of_the_circuit(void) {
  for (size_t k = 0; k < COUNT(KEYS); k++) {
    refuse_key(KEYS[k].key, KEYS[k].value, "switched");
    refuse_key(KEYS[k].key, KEYS[k].value, "analytic");
  }
}

/* Of events an ideal thyristor can do some. */
static void kinds_of_events(void) {
  static const struct {
    const char *kind, *keys;
    bool ideal;
  } KINDS[] = {{"surge", "at: 5 ms", false},
               {"ring_wave", "at: 5 ms", false},
               {"eft", "at: 5 ms", false},
               {"open", "at: 5 ms, element: R1", false},
               {"short", "at: 5 ms, element: R1", false},
               {"coil_short", "at: 5 ms", false},
               {"weak_pulse", "cycle: 1", false},
               {"sag", "at: 5 ms", true},
               {"swell", "at: 5 ms", true},
               {"interruption", "at: 7 ms, duration: 0.1 ms", true},
               {"notch", "at: 5 ms", true},
               {"phase_jump", "at: 5 ms", true},
               {"harmonic", "at: 5 ms", true},
               {"missing_pulse", "cycle: 1", true},
               {"short_pulse", "cycle: 1", true},
               {"spurious_pulse", "at: 3 ms", true},
               {"jam", "at: 7 ms", true}};
  static const char *const TIERS[] = {"switched", "analytic"};
  for (size_t k = 0; k < COUNT(KINDS); k++)
    for (size_t n = 0; n < COUNT(TIERS); n++) {
      char text[256], tier[32];
      const char *says[] = {KINDS[k].kind, tier};
      snprintf(tier, sizeof tier, "tier %s", TIERS[n]);
      snprintf(text, sizeof text, "run: {until: 10 ms, tier: %s}\nevents:\n  e1: {kind: %s, %s}\n",
               TIERS[n], KINDS[k].kind, KINDS[k].keys);
      write_file("s.yaml", text);
      if (KINDS[k].ideal) {
        RUN_GOOD("run s.yaml -o out");
        remove_tree("out");
      } else
        refuse("run s.yaml -o out", KINDS[k].kind, "s.yaml:3:3: events.e1: ", says, __LINE__);
      ran r = run("check s.yaml");
      EXPECT(r.status == (KINDS[k].ideal ? 0 : 2), "check, %s: %d, %s", KINDS[k].kind, r.status,
             r.err);
      free_ran(&r);
    }
  remove("s.yaml");
}

/* One thyristor has one gate. */
static void another_gate(void) {
  static const char *const SAYS[] = {"gate+180deg", "tier switched"};
  write_file("s.yaml", "circuit: {deck: fullwave_antiparallel}\nrun: {until: 10 ms}\n"
                       "events: {e: {kind: missing_pulse, cycle: 1, gate: gate+180deg}}\n");
  refuse("run s.yaml -o out --tier switched", "a gate", "s.yaml:3:10: events.e.gate: ", SAYS,
         __LINE__);
  remove("s.yaml");
}

/* Every one of them at once, each at its place. */
static void check_tells_all(void) {
  write_file("s.yaml", "run: {tier: switched, method: gear, until: 0.1 s}\n"
                       "circuit: {deck: halfwave_bare, on_voltage: 0 V}\n"
                       "supply: {resistance: 0 ohm}\n"
                       "events:\n"
                       "  s: {kind: surge, at: 20 ms}\n"
                       "  g: {kind: sag, at: 30 ms}\n");
  ran r = run("check s.yaml --json");
  CU_ASSERT_EQUAL(r.status, 2);
  static const char *const SAYS[] = {"\"line\": 1, \"column\": 23, \"message\": \"run.method",
                                     "\"line\": 2, \"column\": 32, \"message\": \"circuit.on_volt",
                                     "\"line\": 3, \"column\": 10, \"message\": \"supply.resist",
                                     "\"line\": 5, \"column\": 3, \"message\": \"events.s"};
  for (size_t k = 0; k < COUNT(SAYS); k++)
    EXPECT(strstr(r.out, SAYS[k]), "not there: %s; %s", SAYS[k], r.out);
  CU_ASSERT_PTR_NULL(strstr(r.out, "events.g"));
  free_ran(&r);
  remove("s.yaml");
}

static void no_conflict(void) {
  RUN_GOOD("run paper --quiet --tier switched --set circuit.deck=halfwave_bare "
           "--set run.until=9ms");
  RUN_GOOD("run paper --quiet --tier circuit --set circuit.r1=99ohm --set run.tier=switched "
           "--set run.until=9ms");
  RUN_GOOD("run paper --quiet --tier auto --set circuit.r1=99ohm --set run.tier=switched "
           "--set run.until=9ms");
}

/* Auto keeps to the circuit where there are events; that no other tier has them it does not say. */
static void auto_and_events(void) {
  write_file("s.yaml", "run: {until: 9 ms}\nevents: {e: {kind: sag, at: 5 ms}}\n");
  ran r = run("check s.yaml");
  CU_ASSERT_EQUAL(r.status, 0);
  EXPECT(strstr(r.out, "tier circuit (auto: the scene names events.e, and only this tier tells"),
         "%s", r.out);
  free_ran(&r);
  remove("s.yaml");
}

/* An axis over a key that the tier ignores would be so many times one case. */
static void studies(void) {
  static const struct {
    const char *text, *at;
  } STUDIES[] = {
      {"set: {run.until: 10 ms, run.tier: switched}\n"
       "vary:\n  circuit.r1: [100 ohm, 1 kohm]\nreport: [p_min]\n",
       "t.yaml:3:3: circuit.r1: "},
      {"set: {run.until: 10 ms, run.tier: analytic, circuit.c1: 5 nF}\n"
       "vary:\n  firing.angle: [100 deg, 120 deg]\nreport: [p_min]\n",
       "t.yaml:1:45: circuit.c1: "},
      {"set: {run.until: 10 ms, run.tier: switched}\n"
       "sample: {method: sobol, n: 8, seed: 7, spread: {circuit.c1: 5 % normal}}\n"
       "report: [p_min]\n",
       "t.yaml:2:49: circuit.c1: "},
      {"set: {run.until: 10 ms, run.tier: switched, events: {e: {kind: sag, at: 3 ms}}}\n"
       "vary:\n  events.e.kind: [sag, surge]\nreport: [p_min]\n",
       "t.yaml:1:54: events.e: "},
      {"set: {run.until: 10 ms, circuit.r1: 220 ohm}\n"
       "vary:\n  firing.angle: [100 deg, 120 deg]\n  run.tier: [circuit, switched]\n"
       "report: [p_min]\n",
       "t.yaml:1:25: circuit.r1: "}};
  static const char *const SAYS[] = {"tier switched", NULL}, *const OTHER[] = {"analytic", NULL};
  for (size_t k = 0; k < COUNT(STUDIES); k++) {
    write_file("t.yaml", STUDIES[k].text);
    refuse("study t.yaml -o out", STUDIES[k].text, STUDIES[k].at, k == 1 ? OTHER : SAYS, __LINE__);
    ran r = run("check t.yaml");
    EXPECT(r.status == 2 && strstr(r.err, STUDIES[k].at), "check: %d, %s", r.status, r.err);
    free_ran(&r);
  }
  remove("t.yaml");
}

static const vs_test TESTS[] = {
    {"keys of the circuit", keys_of_the_circuit},
    {"kinds of events", kinds_of_events},
    {"another gate", another_gate},
    {"check tells all", check_tells_all},
    {"no conflict", no_conflict},
    {"auto and events", auto_and_events},
    {"studies", studies},
};
int main(void) {
  return program_suite("a tier that was asked for", TESTS, COUNT(TESTS));
}
