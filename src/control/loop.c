/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/loop.h"

#include <math.h>
#include <stdlib.h>

#include "base/units.h"
#include "engine/firing.h"

/* ---- decisions ---- */

/* Decides the next firing, whose cycle begins now, or, as the run begins, has begun before. */
static vs_status decide_firing(vs_loop *l, double t_s, vs_error *err) {
  const vs_control *c = l->control;
  vs_program *p = &l->program;
  double angle_rad = NAN;
  l->sight.t_s = t_s;
  l->sight.firing = p->count;
  vs_status status = c->regulator->decide(l->self, &l->sight, &angle_rad, err);
  if (status) return status;
  l->left_out += isnan(angle_rad);
  l->at_limit += angle_rad < p->range[0] || angle_rad > p->range[1];
  if (!isnan(angle_rad)) angle_rad = fmin(fmax(angle_rad, p->range[0]), p->range[1]);
  p->angle_rad[p->count++] = l->sight.last_rad = angle_rad;
  return VS_OK;
}

/* How many firings have a cycle that begins in the run. */
static long firings_of(const vs_timeline *t, double until_s) {
  double n = (until_s - vs_firing_cycle_s(t, 0)) / (t->firing.every * t->period_s);
  return n < 0 ? 1 : (long)n + 2;
}

vs_status vs_loop_begin(vs_loop *l, const vs_control *c, const vs_setup *setup,
                        const vs_instruments *instruments, vs_meter *meters, vs_error *err) {
  const vs_timeline *t = &setup->timeline;
  *l = (vs_loop){.control = c, .meters = meters};
  l->sight = (vs_control_input){.v = &c->v,
                                .setup = setup,
                                .instruments = instruments,
                                .observing = &c->observing,
                                .value = l->value,
                                .sensor = c->sensor,
                                .where = c->code,
                                .last_rad = NAN};
  for (size_t k = 0; k < sizeof l->value / sizeof *l->value; k++) l->value[k] = NAN;
  l->program.size = firings_of(t, setup->run.until_s);
  l->program.angle_rad = vs_alloc((size_t)l->program.size, sizeof *l->program.angle_rad);
  for (int k = 0; k < 2; k++) l->program.range[k] = c->v.angle_rad[k];
  l->self = vs_alloc(1, c->regulator->size + 1);
  vs_status status = c->regulator->begin ? c->regulator->begin(l->self, &l->sight, err) : VS_OK;
  while (!status && l->program.count < l->program.size &&
         vs_firing_cycle_s(t, (double)l->program.count) <= vs_scene_event_rounding(0))
    status = decide_firing(l, 0, err);
  return status;
}

/* ---- time passes ---- */

/* Instants that are meant to be the same may differ by rounding. */
static const double SAME = 1e-9; /* of the time between two ticks */

/* Has the instruments make the samples that are due up to t_s, and takes their values, in SI. */
static void read_meters(vs_loop *l, const vs_step *step, double t_s) {
  for (int k = 0; k < l->sight.instruments->count; k++) {
    vs_meter_to(&l->meters[k], step, t_s);
    l->value[k] = l->meters[k].value * vs_units_factor(l->meters[k].instrument->unit);
  }
}

/* A sample of the observer at t_s, from what the meters show. It is compared with the true motion.
 */
static void estimate(vs_loop *l, const vs_step *step, double t_s) {
  const vs_state_observer *o = &l->control->observing;
  double y[VS_SENSOR_MOST], all[VS_CH_MOST];
  double *value = l->value + l->sight.instruments->count;
  if (!o->system) return;
  if (!l->estimator.observing) vs_estimator_begin(&l->estimator, o, step->frame, step->from->x);
  for (int k = 0; k < o->system->sensors; k++) y[k] = l->meters[o->of_sensor[k]].value;
  vs_estimator_sample(&l->estimator, l->meters[o->of_current].value, y);
  vs_step_groups_at(step, t_s, VS_GROUP_VELOCITIES, all);
  vs_estimator_compare(&l->estimator, all + VS_CH_Q);
  for (int k = 0; k < o->estimates; k++)
    value[k] = l->estimator.x[k] * vs_units_factor(o->estimate[k].unit);
}

void vs_loop_run_to(vs_loop *l, const vs_step *step, double t_s) {
  const vs_regulator *r = l->control->regulator;
  const double rate_hz = l->control->v.rate_hz;
  for (double next_s; (next_s = (double)l->ticks / rate_hz) <= t_s + SAME / rate_hz; l->ticks++) {
    l->sight.t_s = next_s;
    read_meters(l, step, fmin(next_s, step->to->t_s));
    estimate(l, step, fmin(next_s, step->to->t_s));
    if (r->tick) r->tick(l->self, &l->sight);
  }
}

vs_status vs_loop_accept(vs_loop *l, const vs_step *step, vs_error *err) {
  double to_s = step->to->t_s, due_s = vs_firing_known_s(&l->sight.setup->timeline);
  if (to_s == step->from->t_s) return VS_OK; /* the other side of an instant already shown */

  /* Every tick of the control's clock in the step. */
  vs_loop_run_to(l, step, to_s);

  /* The next firing is decided at the beginning of its cycle, which no step goes beyond. */
  if (to_s < due_s - vs_scene_event_rounding(due_s)) return VS_OK;
  read_meters(l, step, to_s);
  return decide_firing(l, due_s, err);
}

/* ---- what it shows ---- */

double vs_loop_shows(const vs_loop *l, int k) {
  const vs_control *c = l->control;
  vs_control_column column;
  int of_observer = k - 1 - vs_control_outputs(c);
  if (k == 0) return l->sight.last_rad;
  if (!vs_control_column_at(c, k, &column)) return NAN;
  if (of_observer >= 0) return l->estimator.observing ? l->estimator.x[of_observer] : NAN;
  return c->regulator->output(l->self, k - 1) / vs_units_factor(column.unit);
}

void vs_loop_end(vs_loop *l) {
  if (l->self && l->control->regulator->end) l->control->regulator->end(l->self);
  free(l->self);
  free(l->program.angle_rad);
  *l = (vs_loop){0};
}
