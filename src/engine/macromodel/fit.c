/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macromodel/fit.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_permute_vector.h>
#include <math.h>

#include "base/alloc.h"

/* A column that is a combination of others but for this share of it counts as none. */
static const double RANK = 1e-9;

vs_fit vs_fit_new(size_t rows, size_t columns) {
  return (vs_fit){.a = vs_checked(gsl_matrix_alloc(rows, columns)),
                  .columns = vs_checked(gsl_matrix_alloc(columns, rows)),
                  .tau = vs_checked(gsl_vector_alloc(columns)),
                  .norm = vs_checked(gsl_vector_alloc(columns)),
                  .b = vs_checked(gsl_vector_alloc(rows)),
                  .x = vs_checked(gsl_vector_alloc(columns)),
                  .turned = vs_checked(gsl_vector_alloc(rows)),
                  .p = vs_checked(gsl_permutation_alloc(columns))};
}

void vs_fit_free(vs_fit *f) {
  gsl_matrix_free(f->a);
  gsl_matrix_free(f->columns);
  gsl_vector_free(f->tau);
  gsl_vector_free(f->norm);
  gsl_vector_free(f->b);
  gsl_vector_free(f->x);
  gsl_vector_free(f->turned);
  gsl_permutation_free(f->p);
}

bool vs_fit_decompose(vs_fit *f) {
  int sign;
  for (size_t j = 0; j < f->a->size2; j++) {
    gsl_vector_view column = gsl_matrix_column(f->a, j);
    f->scale[j] = fmax(gsl_vector_max(&column.vector), -gsl_vector_min(&column.vector));
    if (f->scale[j] > 0) gsl_vector_scale(&column.vector, 1 / f->scale[j]);
  }
  if (gsl_linalg_QRPT_decomp(f->a, f->tau, f->p, &sign, f->norm)) return false;
  gsl_matrix_transpose_memcpy(f->columns, f->a);
  f->rank = gsl_linalg_QRPT_rank(f->a, RANK * fabs(gsl_matrix_get(f->a, 0, 0)));
  return f->rank > 0;
}

/* w := (1 - tau v v^T) w with v[0] = 1, in the order in which GSL does it. */
static void reflect(const double *v, double tau, double *w, size_t size) {
  double along = 0;
  for (size_t k = 1; k < size; k++) along += v[k] * w[k];
  along += w[0];
  w[0] -= tau * along;
  for (size_t k = 1; k < size; k++) w[k] += -tau * along * v[k];
}

/* f->turned := Q^T b. Q is a product of reflections, whose vectors stand below R's diagonal. */
static void rotate_rows(vs_fit *f) {
  gsl_vector_memcpy(f->turned, f->b);
  for (size_t j = 0; j < f->a->size2; j++)
    reflect(gsl_matrix_ptr(f->columns, j, j), gsl_vector_get(f->tau, j),
            gsl_vector_ptr(f->turned, j), f->a->size1 - j);
}

/* With A P = Q R, R's first `rank` rows determine as many numbers of x; the other columns get no
 * weight. Q keeps lengths, so what is left over of b is as long as the other rows of Q^T b, and
 * need not be turned back by Q. */
double vs_fit_solve(vs_fit *f, double *x) {
  rotate_rows(f);
  gsl_vector_set_zero(f->x);
  gsl_matrix_const_view r = gsl_matrix_const_submatrix(f->a, 0, 0, f->rank, f->rank);
  gsl_vector_view known = gsl_vector_subvector(f->x, 0, f->rank),
                  from = gsl_vector_subvector(f->turned, 0, f->rank),
                  left = gsl_vector_subvector(f->turned, f->rank, f->turned->size - f->rank);
  gsl_vector_memcpy(&known.vector, &from.vector);
  gsl_blas_dtrsv(CblasUpper, CblasNoTrans, CblasNonUnit, &r.matrix, &known.vector);
  gsl_permute_vector_inverse(f->p, f->x);
  for (size_t j = 0; j < f->a->size2; j++)
    x[j] = f->scale[j] > 0 ? gsl_vector_get(f->x, j) / f->scale[j] : 0;
  return gsl_blas_dnrm2(&left.vector);
}
