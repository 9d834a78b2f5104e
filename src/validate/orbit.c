/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "validate/orbit.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

enum { MOST = VS_MOST_STATES };

/* What flies, where it ends, and who else is shown its steps. */
typedef struct flight {
  vs_scene *scene; /* room for the scene that is run, which borrows what the one given owns */
  const vs_observer *also;
  double x[MOST]; /* the state at the end */
} flight;

static vs_status accept(void *ctx, const vs_step *step, const vs_result *result, vs_error *err) {
  flight *f = ctx;
  (void)result;
  memcpy(f->x, step->to->x, sizeof f->x);
  return f->also ? f->also->accept(f->also->ctx, step, err) : VS_OK;
}

/* From the state x at t = 0 to until_s. result: what was measured on the way; NULL: only the state
 * is wanted. */
static vs_status fly(const vs_scene *s, const double *x, double until_s, flight *f,
                     vs_result *result, vs_error *err) {
  const vs_guest guest = {.ctx = f, .accept = accept};
  const vs_session session = {.guest = &guest, .bare = !result, .unguarded = true};
  vs_result *none = result ? NULL : vs_alloc(1, sizeof *none);
  vs_run_values run = s->setup.run;
  run.until_s = until_s;
  *f->scene = *s;
  f->scene->setup = vs_setup_varied(&s->setup, &run, x);
  f->scene->frame = vs_sim_frame(s->tier, &f->scene->setup);
  vs_status status = vs_session_run(&session, f->scene, result ? result : none, err);
  free(none);
  return status;
}

/* Steps of the difference quotients: a thousandth of what the paper's trough does at 50 Hz. */
static double small_step(const vs_scene *s, int state) {
  return state < s->setup.model.dof ? 1e-6 : 3e-4;
}

/* One step of Newton's for x(T) = x; *change: how far it went, in units of small_step. */
static vs_status improve(const vs_scene *s, double period_s, flight *f, double *x, double *change,
                         vs_error *err) {
  int n = 2 * s->setup.model.dof;
  double matrix[MOST * MOST], missing[MOST], end[MOST];
  vs_status status = fly(s, x, period_s, f, NULL, err);
  memcpy(end, f->x, sizeof end);
  for (int j = 0; j < n && !status; j++) {
    double moved[MOST] = {0};
    memcpy(moved, x, (size_t)n * sizeof *moved);
    moved[j] += small_step(s, j);
    status = fly(s, moved, period_s, f, NULL, err);
    for (int i = 0; i < n; i++)
      matrix[i * n + j] = (i == j) - (f->x[i] - end[i]) / small_step(s, j);
    missing[j] = end[j] - x[j];
  }
  if (status) return status;
  size_t order[MOST], size = (size_t)n;
  double by[MOST];
  int sign;
  gsl_matrix_view a = gsl_matrix_view_array(matrix, size, size);
  gsl_vector_view b = gsl_vector_view_array(missing, size), d = gsl_vector_view_array(by, size);
  gsl_permutation p = {size, order};
  if (gsl_linalg_LU_decomp(&a.matrix, &p, &sign) ||
      gsl_linalg_LU_solve(&a.matrix, &p, &b.vector, &d.vector))
    return vs_fail(err, VS_RUN, "the orbit's equations cannot be solved");
  *change = 0;
  for (int j = 0; j < n; j++) {
    x[j] += by[j];
    *change = fmax(*change, fabs(by[j]) / small_step(s, j));
  }
  return VS_OK;
}

static vs_status measure(const vs_scene *s, const double *x, double period_s, flight *f,
                         vs_numbers *out, vs_error *err) {
  vs_result *r = vs_alloc(1, sizeof *r);
  f->also = NULL;
  vs_status status = fly(s, x, period_s, f, r, err);
  if (!status) {
    vs_experiment_add(out, r->values[VS_M_GAP_MIN].value, "p_min");
    vs_experiment_add(out, r->values[VS_M_GAP_MAX].value, "p_max");
    vs_experiment_add(out, r->values[VS_M_I_PEAK].value, "i_peak");
    vs_experiment_add(out, r->values[VS_M_FORCE_PEAK].value, "force_peak");
    vs_experiment_add(out, r->watchers.energy.joule[VS_E_SOURCE] / period_s, "power");
  }
  vs_result_free(r);
  free(r);
  return status;
}

vs_status vs_orbit_find(const vs_scene *s, const vs_observer *also, vs_numbers *out,
                        vs_error *err) {
  const vs_timeline *line = &s->setup.timeline;
  double period_s = line->firing.every * line->period_s, x[MOST], change = INFINITY;
  double marched_s = fmax(1, round(s->setup.run.until_s / period_s)) * period_s;
  flight f = {.scene = vs_alloc(1, sizeof *f.scene), .also = also};
  memcpy(x, s->setup.start.x, sizeof x);
  vs_status status = fly(s, x, marched_s, &f, NULL, err);
  memcpy(x, f.x, sizeof x);
  /* what is left after a step of 1e-3 is far below the tier's own error */
  for (int n = 0; n < 20 && change > 1e-3 && !status; n++)
    status = improve(s, period_s, &f, x, &change, err);
  if (!status && !(change <= 1e-3))
    status = vs_fail(err, VS_RUN, "no periodic orbit is found from here");
  if (!status) status = measure(s, x, period_s, &f, out, err);
  free(f.scene);
  return status;
}

vs_status vs_orbit_perform(const vs_experiment *e, const vs_observer *also, vs_numbers *out,
                           vs_error *err) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_experiment_scene(e, NULL, scene, err);
  if (!status) status = vs_orbit_find(scene, also, out, err);
  vs_scene_free(scene);
  free(scene);
  return status;
}
