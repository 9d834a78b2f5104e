/* SPDX-License-Identifier: GPL-3.0-or-later
 * Periodic orbits by shooting: the derivatives of a run against differences of runs, the published
 * numbers, how fast the iteration converges, and what is refused. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "actuator/coil.h"
#include "orbit/shooting.h"
#include "orbit/variation.h"
#include "suite.h"

enum { MOST = VS_VARIATION_MOST };
#define STOP "actuator.stop={stiffness: 1e6 N/m, damping: 50 N.s/m}"

/* ---- the derivatives of a run ---- */

/* What one run is looked at by. */
typedef struct looker {
  vs_variation *variation; /* NULL: only the end is wanted */
  double end[MOST], size[MOST];
  int met, left, fired, out; /* how often */
} looker;

static vs_status look(void *ctx, const vs_step *step, const vs_result *result, vs_error *err) {
  looker *l = ctx;
  int dof = step->frame->model->dof;
  (void)result;
  memcpy(l->end, step->to->x, 2 * (size_t)dof * sizeof *l->end);
  l->end[2 * dof] = step->to->flux_wb;
  for (int i = 0; i <= 2 * dof; i++) l->size[i] = fmax(l->size[i], fabs(l->end[i]));
  l->met += step->event[0] == VS_EV_MEETS_STOP;
  l->left += step->event[0] == VS_EV_LEAVES_STOP;
  l->fired += step->event[0] == VS_EV_FIRES;
  l->out += step->event[0] == VS_EV_EXTINCT;
  return l->variation ? vs_variation_accept(l->variation, step, err) : VS_OK;
}

/* Runs the setup on the scene's tier. */
static void go(const vs_scene *s, const vs_setup *setup, looker *l) {
  vs_scene *other = vs_alloc(1, sizeof *other);
  vs_result *r = vs_alloc(1, sizeof *r);
  vs_error err = {0};
  const vs_guest guest = {.ctx = l, .accept = look};
  const vs_session session = {.guest = &guest, .bare = true, .unguarded = true};
  *other = *s;
  other->setup = *setup;
  other->frame = vs_sim_frame(s->tier, &other->setup);
  if (l->variation) vs_variation_begin(l->variation, setup);
  vs_status status = vs_session_run(&session, other, r, &err);
  EXPECT(!status, "%s", err.text);
  free(r);
  free(other);
}

/* One column of the derivative by central differences over a step and over half of it, extrapolated
 * (Richardson). */
static void difference(const vs_scene *s, const vs_setup *setup, int j, double step,
                       double column[MOST]) {
  int dof = s->setup.model.dof;
  double quotient[2][MOST];
  for (int fine = 0; fine < 2; fine++) {
    double by = fine ? step / 2 : step;
    looker l[2] = {{0}};
    for (int up = 0; up < 2; up++) {
      vs_setup moved = *setup;
      double *x = j < 2 * dof ? &moved.start.x[j] : &moved.start.flux_wb;
      /* lambda stays, where x moves the gap at which the coil has none without a current */
      const vs_model *m = &moved.model;
      double idle = vs_coil_idle_flux(&m->coil, vs_mechanics_gap(m, moved.start.x));
      *x += up ? by : -by;
      moved.start.flux_wb += idle - vs_coil_idle_flux(&m->coil, vs_mechanics_gap(m, moved.start.x));
      if (j == 2 * dof) moved.start.flux_wb = *x;
      go(s, &moved, &l[up]);
    }
    for (int i = 0; i <= 2 * dof; i++)
      quotient[fine][i] = (l[1].end[i] - l[0].end[i]) / (2 * by);
  }
  for (int i = 0; i <= 2 * dof; i++) column[i] = (4 * quotient[1][i] - quotient[0][i]) / 3;
}

/* Returns the largest difference between the two, in parts of each state's scale, relative to the
 * largest entry. part: the differences' step, in parts of the scale. */
