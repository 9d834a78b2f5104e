/* SPDX-License-Identifier: GPL-3.0-or-later
 * The profile likelihood of an unknown: chi2 over its value, where all other unknowns are fitted
 * anew for each value. Its 95 % interval is where chi2 rises by no more than 3.841 above the least.
 * Where the model is not linear in the unknown, that interval is truer than the standard error. */
#ifndef VS_FIT_LIKELIHOOD_H
#define VS_FIT_LIKELIHOOD_H

#include "fit/estimate.h"

typedef struct vs_likelihood_point {
  double s, chi2;
} vs_likelihood_point;

enum { VS_LIKELIHOOD_POINTS = 64 };
typedef struct vs_likelihood {
  size_t unknown;
  double least, most; /* ends of the interval, in the unit of the key; NaN: it is open there, as
                         chi2 does not rise so far before the bound, or before the search fails */
  bool lower_minimum; /* a chi2 below that of the estimate was met: it is not the least one */
  vs_likelihood_point point[VS_LIKELIHOOD_POINTS]; /* by rising s */
  size_t count;
} vs_likelihood;

/* Follows the profile of the unknown on both sides of its estimate. */
void vs_likelihood_of(vs_descender *descender, const vs_estimate *estimate, size_t unknown,
                      vs_likelihood *profile);

#endif
