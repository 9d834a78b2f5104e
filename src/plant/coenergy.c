/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * At each gap z_k of the grid lambda_k(i) is a cubic spline: odd in i, so that its second
 * derivative is 0 at i = 0, and not-a-knot at the largest current. Its integral is Wc_k(i). Across
 * the gaps not Wc_k is interpolated but
 *
 *   Q_k(i) = i^2 / (2 Wc_k(i)),   Wc(z, i) = i^2 / (2 Q(z, i)),
 *
 * which is 1/L without saturation, nearly straight in z where air gap and iron lie in series. Q is
 * a not-a-knot cubic spline in z. Of a solenoid's table with gaps from 0.25 to 5 mm by 0.25 mm a
 * spline of Wc itself leaves 5 % of the force at the smallest gap, this one 1 %, and 0.2 % from
 * 0.5 mm on. */
#include "coenergy.h"

#include <gsl/gsl_linalg.h>
#include <gsl/gsl_vector.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* ---- building ---- */

typedef enum left_end { ODD, NOT_A_KNOT } left_end;

/* The second derivatives m of the cubic spline through n >= 4 points. For each inner knot
 *
 *   h[k-1] m[k-1] + 2 (h[k-1] + h[k]) m[k] + h[k] m[k+1]
 *                                         = 6 ((y[k+1]-y[k])/h[k] - (y[k]-y[k-1])/h[k-1]).
 *
 * m is 0 at an odd end; at a not-a-knot end the third derivative goes through the knot beside it,
 * which makes m there a straight line through its neighbours'. */
static void second_derivatives(const double *x, const double *y, size_t n, left_end left,
                               double *m) {
  size_t inner = n - 2;
  double *work = vs_alloc(4 * n, sizeof *work);
  double *diagonal = work, *above = work + n, *below = work + 2 * n, *right = work + 3 * n;
  for (size_t k = 1; k <= inner; k++) {
    double h0 = x[k] - x[k - 1], h1 = x[k + 1] - x[k];
    diagonal[k - 1] = 2 * (h0 + h1);
    above[k - 1] = h1; /* the last one is not looked at */
    if (k > 1) below[k - 2] = h0;
    right[k - 1] = 6 * ((y[k + 1] - y[k]) / h1 - (y[k] - y[k - 1]) / h0);
  }
  double first = (x[1] - x[0]) / (x[2] - x[1]),
         last = (x[n - 1] - x[n - 2]) / (x[n - 2] - x[n - 3]);
  if (left == NOT_A_KNOT) { /* m[0] = m[1] + first (m[1] - m[2]) */
    diagonal[0] += (x[1] - x[0]) * (1 + first);
    above[0] -= (x[1] - x[0]) * first;
  }
  diagonal[inner - 1] += (x[n - 1] - x[n - 2]) * (1 + last);
  below[inner - 2] -= (x[n - 1] - x[n - 2]) * last;
  gsl_vector_view d = gsl_vector_view_array(diagonal, inner),
                  a = gsl_vector_view_array(above, inner - 1),
                  b = gsl_vector_view_array(below, inner - 1),
                  r = gsl_vector_view_array(right, inner),
                  solution = gsl_vector_view_array(m + 1, inner);
  gsl_linalg_solve_tridiag(&d.vector, &a.vector, &b.vector, &r.vector, &solution.vector);
  m[0] = left == ODD ? 0 : m[1] + first * (m[1] - m[2]);
  m[n - 1] = m[n - 2] + last * (m[n - 2] - m[n - 3]);
  free(work);
}

/* A spline may swing where the flux linkage bends sharply. Slopes within 0 and three times the
 * lesser secant beside them keep it rising (F. N. Fritsch and R. E. Carlson, SIAM J. Numer. Anal.
 * 17, 1980); a tenth of that secant keeps dlambda/di away from 0 (assumed). */
static double limited_slope(double slope, double before, double behind) {
  double secant = fmin(before, behind);
  return fmax(0.1 * secant, fmin(slope, 3 * secant));
}

