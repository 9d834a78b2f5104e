/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a device that conducts or blocks is seen to do against its gate, where steps are as short as
 * instants round. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drive/gate.h"
#include "drive/occurrence.h"
#include "program.h"
#include "watch/switching.h"

/* ---- edges of gate pulses ---- */

/* Follows steps that end on an edge and go on from it, the first of them `first` roundings long,
 * each the double of the one before, and counts those behind the second step for which the gate is
 * not as it should be. */
static int wrong_behind(vs_gate_watch *g, double *at_s, double edge_s, double first, bool on) {
  int wrong = 0;
  vs_course_step c = {.t0_s = *at_s, .t1_s = edge_s};
  vs_switching_gate_follow(g, &c);
  wrong += g->on == on;
  for (double h = first * vs_occurrence_rounding(edge_s); h < 1e-6; h *= 2) {
    c.t0_s = c.t1_s;
    c.t1_s += h;
    if (!(c.t1_s > c.t0_s)) continue;
    vs_switching_gate_follow(g, &c);
    wrong += g->on != on;
  }
  *at_s = c.t1_s;
  return wrong;
}

/* However short the first step behind an edge is, the gate is on from the pulse's beginning to its
 * end. */
static void short_steps_behind_an_edge(void) {
  for (int degrees = 3; degrees < 180; degrees += 11) {
    char angle[40];
    snprintf(angle, sizeof angle, "firing.angle=%d.37deg", degrees);
    vs_trial *t = vs_trial_read("paper", "circuit",
                                (const char *[]){angle, "firing.every=1", "run.until=1us", NULL});
    CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
    const vs_timeline *line = &t->scene.setup.timeline;
    for (double first = 0.1; first < 8; first *= 1.3) {
      vs_gate_watch g;
      double at_s = 0;
      vs_switching_gate_begin(&g, line, 0);
      for (int pulse = 0; pulse < 3; pulse++) {
        double rise_s = vs_gate_edge(line, 0, at_s), fall_s = vs_gate_edge(line, 0, rise_s);
        EXPECT(!wrong_behind(&g, &at_s, rise_s, first, true), "%s, %g: on", angle, first);
        EXPECT(!wrong_behind(&g, &at_s, fall_s, first, false), "%s, %g: off", angle, first);
      }
    }
    vs_trial_free(t);
  }
}

/* The first step behind the edge is of 1e-15 s here, and the thyristor fires in it. */
static void fired_by_its_gate_at_tight_tolerances(void) {
  static const char *const ANGLES[] = {"60", "140"};
  for (size_t k = 0; k < COUNT(ANGLES); k++) {
    ran r = run("run paper --tier circuit --set firing.angle=%sdeg --set run.tolerance=1e-7 --set "
                "run.verify=never --set run.until=8ms --json --quiet",
                ANGLES[k]);
    EXPECT(r.status == 0 && strstr(r.out, "\"thyristor.unintended\": {\"value\": 0,"), "%s: %d %s",
           ANGLES[k], r.status, r.out);
    free_ran(&r);
  }
}

/* The thyristor discharges its snubber: its current jumps, while its voltage falls by 17 V within a
 * nanosecond, and from there on only falls. */
static void a_conduction_that_only_falls_is_no_misfire(void) {
  static const char *const SCENES[] = {
      "firing.angle=175deg --set supply.voltage=100V",
      "firing.angle=175deg --set supply.voltage=100V --set run.tolerance=1e-5",
      "firing.angle=174deg --set supply.voltage=90V --set circuit.c1=33nF",
  };
  for (size_t k = 0; k < COUNT(SCENES); k++) {
    ran r = run("run paper --set circuit.deck=bridge_halfcontrolled --set run.until=22ms --set "
                "run.verify=never --json --quiet --set %s",
                SCENES[k]);
    EXPECT(r.status == 0 && strstr(r.out, "\"t1.misfires\": {\"value\": 0,"), "%s: %d %s",
           SCENES[k], r.status, r.out);
    free_ran(&r);
  }
}

static const vs_test TESTS[] = {
    {"short steps behind an edge", short_steps_behind_an_edge},
    {"fired by its gate at tight tolerances", fired_by_its_gate_at_tight_tolerances},
    {"a conduction that only falls is no misfire", a_conduction_that_only_falls_is_no_misfire},
};
int main(void) {
  return program_suite("switching", TESTS, COUNT(TESTS));
}
