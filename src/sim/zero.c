/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/zero.h"

#include <math.h>

/* A kink inside a step spoils the second order of the solver's rule. And a step that it tries and
 * rejects because of a kink has its end stay in Newton's iteration: a latch that has let go in it
 * then does so at the beginning of the next try, before its current is zero. So no step that would
 * pass the zero is tried but from close by. */

/* The step that passes the zero begins and ends so near to it. At the zero itself rounding would
 * decide whether the thyristor conducts, which is some 1e-13 s. What is chopped off the current,
 * 20 nA where it falls by 200 A/s, makes 20 V at an off_resistance of 1 Gohm. */
static const double NEAR_S = 1e-10;
/* Up to there a step goes this part of the way: a current is so straight on it that it does not
 * pass the zero. */
static const double PART_WAY = 0.9;
/* Below it a voltage may be an on-state one. */
static const double BLOCKED_V = 10;

vs_zero vs_zero_begin(void) {
  return (vs_zero){.crosses_s = INFINITY};
}

/* Leakage flows beside what an ideal latch lets go of at zero. */
void vs_zero_take(vs_zero *z, double t_s, double i_a, double v_v, bool conducts) {
  z->crossed = z->nearing && t_s >= z->crosses_s;
  if (conducts)
    z->nearing = true;
  else if (z->crossed || !(i_a - z->leak_s * v_v > 0))
    z->nearing = false;
  if (!z->nearing && fabs(v_v) > BLOCKED_V) z->leak_s = fmax(i_a / v_v, 0);
  z->before_s = z->last_s;
  z->before_a = z->last_a;
  z->last_s = t_s;
  z->last_a = i_a - z->leak_s * v_v;
}

double vs_zero_longest(vs_zero *z, double max_step_s) {
  z->crosses_s = INFINITY;
  double fall_a = z->before_a - z->last_a;
  if (!z->nearing || !(fall_a > 0)) return INFINITY;
  double left_s = (z->last_s - z->before_s) * z->last_a / fall_a;
  if (!(left_s > 0 && left_s < 2 * max_step_s)) return INFINITY;
  if (left_s > NEAR_S) return fmax(PART_WAY * left_s, NEAR_S / 2);
  z->crosses_s = z->last_s + left_s + NEAR_S / 2;
  return left_s + NEAR_S;
}
