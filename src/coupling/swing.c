/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupling/swing.h"

#include <math.h>

/* The trapezoidal rule puts lambda wrong by h^2/12 of its third derivative in each second, and
 * while the coil rings with the snubbers, these errors add up to one of its phase. At the next
 * firing they are at the flux linkage that the whole conduction then carries along, and in the
 * samples they are the current's own. So a step is as long as keeps
 *
 *   h^2/12 |lambda'''| T <= SHARE run.tolerance max |lambda|
 *
 * over the time T that the ring may last: LASTS radians of its own, and no more than a cycle of the
 * mains, in which the coil's resistance, if nothing else, has damped it. Measured over the 100
 * scenes of tests/test_tolerance_grid.c: with SHARE 0.3 an error is up to 2 times the tolerance,
 * with 1 up to 4.8 times; of LASTS a half more, with less of T. */
static const double SHARE = 0.2, LASTS = 100;

/* The derivatives are remembered over some ten steps: steps become no longer only because a swing
 * is just where they are none. */
static const double FADES = 0.9;

/* A firing at the very end of the half cycle brings next to nothing, and errors are held against
 * this part of what the mains may bring at most. */
static const double LEAST = 1e-3;

vs_swing vs_swing_of(const vs_setup *s) {
  const vs_timeline *t = &s->timeline;
  double fired = fmax((1 + cos(t->firing.angle_rad)) / 2, LEAST);
  return (vs_swing){.share = (s->run.gear ? SHARE / 4 : SHARE) * s->run.tolerance,
                    .period_s = t->period_s,
                    .flux_wb = fired * t->peak_v / t->omega_rad_s};
}

/* A voltage that bends within a step by this part of its slope is no swing that steps resolve: it
 * jumped, as a thyristor switched, or what is left of a jump alternates from step to step. Shorter
 * steps would only make more of it; what there is of truth in it is for the solver's own control.
 */
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
  if (!(w->bend_v_s2 > 0)) return INFINITY; /* NaN too: accept() will say so */
  double lasts_s = fmin(w->period_s, LASTS * w->slope_v_s / w->bend_v_s2);
  return sqrt(12 * w->share * w->flux_wb / (w->bend_v_s2 * lasts_s));
}
