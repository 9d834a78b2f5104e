/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "jacobian.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "orbit/tangent.h"
#include "sampler.h"

/* Runs of the scene that derivatives take (orbit/tangent.h): to find the instants, how far they may
 * go, to show them. */
enum { RUNS_OF_KIN = 3 };

/* ---- differences ---- */

/* The step of s. The error of the formula goes with STEP^4, that of rounding with 1/STEP. On the
 * tiers without a circuit a run's numbers are smooth functions of its scene to some 1e-11, and a
 * motion turns by some 100 rad before it is measured: then both are near 1e-7 of the slope. A run
 * of the circuit has steps that depend on what happens, and numbers that are smooth to its
 * tolerance alone; one with a control fires by what an A/D shows, in its steps. */
static const double STEP = 3e-4, STEP_WHERE_ROUGH = 2e-2;

/* Runs with unknown k moved by `by`, and fills moved[n_data]. */
static vs_status run_moved(vs_prediction *p, size_t k, const double *s, double by, double *moved,
                           vs_error *err) {
  double *at = vs_alloc(p->n_unknowns, sizeof *at);
  memcpy(at, s, p->n_unknowns * sizeof *at);
  at[k] += by;
  vs_status status = vs_prediction_run(p, p->inquiry->unknowns[k].run, at, moved, err);
  free(at);
  return status;
}

/* A formula: slope = sum of weight[j] f(s + place[j] h)/h. */
typedef struct formula {
  double place[4], weight[4];
} formula;
/* y' = (y(-2h) - 8 y(-h) + 8 y(h) - y(2h))/(12 h), and the same order on one side, where y(0) has
 * the weight -25/12 (Abramowitz and Stegun, Handbook of Mathematical Functions, table 25.2). */
static const formula CENTRAL = {{-2, -1, 1, 2}, {1. / 12, -2. / 3, 2. / 3, -1. / 12}};
static const formula FORWARD = {{1, 2, 3, 4}, {4, -3, 4. / 3, -1. / 4}};
static const double FORWARD_AT_0 = -25. / 12;

/* The data of the run that has the unknown; of all where it is common. */
static void data_of_unknown(const vs_fit_problem *q, size_t unknown, size_t *from, size_t *to) {
  int run = q->unknowns[unknown].run;
  *from = run < 0 ? 0 : q->runs[run].datum;
  *to = run < 0 ? q->n_data : *from + q->runs[run].data;
}

static vs_status apply_difference(vs_prediction *p, size_t k, const double *s, const formula *f,
                                  double h, double *slope, vs_error *err) {
  size_t from, to;
  double *moved = vs_alloc(p->inquiry->n_data, sizeof *moved);
  vs_status status = VS_OK;
  data_of_unknown(p->inquiry, k, &from, &to);
  for (int j = 0; j < 4 && !status; j++) {
    status = run_moved(p, k, s, f->place[j] * h, moved, err);
    for (size_t n = from; n < to && !status; n++) slope[n] += f->weight[j] * moved[n] / h;
  }
  free(moved);
  return status;
}

static vs_status one_sided(vs_prediction *p, size_t k, const double *s, double h,
                           const double *computed, double *slope, vs_error *err) {
  size_t from, to;
  data_of_unknown(p->inquiry, k, &from, &to);
  memset(slope, 0, p->inquiry->n_data * sizeof *slope);
  for (size_t n = from; n < to; n++) slope[n] = FORWARD_AT_0 * computed[n] / h;
  return apply_difference(p, k, s, &FORWARD, h, slope, err);
}

/* Where a run on one side fails, as the machine does not exist there, the other side tells. */
static vs_status slope_by_differences(vs_prediction *p, size_t k, const double *s,
                                      const double *computed, double *slope, vs_error *err) {
  const double h = p->rough ? STEP_WHERE_ROUGH : STEP;
  memset(slope, 0, p->inquiry->n_data * sizeof *slope);
  if (!apply_difference(p, k, s, &CENTRAL, h, slope, err)) return VS_OK;
  *err = (vs_error){0};
  if (!one_sided(p, k, s, h, computed, slope, err)) return VS_OK;
  *err = (vs_error){0};
  return one_sided(p, k, s, -h, computed, slope, err);
}

