/* SPDX-License-Identifier: GPL-3.0-or-later
 * The values of resistors, capacitors and inductors: as parameters of the deck, and as formulas of
 * these in its lines `loss` and `store`. */
#ifndef VS_IMPORT_WORTH_H
#define VS_IMPORT_WORTH_H

#include "declared.h"
#include "import/elements.h"

/* Declares a parameter for an R, C or L whose value is a number, and writes its name into `param`;
 * empty: there is none. Returns the value that the element has in a run, with m= and scale=, as a
 * formula; NULL where it is not known: beside a .model, or with a temperature coefficient and temp=
 * or dtemp=. free() it. */
char *vs_worth_make(const vs_elements *wiring, const vs_values *values, const vs_element *element,
                    vs_declared *sheet, char param[VS_ELEMENTS_NAME]);

#endif
