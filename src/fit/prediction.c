/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/prediction.h"

#include <math.h>
#include <stdlib.h>

#include "scene/session.h"
#include "steady/steady.h"

void vs_prediction_begin(vs_prediction *p, const vs_inquiry *q) {
  *p = (vs_prediction){.inquiry = q,
                       .n_unknowns = q->n_unknowns,
                       .n_residuals = vs_inquiry_residuals(q),
                       .channels = vs_alloc(VS_CH_MOST, sizeof(double))};
  for (size_t r = 0; r < q->n_runs; r++)
    p->any_circuit = p->any_circuit || q->runs[r].scene->tier->has_circuit;
}

void vs_prediction_free(vs_prediction *p) {
  free(p->channels);
  *p = (vs_prediction){0};
}

/* ---- a run ---- */

static unsigned groups_of(const vs_inquiry_run *run) {
  unsigned groups = 0;
  for (size_t c = 0; c < run->recording.n_columns; c++)
    groups |= vs_channel_groups(&run->scene->setup.model, &run->recording.columns[c].channel, 1);
  return groups;
}

void vs_prediction_sample(vs_sampler *s, const vs_step *step) {
  const vs_recording *r = &s->run->recording;
  double at_s = NAN;
  if (s->next == r->n_samples || r->samples[s->next].t_s > step->to->t_s) return;
  const unsigned groups = groups_of(s->run);
  for (; s->next < r->n_samples && r->samples[s->next].t_s <= step->to->t_s; s->next++) {
    const vs_sample *sample = &r->samples[s->next];
    if (sample->t_s != at_s) vs_step_groups_at(step, sample->t_s, groups, s->channels);
    at_s = sample->t_s;
    s->computed[s->next] = s->channels[r->columns[sample->column].channel];
  }
}

static vs_status begin(void *ctx, vs_scene *scene, vs_error *err) {
  vs_sampler *s = ctx;
  (void)scene, (void)err;
  s->next = 0;
  return VS_OK;
}

static vs_status accept(void *ctx, const vs_step *step, const vs_result *result, vs_error *err) {
  (void)result, (void)err;
  vs_prediction_sample(ctx, step);
  return VS_OK;
}

static vs_status take_aims(const vs_inquiry_run *run, const vs_result *result, double *computed,
                           vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < run->n_aims && !status; k++)
    status = vs_aim_computed(&run->aims[k], run->scene, result, &computed[k], err);
  return status;
}

static vs_status run_scene(vs_prediction *p, const vs_inquiry_run *run, double *computed,
                           vs_error *err) {
  vs_result *result = vs_alloc(1, sizeof *result);
  vs_sampler looks = {
      .run = run, .computed = computed + run->datum + run->n_aims, .channels = p->channels};
  const vs_guest guest = {&looks, begin, accept, NULL};
  const vs_session session = {.guest = run->recorded ? &guest : NULL,
                              .bare = !run->n_aims && !run->scene->tier->has_circuit &&
                                      !run->scene->control.regulator,
                              .steady = vs_steady_start};
  vs_status status = vs_session_run(&session, run->scene, result, err);
  if (!status && looks.next < run->recording.n_samples)
    status = vs_fail(err, VS_RUN, "the run ends before the sample at %.9g s",
                     run->recording.samples[looks.next].t_s);
  if (!status) status = take_aims(run, result, computed + run->datum, err);
  vs_result_free(result);
  free(result);
  return status;
}

vs_status vs_prediction_settle(const vs_prediction *p, int number, const double *s, vs_error *err) {
  const vs_inquiry *q = p->inquiry;
  vs_scene *scene = q->runs[number].scene;
  for (size_t k = 0; k < q->n_unknowns; k++)
    if (q->unknowns[k].run < 0 || q->unknowns[k].run == number)
      vs_unknown_put(&q->unknowns[k], s[k], &scene->tree);
  return vs_scene_again(scene, err);
}

static vs_status predict(vs_prediction *p, int number, const double *s, double *computed,
                         vs_error *err) {
  p->runs++;
  vs_status status = vs_prediction_settle(p, number, s, err);
  return status ? status : run_scene(p, &p->inquiry->runs[number], computed, err);
}

vs_status vs_prediction_run(vs_prediction *p, int number, const double *s, double *computed,
                            vs_error *err) {
  vs_status status = VS_OK;
  for (int r = 0; r < (int)p->inquiry->n_runs && !status; r++)
    if (number < 0 || r == number) status = predict(p, r, s, computed, err);
  if (!status) return VS_OK;
  p->failures++;
  p->failed = *err;
  return status;
}

/* ---- residuals ---- */

/* NaN: a logarithm is asked for of numbers of unlike signs. */
static double find_residual(const vs_inquiry *q, const vs_datum *d, double computed) {
  if (!d->relative) return (computed - d->value) / d->error;
  if (q->difference) return (computed / d->value - 1) / d->error;
  double ratio = computed / d->value;
  return ratio > 0 ? log(ratio) / d->error : NAN;
}

double vs_prediction_weight(const vs_inquiry *q, const vs_datum *d, double computed) {
  if (!d->relative) return 1 / d->error;
  return 1 / ((q->difference ? d->value : computed) * d->error);
}

void vs_prediction_residuals(const vs_prediction *p, const double *s, const double *computed,
                             double *residual) {
  const vs_inquiry *q = p->inquiry;
  size_t n = 0;
  for (; n < q->n_data; n++) residual[n] = find_residual(q, &q->data[n], computed[n]);
  for (size_t k = 0; k < q->n_unknowns; k++)
    if (!isnan(q->unknowns[k].prior))
      residual[n++] = (s[k] - q->unknowns[k].prior) / q->unknowns[k].prior_error;
}

vs_status vs_prediction_check_signs(const vs_prediction *p, const double *computed, vs_error *err) {
  const vs_inquiry *q = p->inquiry;
  for (size_t n = 0; n < q->n_data; n++) {
    const vs_datum *d = &q->data[n];
    if (!isnan(find_residual(q, d, computed[n]))) continue;
    return vs_fail_at(err, d->where,
                      "%s: %.6g was measured and %.6g is computed at the start; numbers of unlike "
                      "signs have no ratio: alter the sign, or write residual: difference",
                      vs_inquiry_name(q, d), d->value, computed[n]);
  }
  return VS_OK;
}
