/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/multipliers.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdlib.h>

int vs_multiplier_order(const vs_multiplier *a, const vs_multiplier *b) {
  double of_a = hypot(a->re, a->im), of_b = hypot(b->re, b->im);
  if (fabs(of_a - of_b) > 1e-12 * (of_a + of_b)) return of_a < of_b ? 1 : -1;
  if (a->re != b->re && a->im == 0 && b->im == 0) return a->re < b->re ? 1 : -1;
  return (a->im < b->im) - (a->im > b->im);
}

static int by_falling_size(const void *left, const void *right) {
  return vs_multiplier_order(left, right);
}

const double vs_multipliers_gone = 1e-150;

bool vs_multipliers_of(int count, double *matrix, vs_multiplier *out) {
  size_t n = (size_t)count;
  for (size_t k = 0; k < n * n; k++)
    if (fabs(matrix[k]) < vs_multipliers_gone) matrix[k] = 0;
  gsl_matrix_view m = gsl_matrix_view_array(matrix, n, n);
  gsl_vector_complex *values = vs_checked(gsl_vector_complex_alloc(n));
  gsl_eigen_nonsymm_workspace *work = vs_checked(gsl_eigen_nonsymm_alloc(n));
  gsl_eigen_nonsymm_params(0, 1, work);
  bool good = !gsl_eigen_nonsymm(&m.matrix, values, work);
  for (size_t k = 0; k < n; k++) {
    gsl_complex z = gsl_vector_complex_get(values, k);
    out[k] = (vs_multiplier){GSL_REAL(z), GSL_IMAG(z)};
  }
  gsl_eigen_nonsymm_free(work);
  gsl_vector_complex_free(values);
  qsort(out, n, sizeof *out, by_falling_size);
  return good;
}

bool vs_multipliers_find(int count, double monodromy[][VS_VARIATION_MOST], const double *scale,
                         vs_multiplier *out) {
  double matrix[VS_VARIATION_MOST * VS_VARIATION_MOST];
  for (int i = 0; i < count; i++)
    for (int j = 0; j < count; j++) matrix[i * count + j] = monodromy[i][j] * scale[j] / scale[i];
  return vs_multipliers_of(count, matrix, out);
}
