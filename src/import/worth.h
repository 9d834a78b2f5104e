/* SPDX-License-Identifier: GPL-3.0-or-later
 * What resistors, capacitors and inductors are worth: as parameters of the deck, and as formulas of
 * these in the lines of losses and stores. */
#ifndef VS_IMPORT_WORTH_H
#define VS_IMPORT_WORTH_H

#include "import/elements.h"
#include "declared.h"

/* Gives an R, C or L whose value is a number a parameter of its name, whose name is written into
 * `param`; empty: there is none. Returns what the element is worth in a run, with m= and scale=;
 * NULL where that is not known: beside a .model, with a coefficient of temperature and temp= or
 * dtemp=. free() it. */
char *vs_worth_make(const vs_elements *wiring, const vs_values *values, const vs_element *element,
                    vs_declared *sheet, char param[VS_ELEMENTS_NAME]);

#endif
