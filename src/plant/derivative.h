/* SPDX-License-Identifier: GPL-3.0-or-later
 * Derivatives of a formula. To one of its terms: as a formula. Along a path in time: as numbers, by
 * Taylor arithmetic of order two, operation by operation. No derivative is a difference. */
#pragma once

#include "base/formula.h"

/* Makes the derivative to the term of that index, with the names' values as they are bound. Each
 * operation stands where the one that it was made of stands in the text. The caller frees it.
 * Returns false where it grows over VS_FORMULA_DEPTH; the derivative is empty then. */
bool vs_derivative_to(const vs_formula *formula, int term, vs_formula *slope);

/* A value and its first two derivatives in time. */
typedef struct vs_jet {
  double d[3];
} vs_jet;

/* The formula's jet where its terms have these; NULL will do where it has none. The value is that
 * of vs_formula_value, to the bit. A partial derivative is d[1] where one term has {value, 1, 0}
 * and the others {value, 0, 0}. Where |x|, min, max and sgn have a kink, one branch is taken. x^y
 * with x = 0 has derivatives 0 for y > 2. */
vs_jet vs_derivative_along(const vs_formula *formula, const vs_jet *terms);
