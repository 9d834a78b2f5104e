/* SPDX-License-Identifier: GPL-3.0-or-later
 * Every key that `list parameters` prints, on a tier that was asked for: it changes the run's
 * files, or it is refused with its name and the tier's, at its place, by run, check and study; none
 * is dropped unsaid. What a tier can do, and the deck's name alone, are no conflict. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

/* Another value than the default's; keys that are not here take 1.07 of it, or, where that is 0,
 * what their unit is in ZERO. */
static const struct {
  const char *key, *value;
} OTHER[] = {{"machine.spring_angle", "60 deg"},
             {"machine.base_com", "[190 mm, 80 mm]"},
             {"machine.trough_com", "[90 mm, 120 mm]"},
             {"machine.mount_3", "[30 mm, 10 mm]"},
             {"machine.mount_4", "[200 mm, 10 mm]"},
             {"machine.m14", "derived"},
             {"actuator.stop", "none"},
             {"actuator.stop.kind", "quadratic_clipped"},
             {"actuator.stop.at", "0.4 mm"},
             {"actuator.law", "moving_coil"},
             {"actuator.saturation", "{flux: 0.5 Wb}"},
             {"actuator.saturation.law", "multiplicative"},
             {"actuator.force_constant", "2 N/A"},
             {"supply.kind", "step"},
             {"firing.valve", "none"},
             {"load.fraction", "0.4"},
             {"load.density", "2 g/cm3"},
             {"supply.voltage", "140 V"},
             {"supply.phase", "20 deg"},
             {"firing.pulse_width", "30 ms"}, /* fires a second time */
             {"firing.every", "2"},
             {"firing.first_cycle", "2"},
             {"firing.burst_duty", "50 %"},
             {"circuit.thyristor", "TYN1212"},
             {"circuit.r1_part", "PR03"},
             {"circuit.r2_part", "PR03"},
             {"circuit.c1_part", "MKP-1000V-100N"},
             {"circuit.c2_part", "MKP-1000V-100N"},
             {"actuator.eddy", "{resistance: 10 kohm}"},
             {"actuator.eddy.coupling", "0.9"},
             {"actuator.winding", "{temperature: 60 degC}"},
             {"actuator.winding.temperature", "60 degC"},
             {"run.until", "0.09 s"},
             {"run.tolerance", "1e-10"},
             {"run.max_step", "20 us"},
             {"run.method", "gear"},
             {"run.ladder", "stay"},
             {"run.verify", "always"},
             {"run.leave_circuit", "never"},
             {"run.pivrel", "0.01"},
             {"run.trtol", "9"},
             {"run.first_step", "1e-3"},
             {"start.phi", "0.001 rad"},
             {"measure.from", "0.01 s"},
             {"measure.to", "0.05 s"},
             {"measure.last", "2 cycles"},
             {"instruments.set", "paper"},
             {"instruments.seed", "7"},
             {"instruments.NAME.channel", "u"},
             {"instruments.NAME.range", "[-3 mm, 3 mm]"},
             {"instruments.NAME.bandwidth", "90 Hz"},
             {"instruments.NAME.order", "1"},
             {"instruments.NAME.damping", "0.5"},
             {"instruments.NAME.noise", "2 um"},
             {"instruments.NAME.rate", "4 kHz"},
             {"instruments.NAME.bits", "10"}};

/* The tier itself; what says which machine and which circuit the tiers stand for; and a text. */
static const char *const NO_CONFLICT[] = {
    "run.tier", "machine.model", "circuit.deck", "instruments.NAME.text",
    "actuator.linear_to", /* it warns */
    /* these act together, or away from 20 degC */
    "actuator.winding.coefficient", "actuator.winding.r_th", "actuator.winding.c_th",
    "actuator.winding.core_r_th", "actuator.winding.core_c_th", "actuator.winding.ambient"};

/* What a refusal names where not the tier has no use for the key: another key beside it. */
static const char *const BESIDE[] = {"law reluctance has no use for it", "firing.valve: none"};

