/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/prediction.h"

#include <math.h>
#include <stdlib.h>

#include "run/session.h"
#include "sampler.h"

vs_prediction vs_prediction_of(const vs_fit_problem *q) {
  vs_prediction p = {
      .inquiry = q, .n_unknowns = q->n_unknowns, .n_residuals = vs_fit_problem_residuals(q)};
  for (size_t r = 0; r < q->n_runs; r++)
    p.rough = p.rough || q->runs[r].scene->tier->has_circuit || q->runs[r].scene->control.regulator;
  return p;
}

/* ---- its budget ---- */

/* Cycles of the mains that the search for an orbit takes, for each in its period, if it ends well:
 * the most that docs/operation.md and docs/power.md tell of. Without a circuit it marches on where
 * it is slow. */
enum { ORBIT_IDEAL = 4300, ORBIT_CIRCUIT = 60 };
/* What no budget has to exceed, and a long holds on every machine. */
static const double MOST_CYCLES = 2e9;

static void add_cycles_of_run(const vs_fit_problem_run *run, double cycles[VS_BUDGET_KINDS]) {
  const vs_scene *s = run->scene;
  const int every = s->setup.timeline.firing.every > 1 ? s->setup.timeline.firing.every : 1;
  const double period = (run->periods ? run->periods : 1) * every;
  const bool orbit = run->periods || s->setup.steady || s->setup.wants_fraction;
  const int kind = s->tier->has_circuit ? VS_BUDGET_CIRCUIT : VS_BUDGET_IDEAL;
  cycles[kind] += run->periods ? period : (double)vs_session_cycles(s);
  if (!orbit) return;
  cycles[VS_BUDGET_IDEAL] += ORBIT_IDEAL * period;
  if (s->tier->has_circuit) cycles[VS_BUDGET_CIRCUIT] += ORBIT_CIRCUIT * period;
}

void vs_prediction_limit(vs_prediction *p, double often) {
  const vs_fit_problem *q = p->inquiry;
  double cycles[VS_BUDGET_KINDS] = {0};
  for (size_t r = 0; r < q->n_runs; r++) add_cycles_of_run(&q->runs[r], cycles);
  p->budget = (vs_budget){.what = "fit"};
  for (int k = 0; k < VS_BUDGET_KINDS; k++)
    p->budget.most[k] =
        q->most_cycles ? q->most_cycles : lround(fmin(fmax(cycles[k] * often, 1), MOST_CYCLES));
  for (size_t r = 0; r < q->n_runs; r++) {
    p->budget.shows = p->budget.shows || q->runs[r].scene->order.shows;
    q->runs[r].scene->order.budget = &p->budget;
  }
}

void vs_prediction_unlimit(vs_prediction *p) {
  for (size_t r = 0; r < p->inquiry->n_runs; r++) p->inquiry->runs[r].scene->order.budget = NULL;
  vs_budget_end(&p->budget);
}

bool vs_prediction_spent(const vs_prediction *p) {
  return p->budget.out[VS_BUDGET_IDEAL] || p->budget.out[VS_BUDGET_CIRCUIT];
}

/* ---- a run ---- */

static vs_status begin_run_of_fit(void *ctx, vs_scene *scene, vs_error *err) {
  (void)err;
  vs_sampler_restart(ctx, scene);
  return VS_OK;
}

static vs_status accept_step_of_fit(void *ctx, const vs_step *step, const vs_result *result,
                                    vs_error *err) {
  (void)result, (void)err;
  vs_sampler_accept(ctx, step);
  return VS_OK;
}

static vs_status take_aims(const vs_fit_problem_run *run, const vs_measured *measured,
                           double *computed, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < run->aims.count && !status; k++)
    status = vs_target_computed(&run->aims.item[k], run->scene, measured, &computed[k], err);
  return status;
}

