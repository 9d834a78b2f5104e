/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sampler.h"

#include <math.h>
#include <stdlib.h>

void vs_sampler_begin(vs_sampler *s, const vs_recording *r, double *computed) {
  *s = (vs_sampler){.recording = r, .computed = computed};
  s->channels = vs_alloc(VS_CH_MOST, sizeof *s->channels);
  s->meters = vs_alloc(r->columns.count + 1, sizeof *s->meters);
}

void vs_sampler_end(vs_sampler *s) {
  free(s->channels);
  free(s->meters);
}

void vs_sampler_restart(vs_sampler *s, const vs_scene *scene) {
  const vs_columns *columns = &s->recording->columns;
  s->scene = scene;
  s->next = 0;
  s->groups = 0;
  for (size_t k = 0; k < columns->count; k++) {
    const vs_recorded *c = &columns->item[k];
    if (c->instrument >= 0)
      vs_meter_begin(&s->meters[k], &scene->instruments.item[c->instrument], 0);
    else
      s->groups |= vs_channel_groups(&scene->setup.model, &c->channel, 1);
  }
}

/* Takes the meters, whose low-passes have to follow the channel all the time, to the step's end. */
static void follow_meters(vs_sampler *s, const vs_step *step) {
  const vs_columns *columns = &s->recording->columns;
  for (size_t k = 0; k < columns->count; k++)
    if (columns->item[k].instrument >= 0) vs_meter_shown(&s->meters[k], step, step->to->t_s);
}

/* How much before its end a run may stop: a solver's times are rounded. */
static const double ROUNDING = 1e-9;

/* Up to which instant the step has come; one that reaches the run's end has come to its last
 * sample. */
static double sampled_until_s(const vs_sampler *s, const vs_step *step) {
  double until_s = s->scene->setup.run.until_s;
  return step->to->t_s >= until_s * (1 - ROUNDING) ? fmax(step->to->t_s, until_s) : step->to->t_s;
}

void vs_sampler_accept(vs_sampler *s, const vs_step *step) {
  const vs_recording *r = s->recording;
  const double reached_s = sampled_until_s(s, step);
  double at_s = NAN;
  if (step->to->t_s == step->from->t_s) return; /* the other side of an instant already shown */
  if (s->next == r->n_samples) return;
  for (; s->next < r->n_samples && r->samples[s->next].t_s <= reached_s; s->next++) {
    const vs_sample *sample = &r->samples[s->next];
    const vs_recorded *c = &r->columns.item[sample->column];
    const double t_s = fmin(sample->t_s, step->to->t_s);
    if (c->instrument >= 0) {
      s->computed[s->next] = vs_meter_shown(&s->meters[sample->column], step, t_s);
    } else {
      if (t_s != at_s) vs_step_groups_at(step, t_s, s->groups, s->channels);
      at_s = t_s;
      s->computed[s->next] = s->channels[c->channel];
    }
    s->computed[s->next] *= c->si;
  }
  follow_meters(s, step);
}