/* name, default, range, text, in columns 28 and 18 wide */
static bool other_value(const char *line, char *key, char *value, size_t size) {
  char number[64] = "", unit[32] = "";
  if (sscanf(line, "%95s", key) != 1) return false;
  if (!strncmp(key, "control.", 8)) return false; /* every tier obeys them, once it fires again */
  if (!strncmp(key, "limits.", 7)) return false;  /* every tier obeys them; they change nothing */
  for (size_t k = 0; k < COUNT(NO_CONFLICT); k++)
    if (!strcmp(key, NO_CONFLICT[k])) return false;
  for (size_t k = 0; k < COUNT(OTHER); k++)
    if (!strcmp(key, OTHER[k].key)) {
      snprintf(value, size, "%s", OTHER[k].value);
      return true;
    }
  char shown[20];
  snprintf(shown, sizeof shown, "%.18s", line + 29);
  sscanf(shown, "%63s %31s", number, unit);
  double own = strtod(number, NULL);
  snprintf(value, size, "%.9g %s", own != 0 ? 1.07 * own : 0.05, unit);
  return true;
}

/* The key of the scene's own instrument, `way`, where `key` is one of instruments.NAME. */
static void name_instrument(char *key, size_t size) {
  static const char ANY[] = "instruments.NAME";
  char own[96];
  if (strncmp(key, ANY, sizeof ANY - 1) != 0) return;
  snprintf(own, sizeof own, "instruments.way%s", key + sizeof ANY - 1);
  snprintf(key, size, "%s", own);
}

/* What a run leaves but for the scene it was asked for; free() it. */
static char *result_of(const char *tier, const char *set, ran *r) {
  remove_tree("o");
  *r = run("run s.yaml -o o --reproducible --tier %s%s", tier, set);
  vs_text all = {0};
  char *csv = read_file("o/run.csv"), *events = read_file("o/events.csv");
  char *json = read_file("o/summary.json"), *measures = strstr(json, "\"measures\"");
  vs_text_add(&all, "%s%s%s", csv, events, measures ? measures : "");
  free(csv), free(events), free(json);
  return all.text;
}

static void keys_on(const char *tier) {
  ran list = run("list parameters"), r;
  char named[32], *plain = result_of(tier, "", &r);
  EXPECT(r.status == 0 && *plain, "%s: %d %s", tier, r.status, r.err);
  free_ran(&r);
  snprintf(named, sizeof named, "tier %s", tier);
  int keys = 0;
  for (char *rest = list.out, *line; (line = strsep(&rest, "\n"));) {
    char key[96], value[128], set[256];
    if (strlen(line) < 48 || !other_value(line, key, value, sizeof value)) continue;
    if (strstr(key, "DEVICE")) continue; /* of the deck: test_traps_semis */
    name_instrument(key, sizeof key);
    snprintf(set, sizeof set, " --set '%s=%s'", key, value);
    char *other = result_of(tier, set, &r);
    bool beside = strstr(r.err, BESIDE[0]) || strstr(r.err, BESIDE[1]);
    bool refused = r.status == 2 && strstr(r.err, key) && (strstr(r.err, named) || beside);
    bool acts = r.status < 2 && strcmp(other, plain) != 0; /* 1: it meets the pole cover */
    EXPECT(refused || acts, "%s, %s = %s: %d, %s", tier, key, value, r.status,
           *r.err ? r.err : "ignored");
    keys++;
    free(other);
    free_ran(&r);
  }
  EXPECT(keys > 60, "%d keys", keys);
  free(plain);
  free_ran(&list);
}

/* A scene in which each key has something to act on. */
static void each_key(void) {
  write_file("s.yaml", "actuator: {stop: {damping: 300 N.s/m}}\n"
                       "load: {density: 1 g/cm3, fraction: 0.2}\n"
                       "run: {until: 0.1 s}\n"
                       "supply: {voltage: 150 V}\n"
                       "start: {p: -5.9 mm, vp: -0.6 m/s}\n"
                       "instruments: {set: none, way: {channel: p, range: [-9 mm, 9 mm], "
                       "bandwidth: 100 Hz, order: 2, noise: 1 um}}\n");
  keys_on("switched");
  keys_on("analytic");
}