static bool serves_always(const vs_prediction *p) {
  (void)p;
  return true;
}

/* ---- exact ---- */

enum { KIN = VS_STENCIL_RUNS };

/* The circuit's equations are its solver's own, and a control's decisions have no slopes. What else
 * stands in the way of one run's derivatives is seen when they are asked for. */
static bool has_kin(const vs_prediction *p) {
  return !p->rough;
}

/* True if something was recorded by instruments. */
static bool sees_through(const vs_fit_problem_run *run) {
  bool any = false;
  for (size_t c = 0; c < run->recording.columns.count; c++)
    any = any || run->recording.columns.item[c].instrument >= 0;
  return any;
}

/* What a run and its neighbours say in the place of each of the run's data. */
typedef struct kin_data {
  const vs_fit_problem_run *run;
  const vs_stencil *fan;
  double *value[KIN]; /* of the run's first datum */
  vs_sampler sampler[KIN];
} kin_data;

/* The neighbours are shown anew, from the begin on, where an attempt at them has failed. */
static void take_step(void *ctx, int k, const vs_step *step) {
  kin_data *all = ctx;
  if (step->from->t_s <= 0) vs_sampler_restart(&all->sampler[k], all->fan->scene[k]);
  vs_sampler_accept(&all->sampler[k], step);
}

static vs_status take_data(kin_data *all, vs_error *err) {
  const vs_fit_problem_run *run = all->run;
  const vs_stencil *fan = all->fan;
  vs_status status = VS_OK;
  for (int k = 0; k < KIN && !status; k++) {
    for (size_t a = 0; a < run->aims.count && !status; a++)
      status = vs_target_computed(&run->aims.item[a], fan->scene[k], fan->measured[k],
                                  &all->value[k][a], err);
    if (!status && all->sampler[k].next < run->recording.n_samples)
      status = vs_fail(err, VS_RUN, "the runs for its derivatives end before its last sample");
  }
  return status;
}

/* d/d ln(x) of each datum, or d/dx per unit of the key where x is 0; from there to d/ds. */
static void take_slopes(const kin_data *all, const vs_stencil *fan, const vs_unknown *u,
                        double *slope) {
  const vs_parameter *parameter = &fan->parameter;
  double unit = vs_units_factor(u->axis.unit), per_s = u->log ? 1 : u->scale * unit;
  if (!u->log) per_s /= parameter->size;
  for (size_t n = 0; n < all->run->data; n++) {
    double v[KIN];
    for (int k = 0; k < KIN; k++) v[k] = all->value[k][n];
    slope[all->run->datum + n] = per_s * vs_parameter_slope(parameter, v);
  }
}

/* Error: the neighbours cannot tell. A key that the tier ignores may still be one of an instrument.
 */
static vs_status follow_kin(const vs_sensitivity_problem *subject, kin_data *all,
                            const vs_unknown *u, double *slope, vs_error *err) {
  vs_stencil *fan = vs_alloc(1, sizeof *fan);
  const vs_asked key = {u->axis.key, u->axis.where};
  all->fan = fan;
  vs_status status = vs_tangent_find(fan, subject, &key, NULL, false, err);
  if (!status) {
    if (fan->parameter.idle && sees_through(all->run))
      status = vs_fail(err, VS_RUN, "a key of an instrument has no exact derivative");
    else if (!fan->parameter.idle)
      status = take_data(all, err);
    if (!status && !fan->parameter.idle) take_slopes(all, fan, u, slope);
    vs_stencil_end(fan);
  }
  free(fan);
  return status;
}

