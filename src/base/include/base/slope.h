/* SPDX-License-Identifier: GPL-3.0-or-later
 * The derivative of a formula to one of its terms, as a formula. */
#ifndef VS_BASE_SLOPE_H
#define VS_BASE_SLOPE_H

#include "base/formula.h"

/* Makes the derivative, with the names' values as they are bound. Each operation stands where the
 * one that it was made of stands in the text. The caller frees it. Returns false where it grows
 * over VS_FORMULA_DEPTH; the derivative is empty then. */
bool vs_slope_of(const vs_formula *formula, int term, vs_formula *slope);

#endif