static const struct {
  const char *key, *value;
} CIRCUITS[] = {{"firing.burst_frequency", "4 kHz"},
                {"firing.burst_duty", "50 %"},
                {"run.ladder", "ideal"},
                {"run.ladder", "climb"},
                {"run.verify", "always"},
                {"measure.last", "2 cycles"}};

/* From the scene as from --set, in check too; tier auto takes the tier that has them. */
static void keys_of_the_circuit(void) {
  for (size_t k = 0; k < COUNT(CIRCUITS); k++) {
    char text[160], words[160];
    const char *key = CIRCUITS[k].key, *dot = strchr(key, '.');
    const char *says[] = {key, "tier switched"};
    snprintf(text, sizeof text, "%.*s:\n  %s: %s\n", (int)(dot - key), key, dot + 1,
             CIRCUITS[k].value);
    write_file("k.yaml", text);
    refuse("run k.yaml --tier switched -o out", key, "k.yaml:2:3: ", says, __LINE__);
    ran r = run("check k.yaml --set run.tier=switched");
    EXPECT(r.status == 2 && strstr(r.err, key), "check, %s: %d %s", key, r.status, r.err);
    free_ran(&r);
    r = run("check k.yaml");
    EXPECT(r.status == 0 && strstr(r.out, "tier circuit") && strstr(r.out, key), "%s: %d %s", key,
           r.status, r.out);
    free_ran(&r);
    snprintf(words, sizeof words, "run paper --set 'run.tier=switched' --set '%s=%s'", key,
             CIRCUITS[k].value);
    refuse(words, key, "--set ", says, __LINE__);
  }
  RUN_GOOD("run paper --tier switched --set run.verify=never --set run.until=20ms --quiet");
  unlink("k.yaml");
}

/* On the circuit tier a deck without a port burst ignores the sub-pulses, and is said to. */
static void no_port_burst(void) {
  ran r = run("check paper --set firing.burst_duty=50%%");
  EXPECT(r.status == 0 && strstr(r.err, "firing.burst_duty: the deck has no port burst"), "%d %s",
         r.status, r.err);
  free_ran(&r);
  r = run("check paper --set firing.burst_duty=50%% --set circuit.deck=halfwave_paper");
  EXPECT(r.status == 0 && !strstr(r.err, "burst"), "%d %s", r.status, r.err);
  free_ran(&r);
}

/* ---- refused at its place, by run, check and study ---- */

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

static void circuit_keys_at_their_places(void) {
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
  static const char *const SAYS[] = {"tier switched", NULL}, *const IDEAL[] = {"analytic", NULL};
  for (size_t k = 0; k < COUNT(STUDIES); k++) {
    write_file("t.yaml", STUDIES[k].text);
    refuse("study t.yaml -o out", STUDIES[k].text, STUDIES[k].at, k == 1 ? IDEAL : SAYS, __LINE__);
    ran r = run("check t.yaml");
    EXPECT(r.status == 2 && strstr(r.err, STUDIES[k].at), "check: %d, %s", r.status, r.err);
    free_ran(&r);
  }
  remove("t.yaml");
}

int main(void) {
  static const vs_test TESTS[] = {
      {"each key acts or is refused", each_key},
      {"keys of the circuit's", keys_of_the_circuit},
      {"no port burst", no_port_burst},
      {"keys of the circuit, at their places", circuit_keys_at_their_places},
      {"kinds of events", kinds_of_events},
      {"another gate", another_gate},
      {"check tells all", check_tells_all},
      {"no conflict", no_conflict},
      {"auto and events", auto_and_events},
      {"studies", studies},
  };
  return program_suite("forced_keys", TESTS, COUNT(TESTS));
}
