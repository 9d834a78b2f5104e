/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupling/pace.h"

#include <math.h>

/* Largest step and relative tolerance of the solver for a wanted error. Measured on T3A (tests): at
 * 25 us of a 20 ms period the trapezoidal rule leaves 6.5e-5 of the first peak, falling with the
 * square of the step; Gear's rule four times as much. */
double vs_pace_largest_step(const vs_setup *s) {
  double h = fmin(sqrt(s->run.tolerance / 1e-4) / 800, 1.0 / 200) * s->timeline.period_s;
  if (s->run.gear) h /= 2;
  return s->run.max_step_s > 0 ? s->run.max_step_s : h;
}

static vs_status note_depth(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  double *least_p_m = ctx;
  *least_p_m = fmin(*least_p_m, step->to->x[P]);
  return VS_OK;
}

/* Each blow on the stop multiplies what error p has, ten of them by 35; and between them there may
 * be conductions of 50 us from the snubbers alone, whose end the solver finds as well as its
 * tolerance lets it. Such a run takes shorter steps and a finer tolerance. Whether it is one, the
 * switched tier tells in a millisecond or two; a fifth of the gap is for what it leaves out. */
static bool has_blows(const vs_setup *s) {
  if (!s->model.actuator.stop.present) return false;
  double least_p_m = 0;
  const vs_observer observer = {&least_p_m, note_depth};
  vs_error err = {0};
  vs_status status = vs_switched_tier.run(s, NULL, &observer, &err);
  return status || least_p_m < -0.8 * s->model.actuator.gap_m;
}

/* At some hundred volts a solver's tolerance of 1e-4 is an exponential junction's whole step in
 * voltage: Newton's iteration then ends before a pair of transistors has fired (or goes on firing
 * and failing to). 1e-5 is measured to be fine enough; ideal switches it costs a few per cent. */
static const double COARSEST = 1e-5;

/* Below 1e-8 Newton's iteration would look for an end in the rounding errors. */
static const double FINEST = 1e-8;

static double solver_tolerance(const vs_setup *s, bool blows) {
  return fmin(fmax(s->run.tolerance / (blows ? 100 : 10), FINEST), COARSEST);
}

/* A step's truncation error is a part of a capacitor's charge, and so it falls with the third power
 * of the step; what such steps add up to, with the second. So it must fall as the tolerance to the
 * power of 1.5: the solver's tolerance sees to the first power, this to the rest. With that alone
 * the error was up to 50 times the tolerance at 1e-7 (tests/test_tolerance_grid.c). */
static double truncation(const vs_setup *s) {
  return s->run.trtol * fmin(1, sqrt(s->run.tolerance / 1e-4));
}

/* The amplitude of the current that the mains alone would drive through the coil at rest. */
static double current_scale(const vs_setup *s) {
  const vs_actuator_values *coil = &s->model.actuator;
  return s->timeline.peak_v /
         hypot(coil->resistance_ohm, s->timeline.omega_rad_s * coil->inductance_h);
}

/* A difference of voltages below the tolerance times this is none: some hundred volts are at work
 * in a converter, but nodes that stand for a flux linkage or a charge have some volts. */
static const double VOLTAGE_SCALE_V = 10;

/* No error of a charge below this matters, C: a microvolt on 1 nF. Without it, where a thyristor
 * fires while a snubber's capacitor is just empty, the solver takes steps of down to 1e-18 s to
 * keep a part of no charge, or finds none short enough and gives up. */
static const double LEAST_CHARGE_C = 1e-15;

vs_pace vs_pace_of(const vs_setup *s) {
  bool blows = has_blows(s);
  double tolerance = solver_tolerance(s, blows), h = vs_pace_largest_step(s);
  return (vs_pace){.max_step_s = blows && !(s->run.max_step_s > 0) ? h / M_SQRT2 : h,
                   .relative = tolerance,
                   .current_a = tolerance * current_scale(s),
                   .voltage_v = tolerance * VOLTAGE_SCALE_V,
                   .charge_c = LEAST_CHARGE_C / tolerance,
                   .truncation = truncation(s)};
}