/* Why the run has no neighbours, that is, no derivative; NULL: it has one. Where a low-pass begins
 * on an orbit, its state there depends on the key, which the neighbours are not told. */
static const char *lacks_kin(const vs_fit_problem_run *run, const vs_sensitivity_problem *subject) {
  if (subject->inexact) return subject->inexact;
  return subject->calm && sees_through(run) ? "an instrument begins on the orbit" : NULL;
}

static vs_status find_in_run(const vs_fit_problem_run *run, const vs_unknown *u, kin_data *all,
                             double *slope, vs_error *err) {
  vs_sensitivity_problem subject;
  vs_status status = vs_sensitivity_problem_begin(&subject, run->scene, run->periods, err);
  const char *why = status ? NULL : lacks_kin(run, &subject);
  subject.shown = run->recorded ? take_step : NULL;
  subject.ctx = all;
  if (why) status = vs_fail(err, VS_RUN, "%s", why);
  if (!status) status = follow_kin(&subject, all, u, slope, err);
  vs_sensitivity_problem_end(&subject);
  return status;
}

static vs_status exact_in_run(vs_prediction *p, int number, size_t k, double *slope,
                              vs_error *err) {
  const vs_fit_problem_run *run = &p->inquiry->runs[number];
  double *values = vs_alloc(KIN * run->data, sizeof *values);
  kin_data all = {.run = run};
  for (size_t j = 0; j < KIN; j++) {
    all.value[j] = values + j * run->data;
    vs_sampler_begin(&all.sampler[j], &run->recording, all.value[j] + run->aims.count);
  }
  vs_status status = find_in_run(run, &p->inquiry->unknowns[k], &all, slope, err);
  for (size_t j = 0; j < KIN; j++) vs_sampler_end(&all.sampler[j]);
  free(values);
  p->runs += RUNS_OF_KIN;
  return status;
}

/* Where the neighbours cannot tell, as a run has no derivative, differences do. */
static vs_status slope_by_derivatives(vs_prediction *p, size_t k, const double *s,
                                      const double *computed, double *slope, vs_error *err) {
  const vs_fit_problem *q = p->inquiry;
  vs_error why = {0};
  vs_status status = VS_OK;
  memset(slope, 0, q->n_data * sizeof *slope);
  for (int r = 0; r < (int)q->n_runs && !status; r++) {
    if (q->unknowns[k].run >= 0 && q->unknowns[k].run != r) continue;
    status = vs_prediction_settle(p, r, s, &why);
    if (!status) status = exact_in_run(p, r, k, slope, &why);
  }
  if (!status) return VS_OK;
  p->inexact++;
  return slope_by_differences(p, k, s, computed, slope, err);
}

/* ---- the table ---- */

const vs_jacobian_kind vs_jacobian_exact = {"exact derivatives", has_kin, slope_by_derivatives},
                       vs_jacobian_differences = {"differences of fourth order", serves_always,
                                                  slope_by_differences};

vs_status vs_jacobian_fill(const vs_jacobian_kind *kind, vs_prediction *p, const double *s,
                           const double *computed, gsl_matrix *slopes, vs_error *err) {
  const vs_fit_problem *q = p->inquiry;
  double *slope = vs_alloc(q->n_data, sizeof *slope);
  vs_status status = VS_OK;
  gsl_matrix_set_zero(slopes);
  for (size_t k = 0; k < q->n_unknowns && !status; k++) {
    status = kind->column(p, k, s, computed, slope, err);
    for (size_t n = 0; n < q->n_data && !status; n++)
      gsl_matrix_set(slopes, n, k, slope[n] * vs_prediction_weight(q, &q->data[n], computed[n]));
  }
  size_t row = q->n_data;
  for (size_t k = 0; k < q->n_unknowns; k++)
    if (!isnan(q->unknowns[k].prior))
      gsl_matrix_set(slopes, row++, k, 1 / q->unknowns[k].prior_error);
  free(slope);
  return status;
}
