/* SPDX-License-Identifier: GPL-3.0-or-later
 * `check` says before a run what the run would say after it: that nothing can fire. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

#define PULSE "no gate pulse meets forward mains voltage"

/* check and run agree on whether something fires. Of a circuit check says no more than that it may
 * be that nothing does. */
static void both(const char *words, bool fires) {
  bool circuit = strstr(words, "tier=circuit");
  const char *word = circuit ? "it may be that nothing fires: " PULSE " above 0.7 V"
                             : "nothing can fire: " PULSE " before";
  ran r = run("check paper %s", words);
  EXPECT(r.status == 0 && !strstr(r.err, word) == fires, "check %s: %d %s", words, r.status, r.err);
  free_ran(&r);
  r = run("run paper %s", words);
  EXPECT(r.status == 0 && !strstr(r.err, "nothing fires: " PULSE) == fires, "run %s: %d %s", words,
         r.status, r.err);
  free_ran(&r);
}

#define SWITCHED "--set run.tier=switched --set run.until=45ms "
#define CIRCUIT "--set run.tier=circuit --set run.until=25ms --set run.verify=never "
#define BOTH_WAYS CIRCUIT "--set circuit.deck=fullwave_antiparallel "

static void as_the_run_says(void) {
  both(SWITCHED, true);
  both(SWITCHED "--set firing.first_cycle=3", false); /* at 45.6 ms */
  both(SWITCHED "--set firing.first_cycle=3 --set firing.angle=80deg", true);
  both(SWITCHED "--set supply.phase=-90deg --set firing.first_cycle=3", false);
  both(SWITCHED "--set 'events={m: {kind: missing_pulse, cycle: 1}}'", false);
  both(SWITCHED "--set 'events={i: {kind: interruption, at: 0 ms, duration: 45 ms}}'", false);
  both(SWITCHED "--set firing.first_cycle=3 --set 'events={s: {kind: spurious_pulse, at: 23 ms}}'",
       true);
  both(CIRCUIT, true);
  both(CIRCUIT "--set firing.first_cycle=2", false);
  both(CIRCUIT "--set firing.angle=179.99deg --set firing.pulse_width=0.001ms", false);
  both(BOTH_WAYS, true);
  both(BOTH_WAYS "--set firing.first_cycle=2", false);
}

/* A triac that a pulse outlasts the half cycle of is fired again, the other way. 60 Hz, 120
 * degrees: 5.556 ms of 8.333 ms; a thyristor has 16.667 ms. */
static void pulses_of_a_triac(void) {
  static const struct {
    const char *words, *warning;
  } ROWS[] = {
      {"",
       "lasts until 13.5556 ms, and the mains change sign at 8.33333 ms: once the current of "
       "triac ends it is fired again, the other way, whatever firing.angle says; take 2.7 ms or"},
      {"--set firing.pulse_width=2.8ms", "take 2.7 ms or less"},
      {"--set firing.pulse_width=2.7ms", NULL},
      {"--set firing.angle=179.99deg --set firing.pulse_width=1ms", "says; fire earlier"},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("check triac_feeder --set supply.frequency=60Hz --set firing.angle=120deg "
                "--set firing.pulse_width=8ms %s",
                ROWS[k].words);
    const char *wanted = ROWS[k].warning ? ROWS[k].warning : "";
    EXPECT(r.status == 0 &&
               (*wanted ? strstr(r.err, wanted) != NULL : !strstr(r.err, "firing.pulse_width")),
           "%s: %d %s", ROWS[k].words, r.status, r.err);
    free_ran(&r);
  }
}

/* A pulse of 8 ms from 5.556 ms on, of which the mains leave little: their last 0.1 ms, their first
 * 20 us, a slot between two notches. */
static void through_a_slot(void) {
  static const char *const ROWS[] = {
      "m: {kind: interruption, at: 5 ms, duration: 4.9 ms}",
      "m: {kind: interruption, at: 5.57 ms, duration: 20 ms}",
      "m: {kind: notch, at: 5 ms, duration: 2.31 ms, depth: 100 %}, "
      "n: {kind: notch, at: 7.32 ms, duration: 2.68 ms, depth: 100 %}",
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char words[512];
    snprintf(words, sizeof words,
             "--set run.tier=switched --set run.until=30ms --set 'events={%s}'", ROWS[k]);
    both(words, true);
  }
  both("--set run.tier=switched --set run.until=30ms --set 'events={m: {kind: interruption, "
       "at: 5 ms, duration: 5 ms}}'",
       false);
}

/* C1 and the coil drive the thyristor while the mains do not: check does not say that they cannot.
 * Too faint mains are told the same way by both. */
static void with_a_circuit(void) {
  static const char *const ROWS[] = {
      "{kind: interruption, at: 5 ms, duration: 24 ms}",
      "{kind: interruption, at: 5 ms, duration: 4.9 ms}",
      "{kind: notch, at: 5.5 ms, duration: 9 ms, depth: 100 %}",
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    ran r = run("check paper " CIRCUIT "--set run.until=30ms --set 'events={m: %s}'", ROWS[k]);
    EXPECT(r.status == 0 && !strstr(r.err, "nothing can fire"), "%s: %s", ROWS[k], r.err);
    free_ran(&r);
  }
  both(CIRCUIT "--set supply.voltage=0.5V", false);
}

/* With the place of what asks for it; --quiet says nothing; no deck's gate, nothing to fire. */
static void its_place(void) {
  write_file("f.yaml", "run: {until: 0.1 s}\nfiring:\n  first_cycle: 7\n");
  ran r = run("check f.yaml");
  EXPECT(r.status == 0 && strstr(r.err, "f.yaml:3:3: warning: nothing can fire"), "%s", r.err);
  free_ran(&r);
  r = run("check f.yaml --quiet");
  EXPECT(r.status == 0 && !*r.err, "%s", r.err);
  free_ran(&r);
  write_file("m.cir", "*$ port mains = Vm\n*$ probe v_a = v(a) V\nVm a 0 external\n"
                      "R1 a b 100\nXeva b 0 eva\n");
  r = run("check f.yaml --set circuit.deck=m.cir --set run.tier=circuit");
  EXPECT(r.status == 0 && !strstr(r.err, "fire"), "%s", r.err);
  free_ran(&r);
  unlink("f.yaml"), unlink("m.cir");
}

int main(void) {
  static const vs_test TESTS[] = {
      {"as the run says", as_the_run_says},
      {"through a slot", through_a_slot},
      {"pulses of a triac", pulses_of_a_triac},
      {"with a circuit", with_a_circuit},
      {"its place", its_place},
  };
  return program_suite("check_firing", TESTS, COUNT(TESTS));
}
