/* SPDX-License-Identifier: GPL-3.0-or-later
 * Numbers of netlists. Of some ngspice reads something else than was meant, and says nothing: it
 * stops at the first letter that it does not know and takes no notice of what follows. */
#pragma once

#include <stdbool.h>

#include "netlist/line.h"
#include "netlist/tally.h"

/* The factor that a number is written with, in capitals or not, and the bytes of its letters: t g
 * meg k mil m u n p f, for u also the micro sign and the Greek mu. 1 and no bytes: there is none.
 */
double vs_numbers_factor(const char *text, size_t *length);

/* Reads a plain number as ngspice does: 1, -2.5e-3, 10us. False: it is anything else. */
bool vs_numbers_read(vs_word word, double *value);

/* Looks through the values of a line. Errors with their place and with what to write: a unit in the
 * place of the point (4k7 is read as 4k), a comma for it (4,7k is read as 4; in a .model, a .param,
 * an .ic and the like, too), two points, a unit that stands apart (10 k), a number that is infinite
 * (1e400). A capital M behind a resistance, or in a .param, is told, as 1M is a milliohm, and a
 * capital F behind a capacitance, as 1F is a femtofarad; so are SFFM and AM, whose arguments differ
 * between versions of ngspice, a value below 0 of an R, C or L, a resistance of 0, and a
 * capacitance above 1 F. */
vs_status vs_numbers_check(const vs_line *line, vs_tally *tally, vs_error *err);