/* Fills the pieces of one gap, whose flux linkages are y[n]; work holds 2 n numbers. */
static void fill_row(const double *x, const double *y, size_t n, vs_coenergy_piece *piece,
                     double *work) {
  double *m = work, *slope = work + n;
  second_derivatives(x, y, n, ODD, m);
  for (size_t k = 0; k < n; k++) {
    double h0 = k ? x[k] - x[k - 1] : 0, h1 = k + 1 < n ? x[k + 1] - x[k] : 0;
    double before = k ? (y[k] - y[k - 1]) / h0 : INFINITY,
           behind = k + 1 < n ? (y[k + 1] - y[k]) / h1 : INFINITY;
    slope[k] = k + 1 < n ? behind - h1 * (2 * m[k] + m[k + 1]) / 6
                         : before + h0 * (m[k - 1] + 2 * m[k]) / 6;
    slope[k] = limited_slope(slope[k], before, behind);
  }
  double coenergy = 0;
  for (size_t k = 0; k < n; k++) {
    piece[k] = (vs_coenergy_piece){coenergy, {y[k], slope[k], 0, 0}};
    if (k + 1 == n) break;
    double h = x[k + 1] - x[k], secant = (y[k + 1] - y[k]) / h, *c = piece[k].flux_wb;
    c[2] = (3 * secant - 2 * slope[k] - slope[k + 1]) / h;
    c[3] = (slope[k] + slope[k + 1] - 2 * secant) / (h * h);
    coenergy += h * (c[0] + h * (c[1] / 2 + h * (c[2] / 3 + h * c[3] / 4)));
  }
}

static double *copy_of(const double *from, size_t n) {
  double *to = vs_alloc(n, sizeof *to);
  memcpy(to, from, n * sizeof *to);
  return to;
}

vs_coenergy vs_coenergy_new(const double *z_m, size_t n_z, const double *i_a, size_t n_i,
                            const double *flux_wb) {
  vs_coenergy s = {n_z,
                   n_i,
                   copy_of(z_m, n_z),
                   copy_of(i_a, n_i),
                   vs_alloc(n_z * n_i, sizeof *s.piece),
                   vs_alloc(n_z * n_z, sizeof *s.bend)};
  double *work = vs_alloc(2 * (n_z + n_i), sizeof *work), *unit = work, *column = work + n_z;
  for (size_t j = 0; j < n_z; j++) {
    memset(unit, 0, n_z * sizeof *unit);
    unit[j] = 1;
    second_derivatives(z_m, unit, n_z, NOT_A_KNOT, column);
    for (size_t k = 0; k < n_z; k++) s.bend[k * n_z + j] = column[k];
  }
  for (size_t k = 0; k < n_z; k++) fill_row(i_a, flux_wb + k * n_i, n_i, s.piece + k * n_i, work);
  free(work);
  return s;
}

void vs_coenergy_free(vs_coenergy *s) {
  free(s->z_m);
  free(s->i_a);
  free(s->piece);
  free(s->bend);
  *s = (vs_coenergy){0};
}

/* ---- looking up ---- */

/* The interval of x[n] in which `at` lies: from 0 to `most`. */
static size_t interval(const double *x, size_t most, double at) {
  size_t low = 0, high = most + 1;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (x[middle] <= at)
      low = middle;
    else
      high = middle;
  }
  return low;
}

/* Taylor coefficients in i of Q at one gap, at t behind the beginning of a piece. In the piece that
 * begins at i = 0, i^2 is taken out of both Wc and i^2/2. */
static void coefficients_at(const vs_coenergy_piece *p, bool first, double i, double t,
                            double q[4]) {
  const double *c = p->flux_wb;
  double over[4] = {i * i / 2, i, 0.5, 0}, under[4];
  if (first) {
    over[0] = 0.5;
    over[1] = over[2] = 0;
    under[0] = c[1] / 2 + t * (c[2] / 3 + t * c[3] / 4);
    under[1] = c[2] / 3 + t * c[3] / 2;
    under[2] = c[3] / 4;
    under[3] = 0;
  } else {
    under[0] = p->coenergy_j + t * (c[0] + t * (c[1] / 2 + t * (c[2] / 3 + t * c[3] / 4)));
    under[1] = c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    under[2] = (c[1] + t * (2 * c[2] + t * 3 * c[3])) / 2;
    under[3] = (2 * c[2] + 6 * t * c[3]) / 6;
  }
  for (int n = 0; n < 4; n++) {
    q[n] = over[n];
    for (int j = 1; j <= n; j++) q[n] -= under[j] * q[n - j];
    q[n] /= under[0];
  }
}

