/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/multipliers.h"

#include <gsl/gsl_eigen.h>
#include <math.h>
#include <stdlib.h>

static int falling(const void *left, const void *right) {
  const vs_multiplier *a = left, *b = right;
  double of_a = hypot(a->re, a->im), of_b = hypot(b->re, b->im);
  if (fabs(of_a - of_b) > 1e-12 * (of_a + of_b)) return of_a < of_b ? 1 : -1;
  if (a->re != b->re && a->im == 0 && b->im == 0) return a->re < b->re ? 1 : -1;
  return (a->im < b->im) - (a->im > b->im);
}

/* What a period leaves of a push, below this, is 0: the product of two such numbers is no number of
 * the computer's any more, and the iteration for the eigenvalues would not end. */
static const double GONE = 1e-150;

bool vs_multipliers_find(int count, double monodromy[][VS_VARIATION_MOST], const double *scale,
                         vs_multiplier *out) {
  size_t n = (size_t)count;
  double matrix[VS_VARIATION_MOST * VS_VARIATION_MOST];
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      double part = monodromy[i][j] * scale[j] / scale[i];
      matrix[i * n + j] = fabs(part) < GONE ? 0 : part;
    }
  gsl_matrix_view m = gsl_matrix_view_array(matrix, n, n);
  gsl_vector_complex *values = gsl_vector_complex_alloc(n);
  gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc(n);
  gsl_eigen_nonsymm_params(0, 1, work);
  bool good = !gsl_eigen_nonsymm(&m.matrix, values, work);
  for (size_t k = 0; k < n; k++) {
    gsl_complex z = gsl_vector_complex_get(values, k);
    out[k] = (vs_multiplier){GSL_REAL(z), GSL_IMAG(z)};
  }
  gsl_eigen_nonsymm_free(work);
  gsl_vector_complex_free(values);
  qsort(out, n, sizeof *out, falling);
  return good;
}
