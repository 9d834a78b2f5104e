/* SPDX-License-Identifier: GPL-3.0-or-later
 * Subcircuits that have themselves within, directly or by others. ngspice says that the innermost
 * it came to is not known. */
#ifndef VS_NETLIST_NESTING_H
#define VS_NETLIST_NESTING_H

#include "netlist/line.h"
#include "netlist/words.h"

/* `called` has for each line the subcircuit of which it is an instance, as it stands in the line or
 * under another name; no bytes: it is none. Error: a subcircuit that calls itself, with the line of
 * the call. Names that several subcircuits have are left out. */
vs_status vs_nesting_check(const vs_line *lines, const vs_word *called, size_t count,
                           vs_error *err);

#endif
