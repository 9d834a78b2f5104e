/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which currents are one shot, and so none to rate for ever: what goes out and is fired again by
 * the same gate pulse in the same half cycle is one shot; a gate that stays on over many cycles is
 * not.
 */
#include <stdlib.h>
#include <string.h>

#include "program.h"

static void judged(const char *const *more, bool one_shot) {
  const char *sets[8] = {"circuit.deck=gated.cir", "run.tolerance=1e-2"};
  for (size_t k = 0; more[k]; k++) sets[2 + k] = more[k];
  vs_trial *t = vs_trial_run("paper", "circuit", sets, NULL);
  EXPECT(t->status == VS_OK, "%s", t->err.text);
  bool found = false;
  for (size_t k = 0; !t->status && k < t->result.watchers.devices->item[0].count; k++) {
    const vs_reduced *r = &t->result.watchers.devices->item[0].reduced[k];
    if (strcmp(r->measure->name, "i_rms")) continue;
    found = true;
    bool said = r->unjudged && !strcmp(r->unjudged, "not judged: one shot");
    EXPECT(said == one_shot, "%s, %s: %s; %d shots", more[0], more[2],
           r->unjudged ? r->unjudged : "judged", t->result.watchers.devices->item[0].starts);
  }
  CU_ASSERT_TRUE(found);
  vs_trial_free(t);
}

/* Late angle and small R1: what has just fired goes out in C2's ring and is fired again. */
static void in_the_ring(void) {
  ran r = run("run paper --set circuit.thyristor=TYN1212 --set circuit.r1=10ohm "
              "--set firing.angle=160deg --set firing.every=100 --set run.until=1.1s "
              "--set run.verify=never -o ring --all");
  char *events = read_file("ring/events.csv");
  const char *first = strstr(events, "thyristor fires");
  EXPECT(first && strstr(first + 1, "thyristor fires"), "it fires once: %s", events);
  const char *line = strstr(r.out, "  thyristor.i_rms "),
             *said = line ? strstr(line, "one shot") : NULL;
  EXPECT(r.status == 0 && said && said < strchr(line, '\n'), "%d %s%s", r.status, r.out, r.err);
  free(events);
  free_ran(&r);
}

static void by_pulses(void) {
  write_gated_deck();
  judged((const char *[]){"firing.every=100", "run.until=1.1s", "firing.angle=100deg", NULL}, true);
  judged((const char *[]){"firing.every=25", "run.until=1.1s", "firing.angle=100deg", NULL}, false);
  /* one pulse over fifty cycles is operation */
  judged((const char *[]){"firing.every=100", "run.until=1.1s", "firing.pulse_width=1050ms",
                          "supply.voltage=150V", NULL},
         false);
}

int main(void) {
  static const vs_test TESTS[] = {{"fired again in the ring", in_the_ring},
                                  {"by its pulses", by_pulses}};
  return program_suite("one_shot", TESTS, COUNT(TESTS));
}
