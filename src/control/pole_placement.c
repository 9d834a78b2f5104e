/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * With B = [U0 U1] (R over 0), a vector x can become an eigenvector of A - B K for the pole s where
 * U1^T (A - s I) x = 0: these x are the space S of the pole. Once there is a base X of such
 * vectors, A - B K = X D X^-1, where D has the poles, so that R K = U0^T (A - X D X^-1).
 *
 * X is real: a pair of poles re +- j im has the columns a and b of its eigenvector a + j b, and in
 * D the block [re, im; -im, re].
 *
 * The base is found pole by pole, round after round. Each vector is put where the determinant of X,
 * whose columns have length 1, becomes the largest while all others stay. Of a real pole that is
 * the projection onto S of the direction y that is at right angles to the others; of a pair see
 * turn_pair. */
#include "pole_placement.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>

#include "base/alloc.h"

typedef struct placing {
  size_t n, m;
  const gsl_complex *poles;
  gsl_matrix_complex **space;     /* of each pole with im >= 0: n x m, orthonormal columns */
  gsl_matrix *x, *q, *r, *others; /* X; room */
} placing;

/* ---- spaces ---- */

/* Fills the columns of basis with an orthonormal base of all that is at right angles to the columns
 * of w (n x (n - m)), which is overwritten. */
static void complement(gsl_matrix_complex *w, gsl_matrix_complex *basis) {
  size_t n = w->size1, columns = w->size2;
  gsl_vector_complex *tau = vs_checked(gsl_vector_complex_alloc(columns));
  gsl_linalg_complex_QR_decomp(w, tau);
  gsl_matrix_complex_set_zero(basis);
  for (size_t j = 0; j < basis->size2; j++) {
    gsl_vector_complex_view v = gsl_matrix_complex_column(basis, j);
    gsl_vector_complex_set(&v.vector, n - basis->size2 + j, GSL_COMPLEX_ONE);
    gsl_linalg_complex_QR_Qvec(w, tau, &v.vector);
  }
  gsl_vector_complex_free(tau);
}

/* S is what is at right angles to the columns of (A^T - conj(s) I) U1. u: [U0 U1]. */
static gsl_matrix_complex *space_of(const placing *p, const gsl_matrix *a, const gsl_matrix *u,
                                    gsl_complex s) {
  size_t n = p->n, rest = n - p->m;
  gsl_matrix_complex *w = vs_checked(gsl_matrix_complex_alloc(n, rest)), *basis;
  gsl_matrix *au = vs_checked(gsl_matrix_alloc(n, rest));
  gsl_matrix_const_view u1 = gsl_matrix_const_submatrix(u, 0, p->m, n, rest);
  gsl_blas_dgemm(CblasTrans, CblasNoTrans, 1, a, &u1.matrix, 0, au);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < rest; j++) {
      gsl_complex shift =
          gsl_complex_mul_real(gsl_complex_conjugate(s), gsl_matrix_get(&u1.matrix, i, j));
      gsl_matrix_complex_set(w, i, j,
                             gsl_complex_sub(gsl_complex_rect(gsl_matrix_get(au, i, j), 0), shift));
    }
  basis = vs_checked(gsl_matrix_complex_alloc(n, p->m));
  complement(w, basis);
  gsl_matrix_complex_free(w);
  gsl_matrix_free(au);
  return basis;
}

/* ---- vectors ---- */

static bool is_pole_pair(const placing *p, size_t j) {
  return GSL_IMAG(p->poles[j]) != 0;
}

/* Puts the vector S g into the column j, or into j and the next. It is scaled to a length of 1; of
 * a pair, whose vector may be turned by any angle, so that a and b are at right angles. */
static void put_eigenvector(placing *p, size_t j, const gsl_vector_complex *g) {
  gsl_vector_complex *v = vs_checked(gsl_vector_complex_alloc(p->n));
  gsl_blas_zgemv(CblasNoTrans, GSL_COMPLEX_ONE, p->space[j], g, GSL_COMPLEX_ZERO, v);
  gsl_complex square = GSL_COMPLEX_ZERO; /* v^T v = |a|^2 - |b|^2 + 2 j a.b, made real */
  for (size_t i = 0; i < p->n; i++) {
    gsl_complex one = gsl_vector_complex_get(v, i);
    square = gsl_complex_add(square, gsl_complex_mul(one, one));
  }
  double length = gsl_blas_dznrm2(v);
  gsl_complex turn = gsl_complex_polar(1 / length, -gsl_complex_arg(square) / 2);
  gsl_blas_zscal(turn, v);
  for (size_t i = 0; i < p->n; i++) {
    gsl_complex one = gsl_vector_complex_get(v, i);
    gsl_matrix_set(p->x, i, j, GSL_REAL(one));
    if (is_pole_pair(p, j)) gsl_matrix_set(p->x, i, j + 1, GSL_IMAG(one));
  }
  gsl_vector_complex_free(v);
}

