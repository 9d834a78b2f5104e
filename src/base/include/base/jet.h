/* SPDX-License-Identifier: GPL-3.0-or-later
 * A formula along a path in time: its value with its first two derivatives, by Taylor arithmetic of
 * order two, operation by operation. No derivative is a difference. */
#ifndef VS_BASE_JET_H
#define VS_BASE_JET_H

#include "base/formula.h"

/* A value and its first two derivatives in time. */
typedef struct vs_jet {
  double d[3];
} vs_jet;

/* The formula's jet where its terms have these; NULL will do where it has none. The value is that
 * of vs_formula_value, to the bit. A partial derivative is d[1] where one term has {value, 1, 0}
 * and the others {value, 0, 0}. Where |x|, min, max and sgn have a kink, one branch is taken. x^y
 * with x = 0 has derivatives 0 for y > 2. */
vs_jet vs_jet_of(const vs_formula *formula, const vs_jet *terms);

#endif
