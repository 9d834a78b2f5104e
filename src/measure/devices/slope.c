/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/slope.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

static const double WINDOW_S = 1e-7;
const double vs_slope_fall_s = 50e-6;

static double window_of(const vs_slope *s) {
  return s->window_s > 0 ? s->window_s : WINDOW_S;
}

static size_t knot_at(const vs_slope *s, size_t n) {
  const size_t at = s->first + n; /* n is at most the number of knots */
  return at < VS_SLOPE_KNOTS ? at : at - VS_SLOPE_KNOTS;
}

static void keep_knot(vs_slope *s, double t_s, double y) {
  if (s->count && t_s - s->t_s[knot_at(s, s->count - 1)] < window_of(s) / VS_SLOPE_PARTS) return;
  size_t end = knot_at(s, s->count++);
  s->t_s[end] = t_s;
  s->y[end] = y;
}

/* The course at a time not before its first kept knot. Behind the last kept knot comes the
 * beginning of the step. */
static double course_at(const vs_slope *s, double t_s, double t0_s, double y0, double rate) {
  if (t_s >= t0_s) return y0 + rate * (t_s - t0_s);
  size_t n = 1;
  while (n < s->count && s->t_s[knot_at(s, n)] < t_s) n++;
  double ta = s->t_s[knot_at(s, n - 1)], ya = s->y[knot_at(s, n - 1)];
  double tb = n < s->count ? s->t_s[knot_at(s, n)] : t0_s,
         yb = n < s->count ? s->y[knot_at(s, n)] : y0;
  return tb > ta ? ya + (yb - ya) * (t_s - ta) / (tb - ta) : yb;
}

static double change_in_sense(double change, int sense) {
  return sense ? sense * change : fabs(change);
}

/* The largest rate where the last knot kept is a window or more before the step, and the step two
 * windows long: the windows that count begin with the step, or end with it. */
static double rate_of_long(vs_slope *s, double t0_s, double y0, double t1_s, double y1, int sense) {
  const double window_s = window_of(s);
  double rate = (y1 - y0) / (t1_s - t0_s), after = y0 + rate * (t0_s + window_s - t0_s);
  double before = y0 + rate * (t1_s - window_s - t0_s);
  double first = change_in_sense((after - y0) / window_s, sense);
  double last = change_in_sense((y1 - before) / window_s, sense), largest = -INFINITY;
  s->first = 0;
  s->t_s[0] = t0_s;
  s->y[0] = y0;
  if (first > largest) largest = first;
  return last > largest ? last : largest;
}

double vs_slope_rate(vs_slope *s, double t0_s, double y0, double t1_s, double y1, int sense) {
  const double window_s = window_of(s);
  if (!(t1_s > t0_s)) return -INFINITY;
  if (s->count == 1 && t0_s - s->t_s[s->first] > 2 * window_s && t1_s - t0_s > 2 * window_s)
    return rate_of_long(s, t0_s, y0, t1_s, y1, sense);
  double rate = (y1 - y0) / (t1_s - t0_s), largest = -INFINITY;
  keep_knot(s, t0_s, y0);
  /* As the window moves, the rate changes along a straight line until one end passes a knot. So its
   * largest value is at such an instant. */
  for (size_t n = 0; n <= s->count; n++) {
    bool last = n == s->count;
    double begin_s = last ? t1_s - window_s : s->t_s[knot_at(s, n)], end_s = begin_s + window_s;
    if (begin_s < s->t_s[s->first] || (!last && (end_s <= t0_s || end_s > t1_s))) continue;
    double begin = last ? course_at(s, begin_s, t0_s, y0, rate) : s->y[knot_at(s, n)];
    double end = last ? y1 : y0 + rate * (end_s - t0_s), change = (end - begin) / window_s;
    double own = change_in_sense(change, sense);
    if (own > largest) largest = own; /* fmax would be called */
  }
  while (s->count > 1 && s->t_s[knot_at(s, 1)] <= t1_s - window_s) {
    s->first = knot_at(s, 1);
    s->count--;
  }
  return largest;
}

void vs_slope_keep_fall(vs_fall *f, double t_s, double i_a) {
  if (f->count && t_s - f->at[f->count - 1].t_s < vs_slope_fall_s / 4) return;
  if (f->count == VS_FALL_KNOTS) memmove(f->at, f->at + 1, (size_t)--f->count * sizeof *f->at);
  f->at[f->count++] = (vs_fall_knot){t_s, i_a};
}

double vs_slope_fall(const vs_fall *f, double zero_s) {
  const double from_s = zero_s - vs_slope_fall_s;
  vs_fall_knot after = {zero_s, 0};
  for (int k = f->count; k-- > 0; after = f->at[k]) {
    const vs_fall_knot *at = &f->at[k];
    if (at->t_s <= from_s)
      return (at->i_a + (after.i_a - at->i_a) * (from_s - at->t_s) / (after.t_s - at->t_s)) /
             vs_slope_fall_s;
  }
  return 0;
}
