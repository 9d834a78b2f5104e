/* SPDX-License-Identifier: GPL-3.0-or-later
 * Linear least squares with one matrix and any number of right sides, by GSL's QR decomposition
 * with pivoting. A column that is nearly a combination of others does no harm: it gets no weight.
 */
#pragma once

#include <gsl/gsl_matrix.h>
#include <gsl/gsl_permutation.h>
#include <stdbool.h>

enum { VS_FIT_COLUMNS = 12 }; /* at most */

/* The caller fills `a` (rows by columns, more rows than columns), calls vs_fit_decompose, and then,
 * for each right side, fills `b` (rows) and calls vs_fit_solve. */
typedef struct vs_fit {
  gsl_matrix *a;                  /* once decomposed: R and Q, as GSL keeps them */
  gsl_matrix *columns;            /* that transposed, so that a column is in one piece */
  gsl_vector *tau, *norm, *b, *x; /* GSL's own but for b */
  gsl_vector *turned;             /* Q^T b of the last right side */
  gsl_permutation *p;             /* column p[j] of `a` stands j-th in R */
  double scale[VS_FIT_COLUMNS];   /* size of each column, by which it was divided */
  size_t rank;                    /* columns that count */
} vs_fit;

/* The caller owns it and frees it. */
vs_fit vs_fit_new(size_t rows, size_t columns);
void vs_fit_free(vs_fit *fit);

/* Scales the columns to one another and decomposes `a`. Returns false where GSL cannot, or where no
 * column counts; then vs_fit_solve is not to be called. */
bool vs_fit_decompose(vs_fit *fit);

/* Gives the solution x, one number a column, and returns the root of the sum of squares of what is
 * left over. */
double vs_fit_solve(vs_fit *fit, double *x);
