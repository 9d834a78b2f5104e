/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of picture that show how a column is distributed over many cases, and what causes that. */
#pragma once

#include "plot/study_plot.h"

/* Returns the percentile of a sorted list by linear interpolation between its values: type 7 of
 * Hyndman and Fan (The American Statistician, 1996). NaN: the list is empty. For tests. */
double vs_spread_percentile(const double *rising, size_t count, double percent);

/* The bars of a histogram of a sorted list that is not empty. If `joint` lies between the list's
 * ends, two bars meet there, so that none lies on both sides of it; NaN: there is no such place. */
enum { VS_BINS = 64 };
typedef struct vs_bins {
  double width;
  size_t count;
  struct {
    double middle;
    size_t
        cases; /* number of cases in [left end, right end); the last bar includes its right end */
  } item[VS_BINS];
} vs_bins;
/* For tests. */
vs_bins vs_spread_bins(const double *rising, size_t count, double joint);
