/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of picture that show how a column is spread over many cases, and what spreads it. */
#ifndef VS_REPORT_SPREAD_H
#define VS_REPORT_SPREAD_H

#include "plot/sketch.h"

/* "histogram": how the column's values are spread, with the 5th, 50th and 95th percentile; of a
 * margin also the yield. */
extern const vs_chart vs_spread_histogram;
/* "bars": the worst corners as bars: those of the least margin, of other columns those of the
 * largest amounts. */
extern const vs_chart vs_spread_bars;
/* "influence": the column's correlation with each axis that is a number. Where nothing moves the
 * column there is no picture. */
extern const vs_chart vs_spread_influence;
/* "effect": the column's least, mean and largest value at each value of one axis, over all other
 * axes. */
extern const vs_chart vs_spread_effect;

/* Returns the percentile of a rising list by linear interpolation between its values, which is type
 * 7 of Hyndman and Fan (The American Statistician, 1996). NaN: the list is empty. For tests. */
double vs_spread_percentile(const double *rising, size_t count, double percent);

/* A histogram's bars, from the least value to the largest of a rising list that is not empty. Where
 * `joint` lies between those two, two bars meet there, so that none stands on both sides of it;
 * NaN: there is no such place. */
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

#endif
