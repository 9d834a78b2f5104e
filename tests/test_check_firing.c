/* SPDX-License-Identifier: GPL-3.0-or-later
 * `check` says before a run what the run would say after it: that nothing can fire. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "program.h"

/* check and run agree on whether something fires. */
static void both(const char *words, bool fires) {
  ran r = run("check paper %s", words);
  EXPECT(r.status == 0 && !strstr(r.err, "nothing can fire") == fires, "check %s: %d %s", words,
         r.status, r.err);
  free_ran(&r);
  r = run("run paper %s", words);
  EXPECT(r.status == 0 && !strstr(r.err, "nothing fires") == fires, "run %s: %d %s", words,
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
  EXPECT(r.status == 0 && !strstr(r.err, "nothing can fire"), "%s", r.err);
  free_ran(&r);
  unlink("f.yaml"), unlink("m.cir");
}

int main(void) {
  static const vs_test TESTS[] = {
      {"as the run says", as_the_run_says},
      {"its place", its_place},
  };
  return program_suite("check_firing", TESTS, COUNT(TESTS));
}
