/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a device that conducts or blocks is seen to do against its gate, where steps are as short as
 * instants round. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "engine/gate.h"
#include "engine/scene_event.h"
#include "measure/switching.h"
#include "program.h"

/* ---- edges of gate pulses ---- */

/* Follows steps that end on an edge and go on from it, the first of them `first` roundings long,
 * each the double of the one before, and counts those behind the second step for which the gate is
 * not as it should be. */
static int wrong_behind(vs_gate_watch *g, double *at_s, double edge_s, double first, bool on) {
  int wrong = 0;
  vs_course_step c = {.t0_s = *at_s, .t1_s = edge_s};
  vs_gate_watch_follow(g, c.t0_s, c.t1_s);
  wrong += g->on == on;
  for (double h = first * vs_scene_event_rounding(edge_s); h < 1e-6; h *= 2) {
    c.t0_s = c.t1_s;
    c.t1_s += h;
    if (!(c.t1_s > c.t0_s)) continue;
    vs_gate_watch_follow(g, c.t0_s, c.t1_s);
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
      vs_gate_watch_begin(&g, line, &(vs_gates){{0}, 1});
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
    EXPECT(r.status == 0 && strstr(r.out, "\"thyristor.unintended_firings\": {\"value\": 0,"),
           "%s: %d %s", ANGLES[k], r.status, r.out);
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

/* ---- letting go at forward voltage ---- */

/* At small angles the current falls below the holding current while the coil's goes on into R2-C2,
 * which lifts the thyristor's voltage to some ten volts forward: its whole conduction is no
 * misfire, and the turn-off, which had no reverse time, is judged. */
static void letting_go_is_a_turn_off(void) {
  static const char *const SCENES[] = {
      "TYN1012 --set firing.angle=20deg --set supply.voltage=110V",
      "TYN1012 --set firing.angle=20deg --set supply.voltage=110V --set run.tolerance=1e-5",
      "TYN1012 --set firing.angle=10deg --set supply.voltage=110V",
      "TYN1012 --set firing.angle=12deg --set supply.voltage=90V --set circuit.c2=68nF",
  };
  for (size_t k = 0; k < COUNT(SCENES); k++) {
    ran r = run("run paper --set circuit.deck=halfwave_snubbed --set run.until=26ms --set "
                "run.verify=never --json --quiet --set circuit.thyristor=%s",
                SCENES[k]);
    EXPECT(strstr(r.out, "\"thyristor.misfires\": {\"value\": 0,") &&
               strstr(r.out, "\"thyristor.t_off\": {\"value\": 0,") &&
               strstr(r.out, "\"measure\": \"t_off\""),
           "%s: %d %s", SCENES[k], r.status, r.out);
    free_ran(&r);
  }
}

/* Sources force a current that begins in a gate pulse, which ends at 7.556 ms, and forward voltage
 * behind it. It outlasts the pulse by less than ten t_q of 50 us: it did not latch. Or by more. */
static void latched_or_not(void) {
  static const struct {
    const char *ends, *back;
    int misfires;
  } ROWS[] = {
      {"7.65m", "7.651m", 1}, {"8m", "8.001m", 1}, {"8.1m", "8.101m", 0}, {"9m", "9.001m", 0}};
  write_file("p.inc", "*$ part thyristor \"P\"\n*$ limit t_q = 50 us assumed\n.subckt p a k g\n"
                      "R1 a k 1meg\nR2 g k 1k\n.ends\n");
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    char deck[800], said[40];
    snprintf(deck, sizeof deck,
             "*$ param t = p part\n*$ port gate = Vg\n*$ device t = v(x), i(Vt)\n"
             "Vg g 0 external\nVx x 0 PWL(0 600 5.6m 600 5.601m 1 %s 1 %s 600)\n"
             "It 0 y PWL(0 0 5.6m 0 5.601m 1 %s 1 %s 0)\nVt y z 0\nRz z 0 1\n"
             "Re e 0 1\nXeva e 0 eva\n",
             ROWS[k].ends, ROWS[k].back, ROWS[k].ends, ROWS[k].back);
    write_file("d.cir", deck);
    ran r = run("run paper --set circuit.deck=d.cir --set run.until=12ms --set "
                "firing.pulse_width=2ms --set run.verify=never --json --quiet");
    snprintf(said, sizeof said, "\"t.misfires\": {\"value\": %d,", ROWS[k].misfires);
    EXPECT(strstr(r.out, said) &&
               (strstr(r.out, "\"measure\": \"t_off\"") == NULL) == ROWS[k].misfires,
           "%s: %d %s", ROWS[k].ends, r.status, r.out);
    free_ran(&r);
  }
}

/* ---- rates over a window ---- */

enum { KNOTS = 200 };

/* A course that is straight from knot to knot, at any time within it. */
static double course(const double *t_s, const double *y, double at_s) {
  int n = 1;
  while (n < KNOTS - 1 && t_s[n] < at_s) n++;
  return y[n - 1] + (y[n] - y[n - 1]) * (at_s - t_s[n - 1]) / (t_s[n] - t_s[n - 1]);
}

/* The largest rate over a window is that of a window that begins or ends at a knot. Steps are from
 * a hundredth of the window to five of them, so that every knot is kept. 1e-9: times around 15 us
 * are rounded to 2e-21 s, which is 2e-12 of the shortest step, whose rate counts. */
static void rates_over_a_window(void) {
  static const double STEPS_NS[] = {1, 3, 250, 17, 2, 40, 95, 501, 8, 130, 1, 1, 60};
  for (int sense = -1; sense <= 1; sense++)
    for (int window = 0; window < 2; window++) {
      const double window_s = window ? 4e-7 : 1e-7;
      double t_s[KNOTS] = {0}, y[KNOTS] = {0}, largest = -INFINITY, expected = -INFINITY;
      vs_slope s = {.window_s = window ? window_s : 0};
      for (int k = 1; k < KNOTS; k++) {
        t_s[k] = t_s[k - 1] + 1e-9 * STEPS_NS[(k * k) % (int)COUNT(STEPS_NS)];
        y[k] = 50 * sin(7.0 * k) + 20 * cos(0.3 * k);
        largest = fmax(largest, vs_slope_rate(&s, t_s[k - 1], y[k - 1], t_s[k], y[k], sense));
      }
      for (int k = 0; k < 2 * KNOTS; k++) {
        double from_s = t_s[k / 2] - (k % 2 ? window_s : 0), to_s = from_s + window_s;
        if (from_s < 0 || to_s > t_s[KNOTS - 1]) continue;
        double rate = (course(t_s, y, to_s) - course(t_s, y, from_s)) / window_s;
        expected = fmax(expected, sense ? sense * rate : fabs(rate));
      }
      CLOSE(largest, expected, 1e-9);
    }
}

static const vs_test TESTS[] = {
    {"rates over a window", rates_over_a_window},
    {"short steps behind an edge", short_steps_behind_an_edge},
    {"fired by its gate at tight tolerances", fired_by_its_gate_at_tight_tolerances},
    {"a conduction that only falls is no misfire", a_conduction_that_only_falls_is_no_misfire},
    {"letting go is a turn-off", letting_go_is_a_turn_off},
    {"latched or not", latched_or_not},
};
int main(void) {
  return program_suite("switching", TESTS, COUNT(TESTS));
}
