/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/estimator.h"

#include <math.h>
#include <string.h>

/* ---- the force ---- */

/* The flux linkage at which the coil has this current. Newton's iteration begins at the last
 * sample's; a law that is linear in lambda takes one step. Where it does not settle, the last value
 * stays. */
static double estimated_flux(const vs_estimator *e, double current_a, double z_m) {
  enum { STEPS = 50 };
  const vs_coil *c = &e->model->coil;
  const double z[3] = {z_m, 0, 0};
  double flux = e->flux_wb, i[3], f[3];
  if (c->square) return 2 * c->a_hm * current_a / z_m;
  for (int n = 0; n < STEPS; n++) {
    const double rising[3] = {flux, 1, 0}; /* the current's rate is then di/dlambda */
    c->law->along(c, rising, z, i, f);
    double step = (i[0] - current_a) / i[1];
    if (!isfinite(step)) return e->flux_wb;
    flux -= step;
    if (fabs(step) <= 1e-12 * fabs(flux)) return flux;
  }
  return e->flux_wb;
}

/* The least gap for which the law is asked, as a part of that at rest: an estimate may be wrong,
 * but a closed gap would have no end of a force. */
static const double LEAST_GAP = 0.02;

/* F at a state with the measured current. */
static double force_at(vs_estimator *e, const double *x, double current_a) {
  const vs_model *m = e->model;
  double rest_m = m->coil.gap_rest_m, z = e->gap_at_rest ? rest_m : vs_mechanics_gap(m, x);
  if (m->coil.law->poles) z = fmax(z, LEAST_GAP * rest_m);
  e->flux_wb = estimated_flux(e, current_a, z);
  return vs_coil_force(&m->coil, e->flux_wb, z);
}

/* ---- the sensors ---- */

/* What the sensor's channel is at a state. */
static double channel_at(const vs_sensor *s, int states, const double *x, double force_n) {
  double sum = s->constant + s->of_force * force_n;
  for (int j = 0; j < states; j++) sum += s->row[j] * x[j];
  return sum;
}

/* By how much it is beyond the range; 0 within it. */
static double beyond_sensor_range(const vs_sensor *s, double y) {
  return y > s->range[1] ? y - s->range[1] : y < s->range[0] ? y - s->range[0] : 0;
}

/* Notes how far the channels are beyond their ranges, and takes from the low-passes what the
 * sensors did not show since the last sample. */
static void limit_sensors(vs_estimator *e, double *x, double force_n) {
  const vs_sampled_system *p = e->observing->system;
  for (int k = 0; k < p->sensors; k++) {
    const vs_sensor *s = &p->sensor[k];
    double was = e->beyond[k], is = beyond_sensor_range(s, channel_at(s, 2 * p->dof, x, force_n));
    for (int j = 0; j < s->states; j++)
      x[s->at + j] -= s->response[0][j] * was + s->response[1][j] * is;
    e->beyond[k] = is;
  }
}

/* ---- a sample ---- */

/* Puts the low-passes to where the run has them at its beginning: settled, or as its orbit has
 * them. */
static void begin_sensors(vs_estimator *e) {
  const vs_sampled_system *p = e->observing->system;
  for (int k = 0; k < p->sensors; k++) {
    const vs_sensor *s = &p->sensor[k];
    bool on_orbit = s->instrument->on_orbit && e->observing->v.knows_start;
    double y = channel_at(s, 2 * p->dof, e->x, e->force_n);
    e->beyond[k] = beyond_sensor_range(s, y);
    const double settled[2] = {y - e->beyond[k], 0};
    if (s->states)
      memcpy(e->x + s->at, on_orbit ? s->instrument->x : settled,
             (size_t)s->states * sizeof *settled);
  }
}

/* Takes the estimate on by one period, to the present current. */
static void predict_state(vs_estimator *e, double current_a) {
  const vs_sampled_system *p = e->observing->system;
  double x[VS_SAMPLED_MOST], ahead[VS_SAMPLED_MOST];
  for (int i = 0; i < p->states; i++) {
    double sum = p->constant[i] + p->b[0][i] * e->force_n;
    for (int j = 0; j < p->states; j++) sum += p->a[i][j] * e->x[j];
    x[i] = sum;
    ahead[i] = sum + p->b[1][i] * e->force_n;
  }
  double force = force_at(e, ahead, current_a); /* the gap hardly depends on this sample's force */
  for (int i = 0; i < p->states; i++) x[i] += p->b[1][i] * force;
  limit_sensors(e, x, force);
  memcpy(e->x, x, (size_t)p->states * sizeof *x);
  e->force_n = force;
}

static void correct_state(vs_estimator *e, const double *y) {
  const vs_sampled_system *p = e->observing->system;
  double off[VS_SENSOR_MOST];
  for (int k = 0; k < p->sensors; k++) {
    const vs_sensor *s = &p->sensor[k];
    double shown =
        s->states ? e->x[s->at] : channel_at(s, 2 * p->dof, e->x, e->force_n) - e->beyond[k];
    off[k] = y[k] - shown;
  }
  for (int i = 0; i < p->states; i++)
    for (int k = 0; k < p->sensors; k++) e->x[i] += e->observing->gain[i][k] * off[k];
}

void vs_estimator_begin(vs_estimator *e, const vs_state_observer *observing, const vs_frame *frame,
                        const double *start) {
  *e = (vs_estimator){
      .observing = observing, .model = frame->model, .gap_at_rest = frame->gap_at_rest};
  if (observing->v.knows_start) memcpy(e->x, start, 2 * (size_t)frame->model->dof * sizeof *start);
}

void vs_estimator_sample(vs_estimator *e, double current_a, const double *y) {
  if (!e->samples) {
    e->force_n = force_at(e, e->x, current_a);
    begin_sensors(e);
  } else {
    predict_state(e, current_a);
  }
  correct_state(e, y);
  e->force_n = force_at(e, e->x, current_a);
  e->samples++;
}

void vs_estimator_compare(vs_estimator *e, const double *x) {
  vs_estimator_errors *errors = &e->errors;
  double t_s = (double)(e->samples - 1) * e->observing->system->period_s;
  bool settled = t_s >= e->observing->settling_s;
  errors->after += settled;
  for (int k = 0; k < 2 * e->model->dof; k++) {
    double off = fabs(e->x[k] - x[k]);
    errors->peak[k] = fmax(errors->peak[k], fabs(x[k]));
    errors->all[k] = fmax(errors->all[k], off);
    if (settled) errors->settled[k] = fmax(errors->settled[k], off);
  }
}
