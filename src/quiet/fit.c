/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "quiet/fit.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>

#include "base/alloc.h"

/* A column that is a combination of others but for this share of it counts as none. */
static const double RANK = 1e-9;

vs_fit vs_fit_new(size_t rows, size_t columns) {
  return (vs_fit){.a = vs_checked(gsl_matrix_alloc(rows, columns)),
                  .tau = vs_checked(gsl_vector_alloc(columns)),
                  .norm = vs_checked(gsl_vector_alloc(columns)),
                  .b = vs_checked(gsl_vector_alloc(rows)),
                  .x = vs_checked(gsl_vector_alloc(columns)),
                  .residual = vs_checked(gsl_vector_alloc(rows)),
                  .p = vs_checked(gsl_permutation_alloc(columns))};
}

void vs_fit_free(vs_fit *f) {
  gsl_matrix_free(f->a);
  gsl_vector_free(f->tau);
  gsl_vector_free(f->norm);
  gsl_vector_free(f->b);
  gsl_vector_free(f->x);
  gsl_vector_free(f->residual);
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
  f->rank = gsl_linalg_QRPT_rank(f->a, RANK * fabs(gsl_matrix_get(f->a, 0, 0)));
  return f->rank > 0;
}

double vs_fit_solve(vs_fit *f, double *x) {
  if (gsl_linalg_QRPT_lssolve2(f->a, f->tau, f->p, f->b, f->rank, f->x, f->residual))
    return INFINITY;
  for (size_t j = 0; j < f->a->size2; j++)
    x[j] = f->scale[j] > 0 ? gsl_vector_get(f->x, j) / f->scale[j] : 0;
  return gsl_blas_dnrm2(f->residual);
}
