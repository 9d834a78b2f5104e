/* SPDX-License-Identifier: GPL-3.0-or-later
 * The largest and least values of channels over a run. They are taken from the dense output and not
 * from samples of it, so that no row of the run's CSV lies beyond them by more than rounding.
 *
 * Between two knots the coordinates and the flux linkage are polynomials of time. On a plain model
 * (plant/model.h) so are the force, the current and the accelerations. A polynomial never leaves
 * the range of its Bernstein coefficients. Where that range ends before the extreme known so far,
 * the step holds no new one. Otherwise the step is cut until the polynomial's slope changes sign
 * only once, and that root is found.
 *
 * On other models force, current and accelerations are taken from a polynomial through 15 of their
 * values, and a step is cut until that polynomial fits to 1e-12 of the step's largest value. At a
 * corner of the law or of a stop's force the extreme is off by what the channel changes in a
 * thousand millionth of the step. */
#pragma once

#include <float.h>
#include <math.h>
#include <stdbool.h>

#include "engine/step.h"

/* A number that a run gave, in SI, with the instant it belongs to. */
typedef struct vs_value {
  bool known;         /* false: the run had nothing to measure, as no firing or too few extremes */
  double value, at_s; /* at_s: NaN where the value belongs to no instant */
} vs_value;

/* Returns the number, in SI, as it is told: 0 where it is no more than rounding. size: of what it
 * was summed from or subtracted from; 0: not known. No voltage, current, travel, energy or rate of
 * what is computed here means anything below 1e-20. */
static inline double vs_extreme_told(double value, double size) {
  return fabs(value) <= fmax(4 * DBL_EPSILON * fabs(size), 1e-20) ? 0 : value;
}

/* The largest or least value of one channel so far. */
typedef struct vs_extreme {
  int channel; /* a coordinate, a second rate, VS_CH_TRAVEL, VS_CH_I, VS_CH_FORCE or a probe of the
                  deck */
  int sense;   /* +1 the largest, -1 the least, 0 the largest magnitude; a probe has no 0 */
  vs_value best;
  /* of a probe alone, whose steps are straight lines */
  bool is_last;   /* best is the end of the last step */
  double climbed; /* how much the last step that brought it went up to it */
  double stands; /* how much it stands out from the ends of the steps beside it, the nearer of them;
                    0 until both are known */
  bool idle;     /* nobody wants it, and it is not followed */
} vs_extreme;

/* Takes a step of some length into account, with both its ends. jammed: the armature is held, and
 * the accelerations of the knots are not those of the channels. */
void vs_extreme_follow(vs_extreme *extreme, const vs_step *step, bool jammed);

/* The extremes of a coordinate that are followed: its least and largest value, and the largest
 * magnitude of its acceleration. */
enum { VS_LEAST, VS_LARGEST, VS_PEAK, VS_OF_COORDINATE };
/* Does the same for the extremes of all coordinates, `all` being those of the first coordinate in
 * the order above, then those of the second, and so on. Most steps are seen to hold none of a
 * coordinate's extremes at a glance. All three of a coordinate are idle or none is. */
void vs_extreme_follow_motion(vs_extreme *all, const vs_step *step, bool jammed);

/* Does the same for the least and the largest value of each of the deck's probes, one pair behind
 * the other. */
void vs_extreme_follow_probes(vs_extreme *pairs, const vs_step *step);

/* The same for the least or the largest value of any channel, by 15 of its values in a step where
 * it is no probe. That costs more. */
void vs_extreme_follow_any(vs_extreme *extreme, const vs_step *step);

/* Finds where the travel turns in a step whose ends have velocities of unlike signs. Returns false
 * and leaves `turn` as it is where they have not. */
bool vs_extreme_turn_of_travel(const vs_step *step, vs_value *turn);
