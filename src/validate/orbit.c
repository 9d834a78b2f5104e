/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "validate/orbit.h"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
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
  double x[MOST];    /* the state at the end */
  double size[MOST]; /* the largest magnitude of each state on the way from rest: its scale */
  bool sizing;       /* that way is being flown */
} flight;

static vs_status accept(void *ctx, const vs_step *step, const vs_result *result, vs_error *err) {
  flight *f = ctx;
  (void)result;
  memcpy(f->x, step->to->x, sizeof f->x);
  for (int j = 0; f->sizing && j < 2 * step->frame->model->dof; j++)
    f->size[j] = fmax(f->size[j], fabs(step->to->x[j]));
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

/* Steps of the difference quotients: a thousandth of the state's own scale. The step of a state
 * that does not move is of no account, but not 0. */
static double small_step(const flight *f, int state) {
  return f->size[state] > 0 ? 1e-3 * f->size[state] : 1e-6;
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
    moved[j] += small_step(f, j);
    status = fly(s, moved, period_s, f, NULL, err);
    for (int i = 0; i < n; i++)
      matrix[i * n + j] = (i == j) - (f->x[i] - end[i]) / small_step(f, j);
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
    *change = fmax(*change, fabs(by[j]) / small_step(f, j));
  }
  return VS_OK;
}

/* Over one period from x. */
static vs_status measure(const vs_scene *s, const double *x, double period_s, flight *f,
                         vs_numbers *out, vs_error *err) {
  vs_result *r = vs_alloc(1, sizeof *r);
  f->also = NULL;
  vs_status status = fly(s, x, period_s, f, r, err);
  if (!status) {
    const double *joule = r->watchers.energy.joule;
    vs_experiment_add_measures(&s->setup.model, r, out);
    vs_experiment_add(out, joule[VS_E_SOURCE] / period_s, "power");
    vs_experiment_add(out, joule[VS_E_COPPER] / period_s, "power_copper");
    vs_experiment_add(
        out, sqrt(joule[VS_E_COPPER] / s->setup.model.actuator.resistance_ohm / period_s), "i_rms");
  }
  vs_result_free(r);
  free(r);
  return status;
}

/* ---- multipliers ---- */

/* Fills one column of the map's derivative, of x(T) to the state j: the central difference quotient
 * over a step, and over half of it, extrapolated to none (Richardson). */
static vs_status derive(const vs_scene *s, const double *x, double period_s, flight *f, int j,
                        double *column, vs_error *err) {
  int n = 2 * s->setup.model.dof;
  double wide = 10 * small_step(f, j), quotient[2][MOST];
  vs_status status = VS_OK;
  for (int fine = 0; fine < 2; fine++) {
    double by = fine ? wide / 2 : wide, end[2][MOST];
    for (int up = 0; up < 2 && !status; up++) {
      double moved[MOST] = {0};
      memcpy(moved, x, (size_t)n * sizeof *moved);
      moved[j] += up ? by : -by;
      status = fly(s, moved, period_s, f, NULL, err);
      memcpy(end[up], f->x, sizeof end[up]);
    }
    for (int i = 0; i < n && !status; i++) quotient[fine][i] = (end[1][i] - end[0][i]) / (2 * by);
  }
  for (int i = 0; i < n && !status; i++) column[i] = (4 * quotient[1][i] - quotient[0][i]) / 3;
  return status;
}

static int falling(const void *left, const void *right) {
  const double *a = left, *b = right;
  return (*a < *b) - (*a > *b);
}

/* Adds the sizes of the multipliers, the largest first: multiplier1, multiplier2 ... */
static vs_status add_multipliers(const vs_scene *s, const double *x, double period_s, flight *f,
                                 vs_numbers *out, vs_error *err) {
  size_t n = 2 * (size_t)s->setup.model.dof;
  double matrix[MOST * MOST], column[MOST], size[MOST];
  f->also = NULL;
  for (size_t j = 0; j < n; j++) {
    vs_status status = derive(s, x, period_s, f, (int)j, column, err);
    if (status) return status;
    /* in parts of each state's scale, so that mixed units do not blur the eigenvalues */
    for (size_t i = 0; i < n; i++)
      matrix[i * n + j] = column[i] * small_step(f, (int)j) / small_step(f, (int)i);
  }
  gsl_matrix_view m = gsl_matrix_view_array(matrix, n, n);
  gsl_vector_complex *values = gsl_vector_complex_alloc(n);
  gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc(n);
  bool good = !gsl_eigen_nonsymm(&m.matrix, values, work);
  for (size_t k = 0; k < n; k++) size[k] = gsl_complex_abs(gsl_vector_complex_get(values, k));
  gsl_eigen_nonsymm_free(work);
  gsl_vector_complex_free(values);
  if (!good) return vs_fail(err, VS_RUN, "the orbit's multipliers cannot be found");
  qsort(size, n, sizeof *size, falling);
  for (size_t k = 0; k < n; k++) vs_experiment_add(out, size[k], "multiplier%zu", k + 1);
  return VS_OK;
}

/* ---- all of it ---- */

static vs_status find(const vs_scene *s, flight *f, bool multipliers, vs_numbers *out,
                      vs_error *err) {
  const vs_timeline *line = &s->setup.timeline;
  double period_s = line->firing.every * line->period_s, x[MOST], change = INFINITY;
  if (!(period_s > 0))
    return vs_fail(err, VS_INPUT, "an orbit needs continuous firing: firing.every is 'once'");
  double marched_s = fmax(1, round(s->setup.run.until_s / period_s)) * period_s;
  memcpy(x, s->setup.start.x, sizeof x);
  f->sizing = true;
  vs_status status = fly(s, x, marched_s, f, NULL, err);
  f->sizing = false;
  memcpy(x, f->x, sizeof x);
  /* what is left after a step of 1e-3 is far below the tier's own error */
  for (int n = 0; n < 20 && change > 1e-3 && !status; n++)
    status = improve(s, period_s, f, x, &change, err);
  if (!status && !(change <= 1e-3))
    status = vs_fail(err, VS_RUN, "no periodic orbit is found from here");
  if (!status) status = measure(s, x, period_s, f, out, err);
  if (!status && multipliers) status = add_multipliers(s, x, period_s, f, out, err);
  return status;
}

static vs_status find_from(const vs_scene *s, const vs_observer *also, bool multipliers,
                           vs_numbers *out, vs_error *err) {
  flight *f = vs_alloc(1, sizeof *f);
  f->scene = vs_alloc(1, sizeof *f->scene);
  f->also = also;
  vs_status status = find(s, f, multipliers, out, err);
  free(f->scene);
  free(f);
  return status;
}

vs_status vs_orbit_find(const vs_scene *s, const vs_observer *also, vs_numbers *out,
                        vs_error *err) {
  return find_from(s, also, false, out, err);
}

vs_status vs_orbit_perform(const vs_experiment *e, const vs_observer *also, vs_numbers *out,
                           vs_error *err) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_experiment_scene(e, NULL, scene, err);
  if (!status) status = find_from(scene, also, e->multipliers, out, err);
  vs_scene_free(scene);
  free(scene);
  return status;
}
