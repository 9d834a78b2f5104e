/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupling/swing.h"

#include <math.h>

/* The trapezoidal rule makes an error of lambda of h^2/12 of its third derivative in each second.
 * While the coil rings with the snubbers, these errors add up to an error of the ring's phase. At
 * the next firing that is an error of the flux linkage from which the whole conduction starts, and
 * in between it is the current's own. So a step is as long as keeps
 *
 *   h^2/12 |lambda'''| T <= SHARE run.tolerance max |lambda|
 *
 * over the time T that the ring may last: LASTS radians of its own, and no more than a cycle of the
 * mains, in which the coil's resistance, if nothing else, has damped it. Measured over the 100
 * scenes of tests/test_tolerance_grid.c: with SHARE 0.3 an error is up to 2 times the tolerance,
 * with 1 up to 4.8 times. With half of LASTS, or less of T, it is more. */
static const double SHARE = 0.2, LASTS = 100;

/* The sizes of the derivatives fade by this factor a step, and so are remembered over some ten
 * steps: a step must not become longer only because the swing is just where a derivative is zero.
 */
static const double FADES = 0.9;

/* A firing at the very end of the half cycle brings next to no flux linkage. Errors are then
 * relative to this share of the most that the mains may bring. */
static const double LEAST = 1e-3;

vs_swing vs_swing_of(const vs_setup *s) {
  const vs_timeline *t = &s->timeline;
  double fired = fmax((1 + cos(t->firing.angle_rad)) / 2, LEAST);
  return (vs_swing){.share = (s->run.gear ? SHARE / 4 : SHARE) * s->run.tolerance,
                    .period_s = t->period_s,
                    .flux_wb = fired * t->peak_v / t->omega_rad_s};
}

/* A voltage whose slope changes within a step by more than this share is no swing that steps
 * resolve: it jumped, as a thyristor switched, or the rest of a jump alternates from step to step.
 * Shorter steps would only make more of it; what is true of it the solver's own step control
 * follows. */
static const double RESOLVED = 0.5;

void vs_swing_take(vs_swing *w, const vs_knot *from, const vs_knot *to) {
  double h = to->t_s - from->t_s;
  double bend = fabs(to->flux_rate2_v_s - from->flux_rate2_v_s) / ((h + w->before_s) / 2);
  w->before_s = h;
  w->slope_v_s = fmax(FADES * w->slope_v_s, fabs(to->flux_rate2_v_s));
  w->bend_v_s2 = fmax(FADES * w->bend_v_s2, bend * h <= RESOLVED * w->slope_v_s ? bend : 0);
  w->flux_wb = fmax(w->flux_wb, fabs(to->flux_wb));
}

double vs_swing_longest(const vs_swing *w) {
  if (!(w->bend_v_s2 > 0))
    return INFINITY; /* a NaN as well, of which the machine's motion will tell */
  double lasts_s = fmin(w->period_s, LASTS * w->slope_v_s / w->bend_v_s2);
  return sqrt(12 * w->share * w->flux_wb / (w->bend_v_s2 * lasts_s));
}
