/* SPDX-License-Identifier: GPL-3.0-or-later
 * The largest rate of a course over a window. */
#pragma once

#include <stddef.h>

/* The largest rate of a course that runs straight from knot to knot. A rate is the change over a
 * window of exactly 0.1 us, or of another length, divided by that; the window may lie anywhere.
 *
 * The window's beginning moves over the knots that are kept. A knot less than a 256th of the window
 * behind a kept one is not kept, which bounds their number: there the course counts as straight
 * over that, 0.4 ns of 0.1 us. The window's end moves over every knot. */
enum { VS_SLOPE_PARTS = 256, VS_SLOPE_KNOTS = VS_SLOPE_PARTS + 4 };

/* Start from {0}, with another length of the window if one is wanted. A ring of the knots within
 * the last window, and one before it. */
typedef struct vs_slope {
  double window_s; /* 0: 0.1 us */
  size_t first, count;
  double t_s[VS_SLOPE_KNOTS], y[VS_SLOPE_KNOTS];
} vs_slope;

/* Takes the next step of the course. Returns the largest rate of the windows that end in it, in
 * units of y per second. sense +1: of rising; -1: of falling; 0: of either, without its sign.
 * Returns -INFINITY while the course is not a window long yet, and for a step of no length. */
double vs_slope_rate(vs_slope *slope, double t0_s, double y0, double t1_s, double y1, int sense);

/* ---- the fall of a current to its zero ---- */

/* What a conduction leaves in a device hangs on its current in about so long before the zero, s: a
 * carrier lives for tens of microseconds. No source says the number (assumed). */
extern const double vs_slope_fall_s;

/* Knots of the current that falls, the oldest first. */
enum { VS_FALL_KNOTS = 8 };
typedef struct vs_fall_knot {
  double t_s, i_a;
} vs_fall_knot;
typedef struct vs_fall {
  int count;
  vs_fall_knot at[VS_FALL_KNOTS];
} vs_fall;

/* Keeps the current as it was, a knot for each quarter of vs_slope_fall_s. */
void vs_slope_keep_fall(vs_fall *fall, double t_s, double i_a);
/* The mean rate over vs_slope_fall_s up to the zero; 0: the conduction is shorter. */
double vs_slope_fall(const vs_fall *fall, double zero_s);
