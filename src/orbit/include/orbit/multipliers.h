/* SPDX-License-Identifier: GPL-3.0-or-later
 * Floquet multipliers: the eigenvalues of a periodic orbit's monodromy matrix. */
#pragma once

#include "orbit/variation.h"

typedef struct vs_multiplier {
  double re, im;
} vs_multiplier;

/* What a period leaves of a push, below this, is 0: the product of two such numbers is no number of
 * the computer's any more, and the iteration for the eigenvalues would not end. */
extern const double vs_multipliers_gone;

/* Finds them, the largest first; a pair by falling imaginary part. `scale` has a size of each
 * state, in parts of which the matrix is taken, so that mixed units do not blur the eigenvalues.
 * Returns false where GSL finds none. */
bool vs_multipliers_find(int count, double monodromy[][VS_VARIATION_MOST], const double *scale,
                         vs_multiplier *out);

/* The same of a matrix of any size, row by row, which is overwritten. */
bool vs_multipliers_of(int count, double *matrix, vs_multiplier *out);

/* Their order, as of a comparison for qsort. */
int vs_multiplier_order(const vs_multiplier *a, const vs_multiplier *b);
