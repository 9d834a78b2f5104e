/* SPDX-License-Identifier: GPL-3.0-or-later
 * A number that a run gave. */
#ifndef VS_MEASURE_VALUE_H
#define VS_MEASURE_VALUE_H

#include <float.h>
#include <math.h>
#include <stdbool.h>

/* In SI, with the instant it belongs to. */
typedef struct vs_value {
  bool known;         /* false: the run had nothing to measure, as no firing or too few extremes */
  double value, at_s; /* at_s: NaN where the value belongs to no instant */
} vs_value;

/* Returns the number, in SI, as it is told: 0 where it is no more than rounding. size: of what it
 * was summed from or subtracted from; 0: not known. No voltage, current, travel, energy or rate of
 * what is computed here means anything below 1e-20. */
static inline double vs_value_told(double value, double size) {
  return fabs(value) <= fmax(4 * DBL_EPSILON * fabs(size), 1e-20) ? 0 : value;
}

#endif
