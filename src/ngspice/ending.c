/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ending.h"

#include <math.h>

/* In parts of the largest step; ngspice's own measure, ten times its shortest step. */
static const double NEAR = 1e-10;
/* How exactly a half is a half. */
static const double ALIKE = 1e-6;

bool vs_ending_reached(double left_s, double max_step_s) {
  return left_s < NEAR * max_step_s;
}

double vs_ending_step(vs_ending *ending, double left_s, double step_s) {
  bool half = fabs(2 * step_s - left_s) < ALIKE * left_s;
  ending->halves = half ? ending->halves + 1 : 0;
  return ending->halves > 1 ? left_s : step_s;
}
