/* SPDX-License-Identifier: GPL-3.0-or-later
 * Floquet multipliers: the eigenvalues of a periodic orbit's monodromy matrix. */
#ifndef VS_ORBIT_MULTIPLIERS_H
#define VS_ORBIT_MULTIPLIERS_H

#include "orbit/variation.h"

typedef struct vs_multiplier {
  double re, im;
} vs_multiplier;

/* Finds them, the largest first; a pair by falling imaginary part. `scale` has a size of each
 * state, in parts of which the matrix is taken, so that mixed units do not blur the eigenvalues.
 * Returns false where GSL finds none. */
bool vs_multipliers_find(int count, double monodromy[][VS_VARIATION_MOST], const double *scale,
                         vs_multiplier *out);

#endif