/* Any vectors, but the same in each run. */
static void begin_anywhere(placing *p) {
  gsl_vector_complex *g = vs_checked(gsl_vector_complex_alloc(p->m));
  unsigned long random = 1;
  for (size_t j = 0; j < p->n; j += 1 + is_pole_pair(p, j)) {
    for (size_t i = 0; i < p->m; i++) {
      random = (random * 1103515245UL + 12345UL) & 0x7fffffffUL;
      gsl_vector_complex_set(g, i, gsl_complex_rect((double)random / 0x7fffffff - 0.5, 0));
    }
    put_eigenvector(p, j, g);
  }
  gsl_vector_complex_free(g);
}

/* Fills y with orthonormal columns, `width` of them, at right angles to all columns of X but those
 * from j on. */
static void right_angles(placing *p, size_t j, size_t width, gsl_matrix *y) {
  size_t n = p->n, rest = n - width;
  if (!rest) {
    gsl_matrix_set_identity(y);
    return;
  }
  gsl_matrix_view others = gsl_matrix_submatrix(p->others, 0, 0, n, rest);
  gsl_matrix_view r = gsl_matrix_submatrix(p->r, 0, 0, n, rest);
  gsl_vector *tau = vs_checked(gsl_vector_alloc(rest));
  for (size_t k = 0; k < rest; k++) {
    gsl_vector_view from = gsl_matrix_column(p->x, k < j ? k : k + width),
                    to = gsl_matrix_column(&others.matrix, k);
    gsl_vector_memcpy(&to.vector, &from.vector);
  }
  gsl_linalg_QR_decomp(&others.matrix, tau);
  gsl_linalg_QR_unpack(&others.matrix, tau, p->q, &r.matrix);
  gsl_matrix_view last = gsl_matrix_submatrix(p->q, 0, rest, n, width);
  gsl_matrix_memcpy(y, &last.matrix);
  gsl_vector_free(tau);
}

/* S^H y, a column of products. */
static void project(const gsl_matrix_complex *space, const gsl_matrix *y, size_t column,
                    gsl_vector_complex *g) {
  for (size_t k = 0; k < space->size2; k++) {
    gsl_complex sum = GSL_COMPLEX_ZERO;
    for (size_t i = 0; i < space->size1; i++)
      sum = gsl_complex_add(
          sum, gsl_complex_mul_real(gsl_complex_conjugate(gsl_matrix_complex_get(space, i, k)),
                                    gsl_matrix_get(y, i, column)));
    gsl_vector_complex_set(g, k, sum);
  }
}

/* Puts a real pole's vector anew. Returns its share in the determinant. */
static double turn_single(placing *p, size_t j) {
  gsl_matrix *y = vs_checked(gsl_matrix_alloc(p->n, 1));
  gsl_vector_complex *g = vs_checked(gsl_vector_complex_alloc(p->m));
  right_angles(p, j, 1, y);
  project(p->space[j], y, 0, g);
  double share = gsl_blas_dznrm2(g);
  if (share > 0) put_eigenvector(p, j, g);
  gsl_vector_complex_free(g);
  gsl_matrix_free(y);
  return share;
}

/* Puts a pair's vector a + j b anew. With y1 and y2 at right angles to all other columns the
 * determinant is in proportion to y1.a y2.b - y1.b y2.a. Of the vector S g that is g^H H g with the
 * Hermitian H = (u1 u2^H - u2 u1^H)/(2j), where u = S^H y. It is largest for the eigenvector of the
 * eigenvalue of the largest size. Returns the pair's share in the determinant. */
