/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "curve_difference.h"

#include <math.h>

/* One of the two curves, and how far it was read. */
typedef struct side {
  const vs_traces *t;
  int column;
  size_t row; /* the last one whose time is not after the present; 0 at first */
} side;

/* The curve's value at t_s; NaN: outside of the run. From call to call t_s must not decrease. */
static double value_at(side *s, double t_s) {
  while (s->row + 1 < s->t->rows && vs_trace_time(s->t, s->row + 1) <= t_s) s->row++;
  double from = vs_trace_time(s->t, s->row), y = vs_trace_value(s->t, s->row, s->column);
  if (t_s == from) return y;
  if (t_s < from || s->row + 1 >= s->t->rows) return NAN;
  double to = vs_trace_time(s->t, s->row + 1), next = vs_trace_value(s->t, s->row + 1, s->column);
  return y + (next - y) * (t_s - from) / (to - from);
}

/* The sums so far. */
typedef struct sums {
  double before_s, before; /* the last time, and B - A there; NaN: not known */
  double time_s, squared;  /* integrals of 1 and of (B - A)^2 */
} sums;

static void add_difference(vs_curve_difference *d, sums *sum, double t_s, double a, double b) {
  double apart = b - a;
  if (!isnan(apart)) {
    double size = fmax(fabs(a), fabs(b)), h = t_s - sum->before_s;
    if (isnan(d->from)) d->from = t_s;
    d->to_s = t_s;
    d->peak = fmax(d->peak, size);
    if (isnan(d->largest) || fabs(apart) > fabs(d->largest)) d->largest = apart, d->at_s = t_s;
    if (!isnan(sum->before)) { /* the integral of the square of a straight line */
      sum->time_s += h;
      sum->squared += h * (sum->before * sum->before + sum->before * apart + apart * apart) / 3;
    }
  }
  sum->before_s = t_s;
  sum->before = apart;
}

vs_curve_difference vs_curve_difference_of(const vs_traces *one, int a, const vs_traces *other,
                                           int b) {
  vs_curve_difference d = {NAN, NAN, NAN, NAN, NAN, NAN};
  sums sum = {0, NAN, 0, 0};
  side first = {one, a, 0}, second = {other, b, 0};
  for (size_t i = 0, k = 0; i < one->rows || k < other->rows;) {
    double t = i < one->rows ? vs_trace_time(one, i) : INFINITY,
           u = k < other->rows ? vs_trace_time(other, k) : INFINITY, now = fmin(t, u);
    while (i < one->rows && vs_trace_time(one, i) <= now) i++;
    while (k < other->rows && vs_trace_time(other, k) <= now) k++;
    double left = value_at(&first, now), right = value_at(&second, now);
    add_difference(&d, &sum, now, left, right);
  }
  d.rms = sum.time_s > 0 ? sqrt(sum.squared / sum.time_s) : fabs(d.largest);
  return d;
}
