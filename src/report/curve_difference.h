/* SPDX-License-Identifier: GPL-3.0-or-later
 * How much two recorded curves differ. Between its rows each curve is taken as a straight line. */
#pragma once

#include "traces.h"

/* All in the columns' unit. NaN: there is no time at which both curves are known. */
typedef struct vs_curve_difference {
  double peak;       /* largest size of either curve while both are known */
  double largest;    /* B - A where it is largest in size */
  double at_s;       /* the time of that */
  double rms;        /* r.m.s. value of B - A over the time at which both are known */
  double from, to_s; /* the first and the last time at which both are known, s */
} vs_curve_difference;

/* Compares column a of one run with column b of the other, at the times of the rows of both.
 * Between these B - A is a straight line, so that its maximum and its mean square are exact. */
vs_curve_difference vs_curve_difference_of(const vs_traces *one, int a, const vs_traces *other,
                                           int b);
