/* SPDX-License-Identifier: GPL-3.0-or-later
 * Regulator "phase": fires at a phase of the motion, and so keeps pace with the machine's own
 * frequency, whatever the load makes of it.
 *
 * The motion's phase is 0 where the sensor rises through the middle between its last largest and
 * smallest values. With t_z the last such instant and T the time from the one before,
 *
 *   phase(t) = 2 pi (t - t_z)/T.
 *
 * In the cycle to come the regulator fires where the phase is the one wanted, if that instant lies
 * within its limits of the angle, and leaves the firing out where it does not. The sensor's
 * low-pass shows the motion late by its own phase at 1/T, which is taken back. As long as the
 * sensor swings less than `threshold`, it fires at firing.angle. */
#include "control/regulators.h"

#include <math.h>

#define AT(member) offsetof(vs_control_values, member)
static const vs_field KEYS[] = {
    {"phase", VS_REAL, "deg", "90 deg", -360, 360, .offset = AT(phase_rad),
     .text = "phase of the motion at which it fires; 0 where the sensor rises through its middle"},
    {"threshold", VS_REAL, "~", "0", 0, 1e12, .offset = AT(threshold),
     .text = "amplitude below which it fires at firing.angle: half of the peak to peak value"}};
#undef AT

/* Between two rises the sensor must have been this share of its swing above its middle, and then
 * below it. So noise makes no rise, and neither does a pulse that moves the middle. */
static const double HYSTERESIS = 0.2;

typedef struct phase {
  vs_lowpass lowpass;      /* of the sensor */
  double low, high;        /* since the last rise */
  double middle, swing;    /* of the period before it; NaN: not known */
  double before_s, before; /* the last tick */
  bool was_high, was_low;  /* it was far enough above since then, and far enough below after that */
  double rise_s, period_s; /* the last rise, and the time from the one before; NaN: unknown */
} phase;

static vs_status begin_phase(void *self, const vs_control_input *s, vs_error *err) {
  (void)err;
  phase *p = self;
  p->lowpass = vs_regulator_lowpass(s);
  p->low = p->high = p->middle = p->swing = p->before = p->rise_s = p->period_s = NAN;
  p->was_high = true; /* the first rise wants nothing before it */
  return VS_OK;
}

/* The sensor has risen through its middle at t. */
static void note_rise(phase *p, double t_s) {
  p->period_s = t_s - p->rise_s;
  p->rise_s = t_s;
  p->middle = (p->high + p->low) / 2;
  p->swing = (p->high - p->low) / 2;
  p->low = p->high = NAN;
  p->was_high = p->was_low = false;
}

static void tick_phase(void *self, const vs_control_input *s) {
  phase *p = self;
  double y = s->value[s->sensor], before = p->before, before_s = p->before_s;
  p->low = fmin(p->low, y);
  p->high = fmax(p->high, y);
  p->before = y;
  p->before_s = s->t_s;
  double middle = isnan(p->middle) ? (p->low + p->high) / 2 : p->middle;
  double swing = isnan(p->swing) ? (p->high - p->low) / 2 : p->swing;
  if (y > middle + HYSTERESIS * swing) p->was_high = true;
  if (p->was_high && y < middle - HYSTERESIS * swing) p->was_low = true;
  if (p->was_low && before < middle && y >= middle)
    note_rise(p, before_s + (middle - before) / (y - before) * (s->t_s - before_s));
}

/* Two rises further apart than this many firing periods tell of no swing that goes on. */
static const double STALE = 3;

static vs_status decide_phase(void *self, const vs_control_input *s, double *angle_rad,
                              vs_error *err) {
  (void)err;
  const phase *p = self;
  const vs_timeline *t = &s->setup->timeline;
  double cycle_s = t->period_s, lag_rad, gain;
  *angle_rad = vs_field_profile_at(&t->firing.angle, s->t_s);
  bool known =
      p->swing > 0 && p->period_s < STALE * cycle_s && s->t_s - p->rise_s < STALE * cycle_s;
  vs_lowpass_response(&p->lowpass, known ? 1 / p->period_s : 0, &gain, &lag_rad);
  if (!known || p->swing / gain < s->v->threshold) return VS_OK;
  double turns = (s->v->phase_rad + lag_rad) / (2 * M_PI),
         wanted_s = p->rise_s + turns * p->period_s;
  double least_s = s->t_s + s->v->angle_rad[0] / t->omega_rad_s;
  wanted_s += ceil((least_s - wanted_s) / p->period_s) * p->period_s;
  double angle = (wanted_s - s->t_s) * t->omega_rad_s;
  *angle_rad = angle <= s->v->angle_rad[1] ? angle : NAN;
  return VS_OK;
}

static double output_phase(const void *self, int k) {
  const phase *p = self;
  return k == 0 ? 1 / p->period_s : p->swing;
}

const vs_regulator vs_phase_regulator = {
    .name = "phase",
    .text = "fires at a phase of the motion that a sensor shows: keeps pace with the resonance",
    .fields = KEYS,
    .n_fields = sizeof KEYS / sizeof *KEYS,
    .senses = true,
    .outputs = {{"f_motion", "Hz", false}, {"swing_meas", "~", false}},
    .size = sizeof(phase),
    .begin = begin_phase,
    .tick = tick_phase,
    .decide = decide_phase,
    .output = output_phase};