/* Taylor coefficients in z of a cubic spline at t behind the knot k, of which the values y and the
 * second derivatives m at k and k + 1 are given, h apart; straight where t is not within. */
static void across(const double y[2], const double m[2], double h, double t, double *c) {
  double third = (m[1] - m[0]) / h, slope = (y[1] - y[0]) / h - h * (2 * m[0] + m[1]) / 6;
  double within = fmax(0, fmin(t, h)), beyond = t - within, w = within;
  c[0] = y[0] + w * (slope + w * (m[0] / 2 + w * third / 6));
  c[1] = slope + w * (m[0] + w * third / 2);
  c[2] = beyond != 0 ? 0 : (m[0] + w * third) / 2;
  c[3] = beyond != 0 ? 0 : third / 6;
  c[0] += beyond * c[1];
}

/* Taylor coefficients of Q behind the gap k, from those in i and the spline's second derivatives
 * there and at the next gap. */
static vs_coenergy_point point_between_gaps(const vs_coenergy *s, size_t k, double y[2][4],
                                            double m[2][4], double z_m) {
  vs_coenergy_point point = {0};
  for (int a = 0; a < 4; a++)
    across((double[]){y[0][a], y[1][a]}, (double[]){m[0][a], m[1][a]}, s->z_m[k + 1] - s->z_m[k],
           z_m - s->z_m[k], point.c[a]);
  double least = 1e-3 * y[0][0]; /* far beyond the grid the straight line falls through 0 */
  if (point.c[0][0] < least) point = (vs_coenergy_point){{{least}}};
  return point;
}

/* Taylor coefficients of Q. */
static vs_coenergy_point reluctance_at(const vs_coenergy *s, double i_a, double z_m) {
  size_t k = interval(s->z_m, s->n_z - 2, z_m), n = interval(s->i_a, s->n_i - 1, i_a);
  const double *bend = s->bend + k * s->n_z;
  double y[2][4] = {{0}}, m[2][4] = {{0}}, q[4];
  for (size_t j = 0; j < s->n_z; j++) {
    coefficients_at(&s->piece[j * s->n_i + n], n == 0, i_a, i_a - s->i_a[n], q);
    if (j == k) memcpy(y[0], q, sizeof q);
    if (j == k + 1) memcpy(y[1], q, sizeof q);
    for (int a = 0; a < 4; a++) {
      m[0][a] += bend[j] * q[a];
      m[1][a] += bend[s->n_z + j] * q[a];
    }
  }
  return point_between_gaps(s, k, y, m, z_m);
}

/* Taylor coefficients of Wc from those of Q. */
static vs_coenergy_point energy_of(const vs_coenergy_point q, double i_a) {
  const double square[4] = {i_a * i_a / 2, i_a, 0.5, 0};
  vs_coenergy_point w = {0}; /* Q Wc = i^2/2, order by order */
  for (int total = 0; total < 4; total++)
    for (int a = 0; a <= total; a++) {
      int b = total - a;
      double sum = b ? 0 : square[a];
      for (int j = 0; j <= a; j++)
        for (int l = 0; l <= b; l++)
          if (j + l) sum -= q.c[j][l] * w.c[a - j][b - l];
      w.c[a][b] = sum / q.c[0][0];
    }
  return w;
}

vs_coenergy_point vs_coenergy_at(const vs_coenergy *s, double i_a, double z_m) {
  return energy_of(reluctance_at(s, i_a, z_m), i_a);
}

/* ---- many gaps at one current ---- */

vs_coenergy_line vs_coenergy_line_new(const vs_coenergy *s, double i_a) {
  vs_coenergy_line line = {s, i_a, vs_alloc(8 * s->n_z, sizeof *line.value), NULL};
  size_t n = interval(s->i_a, s->n_i - 1, i_a);
  line.bend = line.value + 4 * s->n_z;
  for (size_t k = 0; k < s->n_z; k++) {
    double q[4];
    coefficients_at(&s->piece[k * s->n_i + n], n == 0, i_a, i_a - s->i_a[n], q);
    for (size_t a = 0; a < 4; a++) line.value[a * s->n_z + k] = q[a];
  }
  for (size_t a = 0; a < 4; a++)
    second_derivatives(s->z_m, line.value + a * s->n_z, s->n_z, NOT_A_KNOT, line.bend + a * s->n_z);
  return line;
}

