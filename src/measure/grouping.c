/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/grouping.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* The windows of the standard, in cycles. Of mains of other frequencies it says nothing; they have
 * that of the nearer one. */
enum { AT_50_HZ = 10, AT_60_HZ = 12 };
static const double BETWEEN_HZ = 55;

static int common_divisor(int a, int b) {
  return b ? common_divisor(b, a % b) : a;
}

/* Lines from 0 to the upper end of the last group. */
static int count_of_lines(const vs_grouping *g) {
  return VS_GROUPING_LAST * g->each + g->each / 2 + 1;
}

void vs_grouping_begin(vs_grouping *g, double cycle_s, double from_s, int cycles, int period) {
  *g = (vs_grouping){.told = period > 1, .cycle_s = cycle_s, .from_s = from_s};
  g->each = 1 / cycle_s < BETWEEN_HZ ? AT_50_HZ : AT_60_HZ;
  if (!g->told || cycles < period || cycles % period) return;
  /* the fewest whole windows that hold whole periods, or the whole stretch if it is shorter */
  const int whole = g->each / common_divisor(g->each, period) * period;
  g->set = cycles < whole ? cycles : whole;
  g->windows = g->set / common_divisor(g->set, g->each);
  g->sets = cycles / g->set;
  g->from_s += cycles % g->set * cycle_s; /* the first ones are left out: the last are settled */
  g->line = vs_alloc((size_t)g->set * (size_t)count_of_lines(g), sizeof *g->line);
}

void vs_grouping_end(vs_grouping *g) {
  free(g->line);
  g->line = NULL;
}

double vs_grouping_cut(const vs_grouping *g, double t_s) {
  const double SAME = 1e-7; /* of a cycle, whose beginning is known to rounding */
  if (!g->set) return INFINITY;
  return g->from_s + (floor((t_s - g->from_s) / g->cycle_s + SAME) + 1) * g->cycle_s;
}

/* The square of group n in the window that begins with that cycle of the set. A cycle's lines are
 * turned by the angle that they have there, 2 pi k c / N in the window's c-th cycle. */
static double square_in_window(const vs_grouping *g, int first, int n) {
  const int half = g->each / 2, count = count_of_lines(g);
  double sum = 0;
  for (int k = n * g->each - half; k <= n * g->each + half; k++) {
    double cosine = 0, sine = 0, part = abs(k - n * g->each) == half ? 0.5 : 1;
    for (int c = 0; c < g->each; c++) {
      const double *line = g->line[(size_t)((first + c) % g->set) * (size_t)count + (size_t)k];
      double angle = 2 * M_PI * (k * c % g->each) / g->each;
      cosine += line[0] * cos(angle) - line[1] * sin(angle);
      sine += line[0] * sin(angle) + line[1] * cos(angle);
    }
    double span_s = g->each * g->cycle_s;
    sum +=
        part * 2 * (cosine * cosine + sine * sine) / (span_s * span_s); /* rms: 2/T over root 2 */
  }
  return sum;
}

/* The mean of the squares over the windows of the set at hand. */
static double square_of_set(const vs_grouping *g, int n) {
  double sum = 0;
  for (int w = 0; w < g->windows; w++) sum += square_in_window(g, w * g->each % g->set, n);
  return sum / g->windows;
}

static void next_set(vs_grouping *g) {
  for (int n = 1; n < VS_GROUPING_COUNT; n++) g->squares[n] += square_of_set(g, n);
  memset(g->line, 0, (size_t)g->set * (size_t)count_of_lines(g) * sizeof *g->line);
  g->number++;
}

void vs_grouping_add(vs_grouping *g, double t_s, double weight_s, double current) {
  if (!g->set || t_s < g->from_s) return;
  const double cycles = (t_s - g->from_s) / g->cycle_s,
               whole = fmin(floor(cycles), (double)g->sets * g->set - 1);
  while (whole >= (double)(g->number + 1) * g->set) next_set(g);
  const int count = count_of_lines(g), cycle = (int)(whole - (double)g->number * g->set);
  const double angle = 2 * M_PI * (cycles - whole) / g->each, turn[] = {cos(angle), sin(angle)};
  double(*line)[2] = g->line + (size_t)cycle * (size_t)count;
  double at[] = {weight_s * current, 0}; /* turned by the angle from line to line */
  for (int k = 0; k < count; k++) {
    line[k][0] += at[0];
    line[k][1] += at[1];
    const double cosine = at[0] * turn[0] - at[1] * turn[1];
    at[1] = at[0] * turn[1] + at[1] * turn[0];
    at[0] = cosine;
  }
}

int vs_grouping_windows(const vs_grouping *g) {
  return (int)g->sets * g->windows;
}

double vs_grouping_at(const vs_grouping *g, int n) {
  if (!g->set) return NAN;
  return sqrt((g->squares[n] + square_of_set(g, n)) / (double)g->sets);
}