static double worst(const vs_scene *s, const vs_setup *setup, double part, looker *seen) {
  vs_variation variation;
  looker l = {.variation = &variation};
  int states = 2 * s->setup.model.dof;
  double off = 0, largest = 0, column[MOST] = {0};
  go(s, setup, &l);
  for (int j = 0; j < variation.columns; j++) {
    difference(s, setup, j, part * l.size[j], column);
    for (int i = 0; i < variation.columns; i++) {
      double own = vs_variation_get(&variation, i, j), unit = l.size[j] / l.size[i];
      off = fmax(off, fabs(own - column[i]) * unit);
      largest = fmax(largest, fabs(own) * unit);
    }
  }
  EXPECT(variation.columns == states || l.fired == 0, "%d columns", variation.columns);
  vs_variation_end(&variation);
  *seen = l;
  return off / largest;
}

typedef struct derived {
  const char *scene;
  double until_s, part;
  bool contact, firing;
  const char *sets[6];
} derived;

static void derivatives_are_those_of_runs(void) {
  static const derived ROWS[] = {
      {"paper", 0.02, 1e-3, false, true, {"firing.every=1", NULL}},
      {"paper", 0.05, 1e-3, false, true, {"firing.every=1", "firing.angle=80deg", NULL}},
      {"paper", 0.02, 1e-4, true, true, {"firing.every=1", "firing.angle=90deg", STOP,
                                         "start.vp=-4 m/s", NULL}},
      {"paper", 0.02, 1e-4, true, true,
       {"firing.every=1", "start.vp=-4 m/s", "actuator.stop={kind: quadratic_clipped, stiffness: "
                                             "1e10 N/m2, damping: 50 N.s/m}", NULL}},
      {"paper", 0.02, 1e-3, false, true,
       {"firing.every=1", "actuator.saturation={law: series, flux: 1.2 Wb, exponent: 7, current: "
                          "0.2 A}", NULL}},
      {"paper", 0.02, 1e-3, false, true,
       {"firing.every=1", "actuator.saturation={law: series, flux: 1.2 Wb, exponent: 7, current: "
                          "0.2 A}", "actuator.leakage=0.15H", NULL}},
      {"two_mass", 0.02, 1e-3, false, true, {"firing.every=1", "firing.angle=130deg", NULL}},
      {"fixed_base", 0.02, 1e-3, false, true, {"firing.every=1", "firing.angle=150deg", NULL}},
      {"lds_v203", 0.01, 1e-3, false, false, {"supply.kind=sine", "supply.frequency=20Hz", NULL}},
      {"solenoid", 0.0122, 1e-4, false, false, {NULL}},
      {"solenoid", 0.014, 1e-5, true, false, {NULL}},
      {"solenoid", 0.014, 1e-5, true, false,
       {"actuator.stop={kind: linear, stiffness: 1e6 N/m, damping: 200 N.s/m, at: 0.25 mm}", NULL}},
  };
  for (size_t k = 0; k < COUNT(ROWS); k++) {
    const derived *row = &ROWS[k];
    looker seen;
    vs_trial *t = vs_trial_read(row->scene, "switched", row->sets);
    EXPECT(!t->status, "%zu: %s", k, t->err.text);
    if (!t->status) {
      vs_run_values run = t->scene.setup.run;
      run.until_s = row->until_s;
      run.tolerance = t->scene.tier->finest;
      const vs_setup setup = vs_setup_varied(&t->scene.setup, &run, NULL);
      double off = worst(&t->scene, &setup, row->part, &seen);
      if (getenv("VS_SHOW")) printf("%zu %s: %.2g met %d left %d fired %d out %d\n", k, row->scene, off, seen.met, seen.left, seen.fired, seen.out);
      EXPECT(off < 1e-7, "%zu, %s: off by %.3g", k, row->scene, off);
      EXPECT((seen.met > 0) == row->contact && (seen.out > 0) == row->firing, "%zu: %d %d", k,
             seen.met, seen.out);
    }
    vs_trial_free(t);
  }
}

static const vs_test TESTS[] = {
    {"derivatives are those of runs", derivatives_are_those_of_runs},
};
VS_SUITE_MAIN("shooting", TESTS)