static double turn_pair(placing *p, size_t j) {
  size_t m = p->m;
  gsl_matrix *y = vs_checked(gsl_matrix_alloc(p->n, 2));
  gsl_matrix_complex *h = vs_checked(gsl_matrix_complex_alloc(m, m)),
                     *vectors = vs_checked(gsl_matrix_complex_alloc(m, m));
  gsl_vector_complex *u1 = vs_checked(gsl_vector_complex_alloc(m)),
                     *u2 = vs_checked(gsl_vector_complex_alloc(m));
  gsl_vector *values = vs_checked(gsl_vector_alloc(m));
  gsl_eigen_hermv_workspace *work = vs_checked(gsl_eigen_hermv_alloc(m));
  right_angles(p, j, 2, y);
  project(p->space[j], y, 0, u1);
  project(p->space[j], y, 1, u2);
  for (size_t i = 0; i < m; i++)
    for (size_t k = 0; k < m; k++) {
      gsl_complex one = gsl_complex_mul(gsl_vector_complex_get(u1, i),
                                        gsl_complex_conjugate(gsl_vector_complex_get(u2, k))),
                  two = gsl_complex_mul(gsl_vector_complex_get(u2, i),
                                        gsl_complex_conjugate(gsl_vector_complex_get(u1, k)));
      gsl_matrix_complex_set(h, i, k, gsl_complex_div_imag(gsl_complex_sub(one, two), 2));
    }
  gsl_eigen_hermv(h, values, vectors, work);
  gsl_eigen_hermv_sort(values, vectors, GSL_EIGEN_SORT_ABS_DESC);
  double share = fabs(gsl_vector_get(values, 0));
  gsl_vector_complex_view g = gsl_matrix_complex_column(vectors, 0);
  if (share > 0) put_eigenvector(p, j, &g.vector);
  gsl_eigen_hermv_free(work);
  gsl_vector_free(values);
  gsl_vector_complex_free(u1);
  gsl_vector_complex_free(u2);
  gsl_matrix_complex_free(h);
  gsl_matrix_complex_free(vectors);
  gsl_matrix_free(y);
  return share;
}

/* Rounds until one more changes the sum of the shares' logarithms by less than a thousandth; with a
 * single column in B there is no choice, and one round sets the lengths. */
static void find_vectors(placing *p) {
  enum { ROUNDS = 50 };
  double before = -INFINITY;
  for (int round = 0; round < ROUNDS; round++) {
    double sum = 0;
    for (size_t j = 0; j < p->n; j += 1 + is_pole_pair(p, j))
      sum += log(is_pole_pair(p, j) ? turn_pair(p, j) : turn_single(p, j));
    if (!(fabs(sum - before) > 1e-3)) return;
    before = sum;
  }
}

/* ---- the gain ---- */

/* Fills k from R K = U0^T (A - X D X^-1). */
static bool find_gain(const placing *p, const gsl_matrix *a, const gsl_matrix *u,
                      const gsl_matrix *r, gsl_matrix *k) {
  size_t n = p->n, m = p->m;
  gsl_matrix *lu = vs_checked(gsl_matrix_alloc(n, n)), *xd = vs_checked(gsl_matrix_calloc(n, n));
  gsl_permutation *order = vs_checked(gsl_permutation_alloc(n));
  int sign;
  bool good = true;
  for (size_t j = 0; j < n; j++) /* X D, column by column */
    for (size_t i = 0; i < n; i++) {
      double re = GSL_REAL(p->poles[j]), im = GSL_IMAG(p->poles[j]);
      double other = im == 0 ? 0 : gsl_matrix_get(p->x, i, im > 0 ? j + 1 : j - 1);
      gsl_matrix_set(xd, i, j, re * gsl_matrix_get(p->x, i, j) - im * other);
    }
  gsl_matrix_transpose_memcpy(lu, p->x); /* X^T Z^T = (X D)^T gives Z = X D X^-1 */
  gsl_linalg_LU_decomp(lu, order, &sign);
  for (size_t i = 0; i < n; i++) good = good && gsl_matrix_get(lu, i, i) != 0;
  for (size_t i = 0; i < n && good; i++) {
    gsl_vector_view row = gsl_matrix_row(xd, i);
    gsl_linalg_LU_svx(lu, order, &row.vector);
  }
  gsl_matrix_scale(xd, -1);
  gsl_matrix_add(xd, a);
  gsl_matrix_const_view u0 = gsl_matrix_const_submatrix(u, 0, 0, n, m),
                        top = gsl_matrix_const_submatrix(r, 0, 0, m, m);
  gsl_blas_dgemm(CblasTrans, CblasNoTrans, 1, &u0.matrix, xd, 0, k);
  gsl_blas_dtrsm(CblasLeft, CblasUpper, CblasNoTrans, CblasNonUnit, 1, &top.matrix, k);
  for (size_t i = 0; i < m * n; i++) good = good && isfinite(gsl_matrix_get(k, i / n, i % n));
  gsl_permutation_free(order);
  gsl_matrix_free(lu);
  gsl_matrix_free(xd);
  return good;
}

