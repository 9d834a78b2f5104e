/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/swing.h"

#include <math.h>

/* The trapezoidal rule puts lambda wrong by h^2/12 of its third derivative in each second, and
 * while the coil rings with the snubbers, these errors add up to one of its phase. At the next
 * firing they are at the flux linkage that the whole conduction then carries along, and in the
 * samples they are the current's own. So a step is as long as keeps
 *
 *   h^2/12 |lambda'''| T <= PART run.tolerance max |lambda|
 *
 * over the time T that the ring may last: LASTS radians of its own, and no more than a cycle of the
 * mains, in which the coil's resistance, if nothing else, has damped it. Measured over the 100
 * scenes of tests/test_tolerance_grid.c: with PART 0.3 an error is up to 2 times the tolerance,
 * with 1 up to 4.8 times; of LASTS a half more, with less of T. */
static const double PART = 0.2, LASTS = 100;

/* The derivatives are remembered over some ten steps of a run at 1e-4, and over as long a time at a
 * finer tolerance: steps become no longer only because a swing is just where they are none. Over
 * ten steps of a finer run the error grew against the tolerance, 1.6 times from 1e-4 to 1e-7. */
static const double FADES = 0.9, FADES_AT = 1e-4;

/* A firing at the very end of the half cycle brings next to nothing, and errors are held against
 * this part of what the mains may bring at most. */
static const double LEAST = 1e-3;

vs_swing vs_swing_of(const vs_setup *s) {
  const vs_timeline *t = &s->timeline;
  double part = fmax((1 + cos(t->firing.angle_rad)) / 2, LEAST);
  return (vs_swing){.part = (s->run.gear ? PART / 4 : PART) * s->run.tolerance,
                    .fades = pow(FADES, fmin(1, sqrt(s->run.tolerance / FADES_AT))),
                    .period_s = t->period_s,
                    .flux_wb = part * t->peak_v / t->omega_rad_s};
}

/* A voltage that bends within a step by this part of its slope is no swing that steps resolve: it
 * jumped, as a thyristor switched, or what is left of a jump alternates from step to step. Shorter
 * steps would only make more of it; what there is of truth in it is for the solver's own control.
 */
static const double RESOLVED = 0.5;

/* What of v alternates from step to step is not damped by the trapezoidal rule, nor put into lambda
 * at the knots, but a cubic between them has it in its slopes, +-a, and is off by a h/4 halfway. An
 * inductance in series with the coil has it from the first steps after a firing: at 1e-14 s its
 * voltage is the rounding of its current. The rule that begins anew, of order one and with a step
 * that is no more so short, is rid of it. It does so after so many kicks that no swing that is
 * resolved makes them, and not again before as many steps have passed that it costs a few per cent
 * at most. */
static const int ALTERNATES = 6, PAUSE = 200;

static void follow_alternation(vs_swing *w, const vs_knot *from, const vs_knot *to) {
  double rise = to->flux_rate_v - from->flux_rate_v, kick = rise - w->rise_v;
  double off_wb = fabs(kick) / 4 * (to->t_s - from->t_s) / 4; /* a kick is 4 a */
  bool back = kick * w->kick_v < 0 && fabs(kick) > fabs(w->kick_v) / 2;
  w->alternations = back ? w->alternations + 1 : 0;
  w->since_anew++;
  w->anew =
      w->alternations >= ALTERNATES && w->since_anew >= PAUSE && off_wb > w->part * w->flux_wb;
  if (w->anew) w->since_anew = 0;
  w->rise_v = rise;
  w->kick_v = kick;
}

/* The slope that two steps have in common: neither a jump nor what alternates has one. */
static double common_slope(const vs_knot *from, const vs_knot *to) {
  double before = from->flux_rate2_v_s, now = to->flux_rate2_v_s;
  return before * now > 0 ? fmin(fabs(before), fabs(now)) : 0;
}

void vs_swing_take(vs_swing *w, const vs_knot *from, const vs_knot *to, double before_s) {
  double h = to->t_s - from->t_s;
  double bend = fabs(to->flux_rate2_v_s - from->flux_rate2_v_s) / ((h + before_s) / 2);
  w->slope_v_s = fmax(w->fades * w->slope_v_s, common_slope(from, to));
  w->bend_v_s2 = fmax(w->fades * w->bend_v_s2, bend * h <= RESOLVED * w->slope_v_s ? bend : 0);
  w->flux_wb = fmax(w->flux_wb, fabs(to->flux_wb));
  follow_alternation(w, from, to);
}

double vs_swing_longest(const vs_swing *w) {
  if (!(w->bend_v_s2 > 0)) return INFINITY; /* NaN too: accept() will say so */
  double lasts_s = fmin(w->period_s, LASTS * w->slope_v_s / w->bend_v_s2);
  return sqrt(12 * w->part * w->flux_wb / (w->bend_v_s2 * lasts_s));
}