void vs_coenergy_line_free(vs_coenergy_line *line) {
  free(line->value);
  *line = (vs_coenergy_line){0};
}

vs_coenergy_point vs_coenergy_line_at(const vs_coenergy_line *line, double z_m) {
  const vs_coenergy *s = line->surface;
  size_t k = interval(s->z_m, s->n_z - 2, z_m);
  double y[2][4], m[2][4];
  for (size_t a = 0; a < 4; a++)
    for (size_t side = 0; side < 2; side++) {
      y[side][a] = line->value[a * s->n_z + k + side];
      m[side][a] = line->bend[a * s->n_z + k + side];
    }
  return energy_of(point_between_gaps(s, k, y, m, z_m), line->i_a);
}

/* ---- the current ---- */

/* The current at one gap of the grid, by straight lines between its points. */
static double row_current(const vs_coenergy *s, size_t k, double flux_wb) {
  const vs_coenergy_piece *row = s->piece + k * s->n_i;
  size_t low = 0, high = s->n_i;
  while (high - low > 1) {
    size_t middle = (low + high) / 2;
    if (row[middle].flux_wb[0] <= flux_wb)
      low = middle;
    else
      high = middle;
  }
  double slope = low + 1 < s->n_i ? (row[low + 1].flux_wb[0] - row[low].flux_wb[0]) /
                                        (s->i_a[low + 1] - s->i_a[low])
                                  : row[low].flux_wb[1];
  return s->i_a[low] + (flux_wb - row[low].flux_wb[0]) / slope;
}

/* Newton's rule inside a bracket. The current at a flux linkage is nearly straight in z, so that
 * the two gaps beside z give a start that needs two or three steps. */
double vs_coenergy_current(const vs_coenergy *s, double flux_wb, double z_m) {
  enum { MOST_STEPS = 100 };
  size_t k = interval(s->z_m, s->n_z - 2, z_m);
  double part = (z_m - s->z_m[k]) / (s->z_m[k + 1] - s->z_m[k]);
  double near = row_current(s, k, flux_wb), far = row_current(s, k + 1, flux_wb);
  double low = 0, high = INFINITY, i = fmax(near + part * (far - near), 0);
  for (int step = 0; step < MOST_STEPS; step++) {
    vs_coenergy_point w = vs_coenergy_at(s, i, z_m);
    double off = w.c[1][0] - flux_wb, next = i - off / (2 * w.c[2][0]);
    if (off > 0)
      high = i;
    else
      low = i;
    if (!(next >= low && next <= high)) next = isinf(high) ? 2 * i + s->i_a[1] : (low + high) / 2;
    if (fabs(next - i) <= 1e-9 * i) return next; /* as the error falls with its square */
    i = next;
  }
  return i;
}

/* The n-th place between the points of a grid, of which each interval has PARTS. */
enum { PARTS = 4 };
static double place_on_grid(const double *x, size_t n) {
  const double *from = x + n / PARTS;
  return from[0] + (double)(n % PARTS) / PARTS * (from[1] - from[0]);
}

bool vs_coenergy_rises(const vs_coenergy *s, double *z_m, double *i_a) {
  const size_t all = PARTS * (s->n_z - 1);
  size_t good = all; /* how many gaps, from the smallest on, have passed at all currents so far */
  for (size_t n = 0; n < PARTS * (s->n_i - 1); n++) {
    vs_coenergy_line line = vs_coenergy_line_new(s, place_on_grid(s->i_a, n));
    for (size_t k = 0; k < good; k++) {
      double z = place_on_grid(s->z_m, k);
      if (vs_coenergy_line_at(&line, z).c[2][0] > 0) continue;
      good = k;
      *z_m = z;
      *i_a = line.i_a;
    }
    vs_coenergy_line_free(&line);
  }
  return good == all;
}