bool vs_pole_placement(const gsl_matrix *a, const gsl_matrix *b, const gsl_complex *poles,
                       gsl_matrix *k) {
  size_t n = b->size1, m = b->size2;
  placing p = {n,
               m,
               poles,
               vs_alloc(n, sizeof *p.space),
               vs_checked(gsl_matrix_alloc(n, n)),
               vs_checked(gsl_matrix_alloc(n, n)),
               vs_checked(gsl_matrix_alloc(n, n)),
               vs_checked(gsl_matrix_alloc(n, n))};
  gsl_matrix *u = vs_checked(gsl_matrix_alloc(n, n)), *qr = vs_checked(gsl_matrix_alloc(n, m)),
             *r = vs_checked(gsl_matrix_alloc(n, m));
  gsl_vector *tau = vs_checked(gsl_vector_alloc(m));
  gsl_matrix_memcpy(qr, b);
  gsl_linalg_QR_decomp(qr, tau);
  gsl_linalg_QR_unpack(qr, tau, u, r);
  for (size_t j = 0; j < n; j += 1 + is_pole_pair(&p, j)) p.space[j] = space_of(&p, a, u, poles[j]);
  begin_anywhere(&p);
  find_vectors(&p);
  bool good = find_gain(&p, a, u, r, k);
  for (size_t j = 0; j < n; j++)
    if (p.space[j]) gsl_matrix_complex_free(p.space[j]);
  free(p.space);
  gsl_matrix *room[] = {p.x, p.q, p.r, p.others, u, qr, r};
  for (size_t j = 0; j < sizeof room / sizeof *room; j++) gsl_matrix_free(room[j]);
  gsl_vector_free(tau);
  return good;
}

/* ---- what can be moved ---- */

/* The singular values of m, largest first; m, with at least as many rows as columns, is
 * overwritten. */
static gsl_vector *singular_values(gsl_matrix *m) {
  size_t n = m->size2;
  gsl_matrix *v = vs_checked(gsl_matrix_alloc(n, n));
  gsl_vector *values = vs_checked(gsl_vector_alloc(n)), *work = vs_checked(gsl_vector_alloc(n));
  gsl_linalg_SV_decomp(m, v, values, work);
  gsl_matrix_free(v);
  gsl_vector_free(work);
  return values;
}

/* A complex matrix P + jQ has the singular values of the real [P, -Q; Q, P], each twice. Here it is
 * the transpose of [A - s I, B], as there have to be more rows than columns. */
double vs_pole_placement_reach(const gsl_matrix *a, const gsl_matrix *b, gsl_complex s) {
  size_t n = b->size1, m = b->size2, rows = n + m;
  gsl_matrix *w = vs_checked(gsl_matrix_calloc(2 * rows, 2 * n));
  for (size_t half = 0; half < 2; half++)
    for (size_t j = 0; j < n; j++) {
      for (size_t i = 0; i < n; i++)
        gsl_matrix_set(w, half * rows + i, half * n + j,
                       gsl_matrix_get(a, j, i) - (i == j ? GSL_REAL(s) : 0));
      for (size_t i = 0; i < m; i++)
        gsl_matrix_set(w, half * rows + n + i, half * n + j, gsl_matrix_get(b, j, i));
      gsl_matrix_set(w, half * rows + j, (1 - half) * n + j, half ? -GSL_IMAG(s) : GSL_IMAG(s));
    }
  gsl_vector *values = singular_values(w);
  double least = gsl_vector_get(values, 2 * n - 1);
  gsl_vector_free(values);
  gsl_matrix_free(w);
  return least;
}

double vs_pole_placement_independence(const gsl_matrix *b) {
  gsl_matrix *w = vs_checked(gsl_matrix_alloc(b->size1, b->size2));
  gsl_matrix_memcpy(w, b);
  gsl_vector *values = singular_values(w);
  double most = gsl_vector_get(values, 0), least = gsl_vector_get(values, b->size2 - 1);
  gsl_vector_free(values);
  gsl_matrix_free(w);
  return most > 0 ? least / most : 0;
}
