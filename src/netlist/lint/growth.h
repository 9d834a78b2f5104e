/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a line comes to once its functions are written out, which ngspice does before it reads it. A
 * few functions that call each other several times can come to more than any memory holds. */
#ifndef VS_NETLIST_GROWTH_H
#define VS_NETLIST_GROWTH_H

#include "lint/definitions.h"

/* Characters. A product of a voltage took ngspice 39 one second of 110,000, and nine of 520,000. */
enum { VS_GROWTH_MOST = 200000 };

/* Error: the first line that has more characters with its functions written out, with its place.
 * No function needs itself (netlist/lint/cycles.h). */
vs_status vs_growth_check(const vs_definitions *d, const vs_line *lines, size_t count,
                          vs_error *err);

#endif
