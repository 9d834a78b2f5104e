/* SPDX-License-Identifier: GPL-3.0-or-later
 * Pictures of one column of a study, each for another kind of question. All are vs_sketch_draw. */
#ifndef VS_PICTURE_CHARTS_H
#define VS_PICTURE_CHARTS_H

#include "picture/sketch.h"

/* Over the one axis; with a second axis of few words, a line for each. */
vs_status vs_charts_curve(const vs_sketch *k, size_t column, vs_picture *p, vs_error *err);
enum { VS_FAMILY = 7 }; /* lines at most */
/* How its values are spread, with the 5th, 50th and 95th percentile; of a margin the yield. */
vs_status vs_spread_histogram(const vs_sketch *k, size_t column, vs_picture *p, vs_error *err);
/* The worst corners as bars: of the least margin; of other columns the largest amounts. */
vs_status vs_spread_bars(const vs_sketch *k, size_t column, vs_picture *p, vs_error *err);
/* Over the number of the case. */
vs_status vs_charts_cases(const vs_sketch *k, size_t column, vs_picture *p, vs_error *err);
/* The same, with the worst so far, of a search. */
vs_status vs_charts_path(const vs_sketch *k, size_t column, vs_picture *p, vs_error *err);
/* Cases that lie anywhere between two axes that are numbers: points in colour. */
vs_status vs_charts_cloud(const vs_sketch *k, size_t column, vs_picture *p, vs_error *err);
/* What a search for a snubber tried over its first two axes, and what holds. No name: the manifest
 * does not say. The column does not matter. */
vs_status vs_feasible_draw(const vs_sketch *k, size_t column, vs_picture *p, vs_error *err);
/* How much of the column moves with each axis that is a number: the correlation. Where
 * nothing moves it there is no picture: it has no name. */
vs_status vs_spread_influence(const vs_sketch *k, size_t column, vs_picture *p, vs_error *err);
/* Least, mean and largest at each value of one axis, over all the others. */
vs_status vs_spread_effect(const vs_sketch *k, size_t axis, size_t column, vs_picture *p,
                           vs_error *err);

/* By linear interpolation between the values of a rising list (Hyndman and Fan's type 7). */
double vs_spread_percentile(const double *rising, size_t count, double percent);

/* A histogram's bars, from the least value to the largest; at least one value. They meet at `joint`
 * where it lies between those (NAN: nowhere), so that none stands on both sides of it. */
enum { VS_BINS = 64 };
typedef struct vs_bins {
  double width;
  size_t count;
  struct {
    double middle;
    size_t cases; /* from its left end on, to before its right one; of the last bar, with it */
  } item[VS_BINS];
} vs_bins;
vs_bins vs_spread_bins(const double *rising, size_t count, double joint);

#endif