static vs_status run_copy(const vs_fit_problem_run *run, vs_scene *scene, vs_measured *measured,
                          double *computed, vs_error *err) {
  vs_sampler looks;
  const vs_session_listener guest = {
      .ctx = &looks, .begin = begin_run_of_fit, .accept = accept_step_of_fit};
  /* a winding's resistance follows what is watched of the run */
  const bool watched = run->aims.count || run->scene->control.regulator ||
                       run->scene->setup.model.actuator.winding.present;
  const vs_session session = {.guest = run->recorded ? &guest : NULL,
                              .bare = !watched && !run->scene->tier->has_circuit};
  vs_sampler_begin(&looks, &run->recording, computed + run->aims.count);
  vs_status status = vs_measured_run(measured, scene, run->periods, &session, err);
  if (!status && looks.next < run->recording.n_samples)
    status = vs_fail(err, VS_RUN, "the run ends before the sample at %.9g s",
                     run->recording.samples[looks.next].t_s);
  if (!status) status = take_aims(run, measured, computed, err);
  vs_sampler_end(&looks);
  return status;
}

/* A period of an orbit makes another scene of the one that is run, so that a copy is run. */
static vs_status run_scene(vs_prediction *p, const vs_fit_problem_run *run, double *computed,
                           vs_error *err) {
  if (!run->recorded && vs_targets_rest(&run->aims))
    return take_aims(run, NULL, computed + run->datum, err);
  vs_measured *measured = vs_alloc(1, sizeof *measured);
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  *scene = *run->scene;
  vs_status status = run_copy(run, scene, measured, computed + run->datum, err);
  if (!status && run->periods && vs_steady_is_judged(&measured->steady))
    p->unstable = p->unstable || !measured->steady.orbit.stable;
  vs_measured_free(measured);
  free(measured);
  free(scene);
  return status;
}

vs_status vs_prediction_settle(const vs_prediction *p, int number, const double *s, vs_error *err) {
  const vs_fit_problem *q = p->inquiry;
  vs_scene *scene = q->runs[number].scene;
  for (size_t k = 0; k < q->n_unknowns; k++)
    if (q->unknowns[k].run < 0 || q->unknowns[k].run == number)
      vs_unknown_put(&q->unknowns[k], s[k], &scene->tree);
  return vs_scene_reread(scene, err);
}

static vs_status predict_run(vs_prediction *p, int number, const double *s, double *computed,
                             vs_error *err) {
  p->runs++;
  vs_status status = vs_prediction_settle(p, number, s, err);
  return status ? status : run_scene(p, &p->inquiry->runs[number], computed, err);
}

vs_status vs_prediction_run(vs_prediction *p, int number, const double *s, double *computed,
                            vs_error *err) {
  vs_status status = VS_OK;
  p->unstable = false;
  for (int r = 0; r < (int)p->inquiry->n_runs && !status; r++)
    if (number < 0 || r == number) status = predict_run(p, r, s, computed, err);
  if (!status) return VS_OK;
  p->failures++;
  p->failed = *err;
  return status;
}

/* ---- residuals ---- */

/* NaN: a logarithm is asked for of numbers of unlike signs. */
static double find_residual(const vs_fit_problem *q, const vs_datum *d, double computed) {
  if (!d->relative) return (computed - d->value) / d->error;
  if (q->difference) return (computed / d->value - 1) / d->error;
  double ratio = computed / d->value;
  return ratio > 0 ? log(ratio) / d->error : NAN;
}

double vs_prediction_weight(const vs_fit_problem *q, const vs_datum *d, double computed) {
  if (!d->relative) return 1 / d->error;
  return 1 / ((q->difference ? d->value : computed) * d->error);
}

void vs_prediction_residuals(const vs_prediction *p, const double *s, const double *computed,
                             double *residual) {
  const vs_fit_problem *q = p->inquiry;
  size_t n = 0;
  for (; n < q->n_data; n++) residual[n] = find_residual(q, &q->data[n], computed[n]);
  for (size_t k = 0; k < q->n_unknowns; k++)
    if (!isnan(q->unknowns[k].prior))
      residual[n++] = (s[k] - q->unknowns[k].prior) / q->unknowns[k].prior_error;
}

vs_status vs_prediction_check_signs(const vs_prediction *p, const double *computed, vs_error *err) {
  const vs_fit_problem *q = p->inquiry;
  for (size_t n = 0; n < q->n_data; n++) {
    const vs_datum *d = &q->data[n];
    if (!isnan(find_residual(q, d, computed[n]))) continue;
    return vs_fail_at(
        err, d->where,
        "%s: %.6g was measured and %.6g is computed at the start; their signs "
        "are unlike, so that they have no ratio; change the sign, or write residual: difference",
        vs_fit_problem_name(q, d), d->value, computed[n]);
  }
  return VS_OK;
}
