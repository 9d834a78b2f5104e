/* SPDX-License-Identifier: GPL-3.0-or-later
 * Regulator "amplitude": a PI controller that holds half the peak to peak value of a sensor at a
 * set point.
 *
 * With a the amplitude of the period before, r the set point and e = r - a, a firing has the angle
 *
 *   alpha = alpha_0 - K_p e - I,   I = K_i T sum of e over the firings so far,
 *
 * alpha_0 being firing.angle and T the time from firing to firing. A smaller angle gives more
 * amplitude, hence the signs. A step of I goes as far as takes alpha to its limit, and no further
 * (anti-windup by conditional integration). */
#include "control/regulators.h"

#include <math.h>

#define AT(member) offsetof(vs_control_values, member)
static const vs_field KEYS[] = {
    {"setpoint", VS_PROFILE, "~", "0", 0, 1e12, .offset = AT(setpoint),
     .text = "amplitude that the sensor is to show: half of its peak to peak value"},
    {"gain", VS_REAL, "deg/~", "0", -1e12, 1e12, .offset = AT(gain),
     .text = "K_p: fall of the angle per unit by which the amplitude is below the set point"},
    {"integral", VS_REAL, "deg/~.s", "0", -1e12, 1e12, .offset = AT(integral),
     .text = "K_i: the same, in each second"},
    {"sensor_gain", VS_REAL, "", "auto", 0, 1e6, true, AT(sensor_gain),
     .text = "shown amplitude over true amplitude; auto: gain of the sensor's low-pass at the "
             "frequency of firing",
     .choices = "auto"}};
#undef AT

typedef struct amplitude {
  double gain;      /* of the sensor */
  double low, high; /* of the sensor since the last decision; NaN: it has shown nothing */
  double measured;  /* over the last period; NaN: not known */
  double setpoint;
  double integral_rad; /* I */
} amplitude;

static double sensor_gain(const vs_control_input *s) {
  const vs_lowpass p = vs_regulator_lowpass(s);
  double gain, phase_rad;
  vs_lowpass_response(&p, vs_instruments_working_hz(s->setup), &gain, &phase_rad);
  return isnan(s->v->sensor_gain) ? gain : s->v->sensor_gain;
}

static vs_status begin_amplitude(void *self, const vs_control_input *s, vs_error *err) {
  (void)err;
  amplitude *a = self;
  a->gain = sensor_gain(s);
  a->low = a->high = a->measured = NAN;
  a->setpoint = vs_field_profile_at(&s->v->setpoint, 0);
  return VS_OK;
}

static void tick_amplitude(void *self, const vs_control_input *s) {
  amplitude *a = self;
  a->low = fmin(a->low, s->value[s->sensor]); /* fmin passes a NaN over */
  a->high = fmax(a->high, s->value[s->sensor]);
}

static vs_status decide_amplitude(void *self, const vs_control_input *s, double *angle_rad,
                                  vs_error *err) {
  (void)err;
  amplitude *a = self;
  const vs_timeline *t = &s->setup->timeline;
  const vs_control_values *v = s->v;
  double start_rad = vs_field_profile_at(&t->firing.angle, s->t_s);
  a->setpoint = vs_field_profile_at(&v->setpoint, s->t_s);
  a->measured = (a->high - a->low) / 2 / a->gain;
  a->low = a->high = s->value[s->sensor];
  *angle_rad = start_rad;
  if (isnan(a->measured) || s->firing == 0) return VS_OK;
  double e = a->setpoint - a->measured;
  double step_rad = v->integral * t->firing.every * t->period_s * e;
  double without_rad = start_rad - v->gain * e - a->integral_rad; /* the angle without the step */
  double down_rad = fmax(without_rad - v->angle_rad[0], 0);
  double up_rad = fmax(v->angle_rad[1] - without_rad, 0);
  a->integral_rad += fmin(fmax(step_rad, -up_rad), down_rad);
  *angle_rad = start_rad - v->gain * e - a->integral_rad;
  return VS_OK;
}

static double output_amplitude(const void *self, int k) {
  const amplitude *a = self;
  return k == 0 ? a->setpoint : a->measured;
}

/* With the last set point, and firing.angle as it is then: for ever. */
static vs_regulator_pi amplitude_as_pi(const vs_control_input *s) {
  const vs_timeline *t = &s->setup->timeline;
  double gain = sensor_gain(s), at_s = INFINITY;
  return (vs_regulator_pi){.wanted = gain * vs_field_profile_at(&s->v->setpoint, at_s),
                           .start_rad = vs_field_profile_at(&t->firing.angle, at_s),
                           .proportional = s->v->gain / gain,
                           .integral = s->v->integral * t->firing.every * t->period_s / gain};
}

const vs_regulator vs_amplitude_regulator = {
    .name = "amplitude",
    .text = "PI controller of half the peak to peak value that a sensor shows over a period",
    .fields = KEYS,
    .n_fields = sizeof KEYS / sizeof *KEYS,
    .senses = true,
    .outputs = {{"setpoint", "~", true}, {"amplitude_meas", "~", false}},
    .size = sizeof(amplitude),
    .begin = begin_amplitude,
    .tick = tick_amplitude,
    .decide = decide_amplitude,
    .output = output_amplitude,
    .pi = amplitude_as_pi};
