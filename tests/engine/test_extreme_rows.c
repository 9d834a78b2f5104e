/* SPDX-License-Identifier: GPL-3.0-or-later
 * No row that a run writes lies beyond an extreme that it reports: over scenes drawn at random, on
 * the ideal tiers. 120 of them, with VS_LONG (tools/test --long) 2000. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "study/random.h"
#include "suite.h"

/* What is followed: the measure, its channel, its sense as of a vs_extreme. */
static const struct {
  int measure, channel, sense;
  const char *name;
} FOLLOWED[] = {{VS_M_I_PEAK, VS_CH_I, 0, "i_peak"},
                {VS_M_FORCE_PEAK, VS_CH_FORCE, 1, "force"},
                {VS_M_GAP_MIN, VS_CH_P, -1, "p_min"},
                {VS_M_GAP_MAX, VS_CH_P, 1, "p_max"},
                {VS_M_OF_COORDINATE(P, VS_PEAK), VS_CH_AP, 0, "ap_peak"},
                {VS_M_OF_COORDINATE(U, VS_PEAK), VS_CH_AU, 0, "au_peak"},
                {VS_M_OF_COORDINATE(W, VS_PEAK), VS_CH_AW, 0, "aw_peak"}};

/* The rows of a CSV, at multiples of the sample, as run/table.c has them. */
typedef struct rows {
  double sample_s, next;
  double most[COUNT(FOLLOWED)], size[COUNT(FOLLOWED)]; /* in the sense; largest magnitude */
} rows;

static vs_status look(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  rows *r = ctx;
  double y[VS_CH_MOST];
  if (step->to->t_s == step->from->t_s) return VS_OK;
  for (; r->next * r->sample_s <= step->to->t_s; r->next++) {
    vs_step_at(step, r->next * r->sample_s, y);
    for (size_t k = 0; k < COUNT(FOLLOWED); k++) {
      double now = y[FOLLOWED[k].channel], sense = FOLLOWED[k].sense;
      r->size[k] = fmax(r->size[k], fabs(now));
      r->most[k] = fmax(r->most[k], sense != 0 ? sense * now : fabs(now));
    }
  }
  return VS_OK;
}

/* Twice the rounding of the 17 digits a row is written with, and of what both are computed from. */
static const double ROUNDING = 1e-14;

static void compare(const vs_trial *t, const rows *r, int scene) {
  for (size_t k = 0; k < COUNT(FOLLOWED); k++) {
    double value = t->result.values[FOLLOWED[k].measure].value, sense = FOLLOWED[k].sense;
    double beyond = r->most[k] - (sense != 0 ? sense * value : value);
    EXPECT(beyond <= ROUNDING * r->size[k],
           "scene %d: a row is beyond %s = %.12g by %.2g of the largest", scene, FOLLOWED[k].name,
           value, beyond / r->size[k]);
  }
}

/* ---- scenes at random ---- */

enum { MOST_SETS = 32, SET_SIZE = 64 };
typedef struct drawn {
  char text[MOST_SETS][SET_SIZE];
  const char *sets[MOST_SETS + 1];
  size_t n;
  uint64_t scene, draw;
} drawn;

static double uniform(drawn *d, double lo, double hi) {
  return lo + (hi - lo) * vs_random_uniform(613, d->scene, d->draw++);
}

/* part: in how many of all scenes the key is set */
static void set(drawn *d, double part, const char *key, double lo, double hi, const char *unit) {
  double value = uniform(d, lo, hi);
  if (uniform(d, 0, 1) > part) return;
  snprintf(d->text[d->n], SET_SIZE, "%s=%.6g %s", key, value, unit);
  d->sets[d->n] = d->text[d->n];
  d->n++;
}

static void set_whole(drawn *d, const char *key, int hi) {
  snprintf(d->text[d->n], SET_SIZE, "%s=%d", key, 1 + (int)uniform(d, 0, hi));
  d->sets[d->n] = d->text[d->n];
  d->n++;
}

