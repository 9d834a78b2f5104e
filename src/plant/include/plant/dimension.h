/* SPDX-License-Identifier: GPL-3.0-or-later
 * The unit of a formula, by dimensional analysis: "N/m is added to kg" is found before a run.
 *
 * Use: make the dimension of each term and name of the formula from its unit, and ask for that of
 * the whole. Then compare with the unit that is wanted:
 *
 *     vs_dimension of_names[] = {vs_dimension_of("kg"), vs_dimension_of("N/m")};
 *     vs_dimension found;
 *     vs_dimension_fault fault;
 *     if (!vs_dimension_find(&formula, NULL, of_names, &found, &fault))
 *       return vs_fail_at(err, (where, with column + fault.at), "%s", fault.why);
 *     vs_dimension wanted = vs_dimension_of("N/m");
 *     if (!vs_dimension_fits(&found, &wanted)) ...
 *
 * Angles are pure numbers here, so that N.m/rad is N.m and a sine takes radians. 0 has every unit.
 * A number with digits that is no whole number or half (9.81, 1.2566e-6) may carry a unit of its
 * own: what it takes part in is unknown and is not checked further. */
#pragma once

#include "base/formula.h"
#include "base/units.h"

typedef struct vs_dimension {
  bool unknown; /* nothing is known; it fits everything */
  bool any;     /* the number 0, which fits everything */
  double power[VS_UNIT_POWERS];
} vs_dimension;

/* Where the units of a formula do not fit, and a sentence without a final stop. */
typedef struct vs_dimension_fault {
  int at; /* bytes from the text's begin */
  char why[200];
} vs_dimension_fault;

/* The dimension of a unit; unknown for NULL and for what is no unit. */
vs_dimension vs_dimension_of(const char *unit);
/* x^n y^m, as for the unit of a force per coordinate. */
vs_dimension vs_dimension_product(const vs_dimension *x, double n, const vs_dimension *y, double m);
/* True where both may be the same. */
bool vs_dimension_fits(const vs_dimension *found, const vs_dimension *wanted);
/* Writes a unit of that dimension: "N/m", "kg", "a pure number", "kg^0.5.m". */
enum { VS_DIMENSION_TEXT = 80 };
void vs_dimension_text(const vs_dimension *dimension, char text[VS_DIMENSION_TEXT]);

/* Finds the dimension of a formula whose terms and names have the given ones, each array by index;
 * NULL where it has none. Returns false where the units do not fit; fault says so then. */
bool vs_dimension_find(const vs_formula *formula, const vs_dimension *terms,
                       const vs_dimension *names, vs_dimension *found, vs_dimension_fault *fault);
