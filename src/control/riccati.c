/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "riccati.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>

#include "base/alloc.h"

/* z = x y, or x^T y, or x y^T. */
static void matrix_product(CBLAS_TRANSPOSE_t tx, CBLAS_TRANSPOSE_t ty, const gsl_matrix *x,
                           const gsl_matrix *y, gsl_matrix *z) {
  gsl_blas_dgemm(tx, ty, 1, x, y, 0, z);
}

static double largest_element(const gsl_matrix *m) {
  double least, most;
  gsl_matrix_minmax(m, &least, &most);
  return fmax(fabs(least), fabs(most));
}

/* Takes away what rounding has made of a symmetric matrix. */
static void make_symmetric(gsl_matrix *m) {
  for (size_t i = 0; i < m->size1; i++)
    for (size_t j = 0; j < i; j++) {
      double mean = (gsl_matrix_get(m, i, j) + gsl_matrix_get(m, j, i)) / 2;
      gsl_matrix_set(m, i, j, mean);
      gsl_matrix_set(m, j, i, mean);
    }
}

/* The matrices of the doubling algorithm, all n x n. */
typedef struct doubling {
  gsl_matrix *f, *g, *h;          /* F, G, H */
  gsl_matrix *w, *wf, *wg, *room; /* W = I + G H; W^-1 F; W^-1 G */
  gsl_permutation *order;
} doubling;

/* x = W^-1 y, where W is decomposed. */
static void divide_doubling(const doubling *d, const gsl_matrix *y, gsl_matrix *x) {
  gsl_matrix_memcpy(x, y);
  for (size_t j = 0; j < x->size2; j++) {
    gsl_vector_view column = gsl_matrix_column(x, j);
    gsl_linalg_LU_svx(d->w, d->order, &column.vector);
  }
}

/* One doubling: H after n of them is the covariance after 2^n periods that began without an error,
 *
 *   H += F^T H W^-1 F,   G += F W^-1 G F^T,   F = F W^-1 F,   W = I + G H
 *
 * Returns by how much H has changed, relative to its own size. */
static double take_twice(doubling *d) {
  int sign;
  double size;
  gsl_matrix_set_identity(d->w);
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, d->g, d->h, 1, d->w);
  gsl_linalg_LU_decomp(d->w, d->order, &sign);
  divide_doubling(d, d->f, d->wf);
  divide_doubling(d, d->g, d->wg);

  matrix_product(CblasNoTrans, CblasNoTrans, d->h, d->wf, d->w);
  matrix_product(CblasTrans, CblasNoTrans, d->f, d->w, d->room);
  make_symmetric(d->room);
  gsl_matrix_add(d->h, d->room);
  size = largest_element(d->h);
  double change = size > 0 ? largest_element(d->room) / size : 0;

  matrix_product(CblasNoTrans, CblasNoTrans, d->f, d->wg, d->w);
  matrix_product(CblasNoTrans, CblasTrans, d->w, d->f, d->room);
  make_symmetric(d->room);
  gsl_matrix_add(d->g, d->room);

  matrix_product(CblasNoTrans, CblasNoTrans, d->f, d->wf, d->room);
  gsl_matrix_memcpy(d->f, d->room);
  return change;
}

static void begin_doubling(doubling *d, size_t n) {
  gsl_matrix **all[] = {&d->f, &d->g, &d->h, &d->w, &d->wf, &d->wg, &d->room};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++)
    *all[k] = vs_checked(gsl_matrix_alloc(n, n));
  d->order = vs_checked(gsl_permutation_alloc(n));
}

static void end_doubling(doubling *d) {
  gsl_matrix *all[] = {d->f, d->g, d->h, d->w, d->wf, d->wg, d->room};
  for (size_t k = 0; k < sizeof all / sizeof *all; k++) gsl_matrix_free(all[k]);
  gsl_permutation_free(d->order);
}

/* g = C^T R^-1 C. */
static void set_information(const gsl_matrix *c, const gsl_matrix *r, gsl_matrix *g) {
  gsl_matrix *rc = vs_checked(gsl_matrix_alloc(c->size1, c->size2)),
             *l = vs_checked(gsl_matrix_alloc(r->size1, r->size2));
  gsl_matrix_memcpy(l, r);
  gsl_matrix_memcpy(rc, c);
  gsl_linalg_cholesky_decomp1(l);
  for (size_t j = 0; j < rc->size2; j++) {
    gsl_vector_view column = gsl_matrix_column(rc, j);
    gsl_linalg_cholesky_svx(l, &column.vector);
  }
  matrix_product(CblasTrans, CblasNoTrans, c, rc, g);
  gsl_matrix_free(rc);
  gsl_matrix_free(l);
}

/* The structure-preserving doubling algorithm (E. K.-W. Chu and others, 2004). It starts with
 * F = A^T, G = C^T R^-1 C and H = Q, and H tends to P. As the number of periods doubles each time,
 * 60 of them are more than any motion can take. */
bool vs_riccati(const gsl_matrix *a, const gsl_matrix *c, const gsl_matrix *q, const gsl_matrix *r,
                gsl_matrix *p) {
  enum { DOUBLINGS = 60 };
  const double settled = 1e-14;
  doubling d;
  double change = INFINITY;
  begin_doubling(&d, a->size1);
  gsl_matrix_transpose_memcpy(d.f, a);
  set_information(c, r, d.g);
  gsl_matrix_memcpy(d.h, q);
  for (int n = 0; n < DOUBLINGS && change > settled; n++) {
    change = take_twice(&d);
    if (!isfinite(change)) break;
  }
  gsl_matrix_memcpy(p, d.h);
  end_doubling(&d);
  return change <= settled;
}

void vs_riccati_gain(const gsl_matrix *p, const gsl_matrix *c, const gsl_matrix *r,
                     gsl_matrix *gain) {
  size_t n = p->size1, m = c->size1;
  gsl_matrix *pc = vs_checked(gsl_matrix_alloc(n, m)), *s = vs_checked(gsl_matrix_alloc(m, m));
  matrix_product(CblasNoTrans, CblasTrans, p, c, pc);
  gsl_matrix_memcpy(s, r);
  gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, c, pc, 1, s);
  make_symmetric(s);
  gsl_linalg_cholesky_decomp1(s);
  for (size_t i = 0; i < n; i++) { /* a row of L solves S row = row of P C^T, as S is symmetric */
    gsl_vector_view from = gsl_matrix_row(pc, i), to = gsl_matrix_row(gain, i);
    gsl_linalg_cholesky_solve(s, &from.vector, &to.vector);
  }
  gsl_matrix_free(pc);
  gsl_matrix_free(s);
}
