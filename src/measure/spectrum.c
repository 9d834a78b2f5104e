/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/spectrum.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* ---- groups of lines, by IEC 61000-4-7 ---- */

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

/* A stretch of `cycles` cycles of the mains, from from_s on, of a current that repeats after
 * `period` of them. Groups are told where that is more than one. */
static void begin_grouping(vs_grouping *g, double cycle_s, double from_s, int cycles, int period) {
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

static void end_grouping(vs_grouping *g) {
  free(g->line);
  g->line = NULL;
}

double vs_spectrum_cut(const vs_spectrum *s, double t_s) {
  const vs_grouping *g = &s->grouping;
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

/* Adds a point of the current, A; weight_s is its share of the time. Points come in the order of
 * their cycles. */
static void add_to_grouping(vs_grouping *g, double t_s, double weight_s, double current) {
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

/* Group n, from 1 to VS_GROUPING_LAST, A rms, once the whole stretch was taken in. NaN: the stretch
 * is no whole number of periods. */
static double group_rms(const vs_grouping *g, int n) {
  if (!g->set) return NAN;
  return sqrt((g->squares[n] + square_of_set(g, n)) / (double)g->sets);
}

/* ---- harmonics ---- */

/* Gauss' rule of POINTS points on pieces of at most a PIECES-th of a cycle. Over such a piece the
 * highest harmonic turns by 4 pi, which the rule integrates to rounding, together with a polynomial
 * of degree 14 in time: the current's, as a product of flux linkage and gap. */
enum { POINTS = 24, PIECES = 20 };
/* Over a SHORTER-th of that the harmonic turns by pi/4 to either side of the middle, and these will
 * do. Where a circuit's current runs straight between rows within it, either rule is off: the two
 * differ by 0.03 of run.tolerance at most. */
enum { SHORT_POINTS = 8, SHORTER = 8 };

void vs_spectrum_begin(vs_spectrum *s, double omega_rad_s) {
  *s = (vs_spectrum){.omega_rad_s = omega_rad_s};
  s->rule[0] = vs_checked(gsl_integration_glfixed_table_alloc(POINTS));
  s->rule[1] = vs_checked(gsl_integration_glfixed_table_alloc(SHORT_POINTS));
}

void vs_spectrum_end(vs_spectrum *s) {
  for (int k = 0; k < 2; k++) {
    if (s->rule[k]) gsl_integration_glfixed_table_free(s->rule[k]);
    s->rule[k] = NULL;
  }
  end_grouping(&s->grouping);
}

void vs_spectrum_begin_groups(vs_spectrum *s, double from_s, int cycles, int period) {
  begin_grouping(&s->grouping, 2 * M_PI / s->omega_rad_s, from_s, cycles, period);
}

void vs_spectrum_add(vs_spectrum *s, double t_s, double weight_s, double current) {
  double part = weight_s * current;
  s->squared += part * current;
  for (int n = 0; n < VS_SPECTRUM_LINES; n++) {
    double angle = n * s->omega_rad_s * t_s;
    s->cosine[n] += part * cos(angle);
    s->sine[n] += part * sin(angle);
  }
  add_to_grouping(&s->grouping, t_s, weight_s, current);
}

int vs_spectrum_pieces(const vs_spectrum *s, double length_s,
                       gsl_integration_glfixed_table **rule) {
  const double pieces = length_s * s->omega_rad_s * PIECES / (2 * M_PI);
  *rule = s->rule[pieces * SHORTER <= 1];
  return (int)ceil(pieces);
}

/* Takes a stretch of a step, which lies within one cycle where groups are told. */
static void add_stretch_of_spectrum(vs_spectrum *s, const vs_step *step, double from,
                                    double length) {
  double y[VS_CH_MOST];
  gsl_integration_glfixed_table *rule;
  const int pieces = vs_spectrum_pieces(s, length, &rule);
  for (int p = 0; p < pieces; p++)
    for (size_t k = 0; k < rule->n; k++) {
      double t, weight, lower = from + length * p / pieces,
                        upper = from + length * (p + 1) / pieces;
      gsl_integration_glfixed_point(lower, upper, k, &t, &weight, rule);
      vs_step_groups_at(step, t, 0, y);
      vs_spectrum_add(s, t, weight, y[VS_CH_I_MAINS]);
    }
}

void vs_spectrum_accept(vs_spectrum *s, const vs_step *step) {
  double from = step->from->t_s, length = step->to->t_s - from, cut;
  if (!(length > 0)) return; /* the other side of an instant */
  s->span_s += length;
  if (step->frame->source_is_coil && vs_step_is_quiet(step)) return;
  for (; (cut = vs_spectrum_cut(s, from)) < step->to->t_s; from = cut)
    add_stretch_of_spectrum(s, step, from, cut - from);
  add_stretch_of_spectrum(s, step, from, step->to->t_s - from);
}

double vs_spectrum_harmonic(const vs_spectrum *s, int n) {
  double size = hypot(s->cosine[n], s->sine[n]) / s->span_s;
  return n ? M_SQRT2 * size : size; /* amplitude 2 size; rms: over the root of 2 */
}

double vs_spectrum_judged(const vs_spectrum *s, int n) {
  return s->grouping.told ? group_rms(&s->grouping, n) : vs_spectrum_harmonic(s, n);
}

double vs_spectrum_mean(const vs_spectrum *s) {
  return s->cosine[0] / s->span_s;
}

double vs_spectrum_rms(const vs_spectrum *s) {
  return sqrt(s->squared / s->span_s);
}

/* Table 1 of the standard. From harmonic 15 on odd ones, from 8 on even ones are held to the 15th's
 * and the eighth's limit in inverse proportion to n. */
double vs_spectrum_limit(int n) {
  static const double FIRST[] = {NAN,  NAN,  1.08, 2.30, 0.43, 1.14, 0.30,
                                 0.77, 0.23, 0.40, NAN,  0.33, NAN,  0.21};
  if (n < (int)(sizeof FIRST / sizeof *FIRST) && (n % 2 || n < 8)) return FIRST[n];
  return n % 2 ? 0.15 * 15 / n : 0.23 * 8 / n;
}

int vs_spectrum_windows(const vs_spectrum *s) {
  return (int)s->grouping.sets * s->grouping.windows;
}