static void draw(drawn *d, int scene) {
  *d = (drawn){.scene = (uint64_t)scene};
  double hz = uniform(d, 16, 120);
  set(d, 1, "supply.frequency", hz, hz, "Hz");
  set(d, 1, "firing.angle", 3, 177, "deg");
  set(d, 1, "firing.pulse_width", 8 / hz, 500 / hz, "ms");
  set(d, 0.5, "supply.phase", 0, 360, "deg");
  if (uniform(d, 0, 1) > 0.3) set_whole(d, "firing.every", 3);
  set_whole(d, "firing.first_cycle", 3);
  bool stop = uniform(d, 0, 1) < 0.25;
  if (stop) d->sets[d->n++] = "actuator.stop={stiffness: 1e6 N/m, damping: 50 N.s/m}";
  set(d, 1, "actuator.gap", stop ? 2 : 10, stop ? 6 : 40, "mm");
  set(d, 1, "actuator.resistance", 20, 200, "ohm");
  set(d, 1, "actuator.inductance", 0.3, 3, "H");
  set(d, 0.5, "machine.trough_mass", 0.4, 2, "kg");
  set(d, 0.5, "machine.base_mass", 2, 10, "kg");
  set(d, 0.5, "machine.spring_stiffness", 2e4, 2e5, "N/m");
  set(d, 0.5, "machine.mount_stiffness_x", 4e3, 4e4, "N/m");
  set(d, 0.5, "machine.mount_stiffness_y", 1e4, 2e5, "N/m");
  set(d, 0.5, "machine.spring_angle", 30, 90, "deg");
  set(d, 0.4, "start.vp", -0.05, 0.05, "m/s");
  set(d, 0.4, "start.vu", -0.02, 0.02, "m/s");
  set(d, 0.4, "start.vphi", -0.2, 0.2, "rad/s");
  set(d, 0.3, "start.p", -1, 1, "mm");
  double tolerance = pow(10, uniform(d, -10, -2)), step = pow(10, uniform(d, 1, 3.3));
  set(d, 1, "run.tolerance", tolerance, tolerance, "");
  set(d, 0.4, "run.max_step", step, step, "us");
  set(d, 1, "run.until", 50, 250, "ms");
}

static void no_row_is_beyond_an_extreme(void) {
  int wanted = getenv("VS_LONG") ? 2000 : 120, ran = 0;
  drawn d;
  for (int scene = 1; ran < wanted && scene < 2 * wanted; scene++) {
    draw(&d, scene);
    rows r = {.sample_s = 7.3e-6 + 1e-8 * scene};
    for (size_t k = 0; k < COUNT(FOLLOWED); k++) r.most[k] = -INFINITY;
    vs_observer observer = {&r, look};
    vs_trial *t = vs_trial_run("paper", scene % 3 ? "switched" : "analytic", d.sets, &observer);
    EXPECT(t->status != VS_INPUT, "scene %d: %s", scene, t->err.text);
    if (!t->status) { /* else the armature met the pole cover, or closed the gap */
      ran++;
      compare(t, &r, scene);
    }
    vs_trial_free(t);
  }
  CU_ASSERT_EQUAL(ran, wanted);
}

/* Where a swing begins far from its extremes these are met between knots, after the first value of
 * all: a start of p, u, w at rest, whose largest p is that of the swing to the other side. By steps
 * of 20 us, a twentieth of the longest, and at the finest tolerance; dense output is right to 5e-11
 * of what is large (engine/ideal/phases.c), and accelerations are its second derivatives. */
static void extremes_are_exact(void) {
  for (int scene = 1; scene <= 40; scene++) {
    drawn d;
    vs_value values[2][VS_MEASURES];
    bool good = true;
    for (int fine = 0; fine < 2; fine++) {
      draw(&d, scene);
      d.sets[d.n++] = "actuator.stop=none"; /* contacts amplify what is different */
      d.sets[d.n++] = "actuator.gap=40mm";
      d.sets[d.n++] = fine ? "run.tolerance=1e-10" : "run.tolerance=1e-3";
      d.sets[d.n++] = fine ? "run.max_step=20us" : "run.max_step=0";
      vs_trial *t = vs_trial_run("paper", "switched", d.sets, NULL);
      good = good && t->status == VS_OK;
      for (int k = 0; k < VS_MEASURES; k++) values[fine][k] = t->result.values[k];
      vs_trial_free(t);
    }
    EXPECT(good, "scene %d fails", scene);
    double p = fmax(fabs(values[1][VS_M_GAP_MIN].value), fabs(values[1][VS_M_GAP_MAX].value));
    for (size_t k = 0; good && k < COUNT(FOLLOWED); k++) {
      int m = FOLLOWED[k].measure;
      bool of_p = m == VS_M_GAP_MIN || m == VS_M_GAP_MAX;
      CLOSE_OF(values[0][m].value, values[1][m].value, of_p ? p : values[1][m].value, 1e-9);
    }
  }
}

static const vs_test TESTS[] = {
    {"no row is beyond an extreme", no_row_is_beyond_an_extreme},
    {"extremes are exact", extremes_are_exact},
};
VS_SUITE_MAIN("extreme_rows", TESTS)
