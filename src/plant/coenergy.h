/* SPDX-License-Identifier: GPL-3.0-or-later
 * A coil's co-energy Wc(z, i) = int lambda di over gap and current, from flux linkages on a grid of
 * both. One smooth function gives all: lambda = dWc/di, and the force that closes the gap is
 * -dWc/dz. Units: Wb, A, m, J. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Flux linkage over current at one gap, behind one of the currents of the grid. */
typedef struct vs_coenergy_piece {
  double coenergy_j; /* where the piece begins */
  double flux_wb[4]; /* lambda = sum of flux_wb[n] t^n, t the current behind its beginning */
} vs_coenergy_piece;

/* Constant once built; vs_coenergy_free it. Beyond the largest current lambda is extrapolated as a
 * straight line, and beyond the gaps of the grid i^2/(2 Wc) is, so that a trial step beyond the
 * table finds numbers. */
typedef struct vs_coenergy {
  size_t n_z, n_i;          /* how many gaps and currents; at least 4 each */
  double *z_m, *i_a;        /* rising; i_a[0] is 0 */
  vs_coenergy_piece *piece; /* piece[k*n_i + n] begins at z_m[k], i_a[n] */
  double *bend; /* n_z by n_z: the second derivatives in z of a spline through values at the gaps */
} vs_coenergy;

/* Taylor coefficients of Wc at one point: c[a][b] is its a-th derivative in i and b-th in z, over
 * a! b!; a + b <= 3. */
typedef struct vs_coenergy_point {
  double c[4][4];
} vs_coenergy_point;

/* flux_wb[k*n_i + n] is at z_m[k], i_a[n], rises with n and is 0 for n = 0. */
vs_coenergy vs_coenergy_new(const double *z_m, size_t n_z, const double *i_a, size_t n_i,
                            const double *flux_wb);
void vs_coenergy_free(vs_coenergy *surface);

/* The co-energy and its derivatives; i_a >= 0. */
vs_coenergy_point vs_coenergy_at(const vs_coenergy *surface, double i_a, double z_m);

/* The surface at one current, to be evaluated at many gaps: each vs_coenergy_at takes a time that
 * grows with the number of gaps. The two differ by rounding. Ends with vs_coenergy_line_free. */
typedef struct vs_coenergy_line {
  const vs_coenergy *surface; /* borrowed */
  double i_a;
  double *value, *bend; /* at the gaps: a quantity and its second derivatives in z; owned */
} vs_coenergy_line;
vs_coenergy_line vs_coenergy_line_new(const vs_coenergy *surface, double i_a);
void vs_coenergy_line_free(vs_coenergy_line *line);
/* As vs_coenergy_at. */
vs_coenergy_point vs_coenergy_line_at(const vs_coenergy_line *line, double z_m);

/* The current at a flux linkage >= 0. */
double vs_coenergy_current(const vs_coenergy *surface, double flux_wb, double z_m);
/* True if between the gaps of the grid, too, lambda rises with i; otherwise *z_m is the smallest
 * gap at which it does not, and *i_a the smallest current there. */
bool vs_coenergy_rises(const vs_coenergy *surface, double *z_m, double *i_a);
