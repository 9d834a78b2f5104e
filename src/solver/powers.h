/* SPDX-License-Identifier: GPL-3.0-or-later
 * Powers of negative numbers. pow(x, y), x**y and x^y are |x|^y in ngspice up to 46; in 47 they are
 * x to the y where y is whole, and 0 where it is not. */
#ifndef VS_SOLVER_POWERS_H
#define VS_SOLVER_POWERS_H

#include <stdbool.h>

/* True if the line is of a source whose expression has a power that may be another number in
 * ngspice 47 than before: neither its base is abs(...) or max(...), nor is its exponent 2 or 4.
 * What stands in braces is a number already. `pspice`: pwr() and pwrs() are made of pow() there. */
bool vs_powers_differ(const char *line, bool pspice);

#endif
