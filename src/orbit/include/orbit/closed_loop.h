/* SPDX-License-Identifier: GPL-3.0-or-later
 * The closed loop of a scene's control, where that is a PI controller of an amplitude: where it
 * comes to rest, its multipliers, and up to which gain it is stable.
 *
 * It is the linear model about the orbit that the control comes to rest on, with the sensor's
 * low-pass, whose output y[k] = C x[k] + D a[k] is the sensor's amplitude; the control knows it one
 * firing later. With P and I of control/regulator.h (vs_regulator_pi), r by how much the set point
 * is moved, and s the sum so far,
 *
 *   a[k] = (P + I) (m[k] - r) + s[k],   x[k+1] = A x[k] + B a[k],   m[k+1] = C x[k] + D a[k],
 *   s[k+1] = s[k] + I (m[k] - r).
 *
 * The loop's multipliers are the eigenvalues of this map of (x, m, s). The limits of the angle are
 * not reached by small deviations. What samples, noise and an A/D make of the amplitude is left
 * out.
 */
#pragma once

#include "base/json.h"
#include "orbit/averaged.h"

typedef struct vs_closed_loop {
  char sensor[VS_INSTRUMENT_NAME];
  const char *unit; /* of the sensor's channel, borrowed */
  vs_regulator_pi pi;
  double angle_rad;                           /* that it comes to rest at */
  double amplitude;                           /* the sensor's on that orbit, in its unit, SI */
  double period_s;                            /* from firing to firing */
  double gain;                                /* of the angle on that amplitude, per rad */
  int n;                                      /* multipliers */
  vs_multiplier multiplier[VS_LINEAR_STATES]; /* the largest first; a pair by falling imaginary
                                                 part */
  bool stable;
  /* The loop is stable as long as its gains are below this many times their own values: both, or
   * the proportional one alone with the integral one as it is. Where it is unstable now it is
   * stable up to so much from below. NaN: no limit lies between 0.001 and 1000 times. */
  double both_times, proportional_times;
  /* What a small step of the set point does, where the loop is stable and closed at all: `modes`,
   * of which output 0 is the amplitude over the set point; when it is within 1 % of its end for
   * good, and by which part of it it passes that. NaN where it is not known. */
  bool answers;
  vs_averaged modes;
  double settles_s, overshoot;
} vs_closed_loop;

/* Finds it. scene: on an ideal tier, settled, with its control's keys, also where the control is
 * off (vs_scene_disable_control); regulator: the one it has. orbit: of the scene, to begin the
 * search with. Errors: VS_INPUT, those of vs_linear_find; VS_RUN, no angle within control.angle
 * gives the set point; no orbit is found on the way. */
vs_status vs_closed_loop_find(const vs_scene *scene, const vs_regulator *regulator,
                              const vs_orbit *orbit, vs_closed_loop *closed, vs_error *err);

/* Prints it, and adds it as the member "closed_loop". */
void vs_closed_loop_print(const vs_closed_loop *closed, FILE *out);
void vs_closed_loop_json(const vs_closed_loop *closed, vs_json *json);
