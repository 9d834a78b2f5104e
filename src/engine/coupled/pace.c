/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/pace.h"

#include <math.h>

#include "engine/sim.h"

/* 1/800 of a period at a tolerance of 1e-4, and never more than 1/200. Measured on T3A (tests):
 * with 25 us in a period of 20 ms the trapezoidal rule is wrong by 6.5e-5 of the first peak, which
 * falls with the square of the step. Gear's rule is wrong by four times as much, and so takes half.
 */
double vs_pace_largest_step(const vs_setup *s) {
  double h = fmin(sqrt(s->run.tolerance / 1e-4) / 800, 1.0 / 200) * s->timeline.period_s;
  if (s->run.gear) h /= 2;
  return s->run.max_step_s > 0 ? s->run.max_step_s : h;
}

static vs_status note_nearness(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  double *nearest = ctx;
  double g = vs_mechanics_travel(step->frame->model, step->to->x);
  *nearest = fmax(*nearest, vs_stops_nearness(&step->frame->model->stops, g));
  return VS_OK;
}

/* Each blow on the stop multiplies the error of p, ten of them by 35. Between blows there may be
 * conductions of 50 us from the snubbers alone, whose end the solver finds as well as its tolerance
 * lets it. So a run with blows takes shorter steps and a finer tolerance. The switched tier tells
 * in a millisecond or two whether a run has any; a fifth of the way is for what it leaves out. */
static bool has_blows(const vs_setup *s) {
  if (!s->model.stops.count) return false;
  double nearest = 0;
  const vs_observer observer = {&nearest, note_nearness};
  vs_error err = {0};
  vs_setup uncontrolled = vs_setup_varied(s, &s->run, NULL);
  uncontrolled.timeline.program = NULL; /* nobody decides here */
  vs_status status = vs_switched_tier.run(&uncontrolled, NULL, &observer, &err);
  return status || nearest > 0.8;
}

/* The coarsest relative tolerance of the solver. At some hundred volts 1e-4 of them is the whole
 * step in voltage of an exponential junction: Newton's iteration then ends before a pair of
 * transistors has fired, or fires and fails to in turn. 1e-5 is measured to be fine enough; with
 * ideal switches it costs a few per cent of the time. */
static const double COARSEST = 1e-5;

/* The finest one: below it Newton's iteration would have to end within the rounding errors. */
static const double FINEST = 1e-8;

static double solver_tolerance(const vs_setup *s, bool blows) {
  return fmin(fmax(s->run.tolerance / (blows ? 100 : 10), FINEST), COARSEST);
}

/* The truncation error of a step, of a capacitor's charge, falls with the third power of the step;
 * what such errors add up to, with the second. So a step's error must fall as the tolerance to the
 * power of 1.5: the solver's tolerance sees to the first power, this factor to the rest. Without it
 * the error was up to 50 times the tolerance at 1e-7 (tests/engine/test_tolerance_grid.c). Above
 * 1e-4 it stands still. With the root, the coil's ring takes half the steps at 1e-1, and p, u, w,
 * phi and i were off by a fiftieth of that. But what is fast suffers, with the first step behind a
 * firing held short, too: the rise of a blocking voltage came out 25 % off at 1e-3 in the place of
 * 5 %, a chopper's losses at switching off 4 times too large at 1e-1. ngspice has one factor for
 * all steps of a run, so that the slow ones cannot be loosened alone.
 *
 * Each edge of a modulated switch makes an error of its own, and these add up: with the whole of
 * the factor a chopper's displacement was off by 11 tolerances, with half of it by 1.8; by
 * Gear's rule another's was by 4.4 and 2.4. */
static const double OF_MODULATED = 1.0 / 4;

static bool is_modulated(const vs_deck *d) {
  for (size_t k = 0; k < d->n_ports; k++)
    if (d->ports[k].signal.drive == VS_PORT_PWM) return true;
  return false;
}

static double truncation(const vs_setup *s) {
  const double part = is_modulated(&s->deck) ? OF_MODULATED : 1;
  return part * s->run.trtol * fmin(1, sqrt(s->run.tolerance / 1e-4));
}

/* The amplitude of the current that the mains alone would drive through the coil at rest. */
static double current_scale(const vs_setup *s) {
  const vs_coil *coil = &s->model.coil;
  return s->timeline.peak_v / hypot(coil->resistance_ohm, s->timeline.omega_rad_s * coil->rest_h);
}

/* A difference of voltages below the relative tolerance times this is none. In a converter some
 * hundred volts are at work, but a node that stands for a flux linkage or a charge has some volts.
 */
static const double VOLTAGE_SCALE_V = 10;

/* An error of a charge below this does not matter, C: it is a microvolt on 1 nF. Where a thyristor
 * fires while a snubber's capacitor is just empty, the solver would otherwise take steps of down to
 * 1e-18 s to hold an error relative to no charge, or would find no step short enough and give up.
 */
static const double LEAST_CHARGE_C = 1e-15;

vs_pace vs_pace_of(const vs_setup *s) {
  bool blows = has_blows(s);
  double tolerance = solver_tolerance(s, blows), h = vs_pace_largest_step(s);
  return (vs_pace){.blows = blows,
                   .max_step_s = blows && !(s->run.max_step_s > 0) ? h / M_SQRT2 : h,
                   .relative = tolerance,
                   .current_a = tolerance * current_scale(s),
                   .voltage_v = tolerance * VOLTAGE_SCALE_V,
                   .charge_c = LEAST_CHARGE_C / tolerance,
                   .truncation = truncation(s)};
}
