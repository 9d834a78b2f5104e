/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/sensitivity_problem.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "orbit/steady.h"
#include "poincare_map.h"

static const char *why_inexact(const vs_scene *s) {
  const vs_setup *setup = &s->setup;
  const vs_winding_values *winding = &setup->model.actuator.winding;
  if (s->tier->has_circuit) return "the circuit's equations are its solver's own";
  if (isfinite(vs_setup_jams(setup))) return "the armature jams";
  if (setup->model.coil.eddies) return "eddy currents keep a flux";
  if (winding->present && winding->r_th[0] + winding->r_th[1] > 0)
    return "the winding's temperature follows its losses";
  if (setup->loads.count) return "the load changes";
  if (s->control.regulator) return "a control decides the firings";
  if (setup->timeline.firing.angle.count) return "firing.angle is a table over time";
  if (setup->wants_fraction) return "load.fraction: auto is found by trial";
  return NULL;
}

vs_status vs_sensitivity_problem_begin(vs_sensitivity_problem *s, const vs_scene *scene,
                                       int periods, vs_error *err) {
  *s = (vs_sensitivity_problem){
      .scene = scene, .periods = periods, .inexact = why_inexact(scene), .until_s = INFINITY};
  if (s->inexact || (!periods && !scene->setup.steady)) return VS_OK;
  vs_status status =
      vs_tiers_require_orbits(periods ? "--steady" : "start: steady", scene->tier, scene->why,
                              vs_tree_place(scene->tree.root, "run.tier"), err);
  if (status) return status;
  if (periods) {
    s->calm = vs_alloc(1, sizeof *s->calm);
    *s->calm = *scene;
    s->calm->setup.steady = false;
    s->calm->frame = vs_sim_frame(s->calm->tier, &s->calm->setup);
  } else {
    s->calm = vs_steady_undisturbed(scene);
  }
  return vs_shooting_find(s->calm, periods ? periods : 1, &s->orbit, err);
}

void vs_sensitivity_problem_end(vs_sensitivity_problem *s) {
  free(s->calm);
  s->calm = NULL;
}

/* A firing period of this scene, s. */
static double firing_period(const vs_setup *setup) {
  const vs_timeline *line = &setup->timeline;
  return (line->firing.no_valve ? 1 : line->firing.every) * line->period_s;
}

vs_setup vs_sensitivity_problem_setup(const vs_sensitivity_problem *s, const vs_scene *scene,
                                      double tolerance) {
  vs_run_values run = scene->setup.run;
  run.tolerance = tolerance;
  if (!s->calm) run.until_s = fmin(run.until_s, s->until_s);
  if (!s->calm) return vs_setup_varied(&scene->setup, &run, NULL);
  if (s->periods) run.until_s = s->orbit.n * firing_period(&scene->setup);
  vs_setup along = vs_steady_setup(scene, &run, &s->orbit);
  along.steady = false;
  if (s->periods) return along;
  vs_setup setup = vs_setup_varied(&scene->setup, &run, NULL);
  setup.steady = false;
  setup.start = along.start;
  setup.timeline.firing.first_cycle = along.timeline.firing.first_cycle;
  return setup;
}

/* ---- how its beginning depends on a key ---- */

enum { ROWS = VS_VARIATION_MOST };

/* Solves (I - Phi) dx/dp = dx(T)/dp, in parts of each state's scale. */
static bool solve_for_start(const vs_orbit *o, const vs_variation *v, double dx[ROWS]) {
  size_t n = (size_t)o->count, order[ROWS];
  double matrix[ROWS * ROWS], side[ROWS], d[ROWS], most = 0, least = INFINITY;
  int sign;
  for (size_t i = 0; i < n; i++) {
    for (size_t j = 0; j < n; j++)
      matrix[i * n + j] = (i == j) - vs_variation_get((vs_variation *)(size_t)v, (int)i, (int)j) *
                                         o->scale[j] / o->scale[i];
    side[i] = vs_variation_get((vs_variation *)(size_t)v, (int)i, v->columns) / o->scale[i];
  }
  gsl_matrix_view a = gsl_matrix_view_array(matrix, n, n);
  gsl_vector_view b = gsl_vector_view_array(side, n), by = gsl_vector_view_array(d, n);
  gsl_permutation p = {n, order};
  if (gsl_linalg_LU_decomp(&a.matrix, &p, &sign)) return false;
  for (size_t i = 0; i < n; i++) {
    most = fmax(most, fabs(matrix[i * n + i]));
    least = fmin(least, fabs(matrix[i * n + i]));
  }
  if (!(least > 1e-13 * most) || gsl_linalg_LU_solve(&a.matrix, &p, &b.vector, &by.vector))
    return false;
  for (size_t i = 0; i < n; i++) dx[i] = d[i] * o->scale[i];
  return true;
}

vs_status vs_sensitivity_problem_start(const vs_sensitivity_problem *s, vs_parameter *parameter,
                                       double start[ROWS], vs_error *err) {
  vs_poincare_map flight;
  vs_poincare_map_begin(&flight, s->calm);
  flight.parameter = parameter;
  vs_status status = vs_poincare_map_go(&flight, s->orbit.x, s->orbit.n, true, err);
  if (!status && !solve_for_start(&s->orbit, &flight.variation, start))
    status =
        vs_fail(err, VS_RUN, "the orbit turns back here, and has no derivative with respect to %s",
                parameter->key.name);
  vs_poincare_map_end(&flight);
  return status;
}
