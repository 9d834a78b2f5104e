/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "convergence.h"

#include <math.h>

/* Relative to run.tolerance: how well the orbit is to be known. */
static const double CLOSED = 0.01;
const double vs_convergence_crept = 0.1;
/* Corrections that have not come below this part of the least one in so many passes have stalled.
 */
static const double FALLS = 0.7;
enum { STALLED = 10 };

void vs_convergence_forget(vs_convergence *c) {
  c->before = c->creeps = c->remains = 0;
  c->ratio = NAN;
  c->steady = 0;
}

void vs_convergence_begin(vs_convergence *c, double tolerance) {
  *c = (vs_convergence){
      .tolerance = tolerance, .wanted = CLOSED * tolerance, .least = INFINITY, .ratio = NAN};
}

/* Something in the circuit that no probe shows may creep. Then corrections fall by about the same
 * factor over ENOUGH passes: a factor of SLOW and more, and each within SAME of the one before.
 * What is still to come is the sum of their series, of at most LASTS passes. The factor is kept
 * when the solver's rounding hides it later on. */
static const double SLOW = 0.6, SAME = 0.1, LASTS = 200;
enum { ENOUGH = 5 };

static void follow_ratio(vs_convergence *c) {
  double ratio = c->before > 0 ? c->last / c->before : NAN;
  bool same = fabs(ratio - c->ratio) <= SAME && ratio >= SLOW; /* false with NaN */
  c->steady = same ? c->steady + 1 : 0;
  c->ratio = ratio;
  c->before = c->last;
  if (c->steady == ENOUGH) c->creeps = ratio;
  if (c->steady > ENOUGH) c->creeps += (ratio - c->creeps) / ENOUGH;
  double series = c->creeps < 1 ? fmin(1 / (1 - c->creeps), LASTS) : LASTS;
  c->remains = c->creeps > 0 ? c->last * series : 0;
}

void vs_convergence_take(vs_convergence *c, double size) {
  c->last = size;
  follow_ratio(c);
  bool falls = c->last < FALLS * c->least;
  c->least = fmin(c->least, c->last);
  c->stalled = falls ? 0 : c->stalled + 1;
  c->noise = falls ? 0 : fmax(c->noise, c->last);
}

/* Corrections that do not fall any more are what the solver's rounding makes of them. The orbit is
 * then known as well as they are small, and that is enough where it is as well as the run is to be.
 */
bool vs_convergence_close(vs_convergence *c) {
  bool small = c->last <= c->wanted;
  bool stalled = c->stalled >= STALLED && c->noise <= c->tolerance;
  if (!(small || stalled) || c->remains > vs_convergence_crept * c->tolerance) return false;
  c->last = fmax(small ? c->last : c->noise, c->remains);
  return true;
}
