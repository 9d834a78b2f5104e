/* SPDX-License-Identifier: GPL-3.0-or-later
 * Models and subcircuits that are defined twice, of which ngspice silently takes the first, and
 * lines .ends with another name than their .subckt has. */
#ifndef VS_NETLIST_DOUBLES_H
#define VS_NETLIST_DOUBLES_H

#include <stdbool.h>

#include "netlist/line.h"

/* Is given each slip and its place. `apart`: the two stand in different files, outside of all
 * subcircuits, and say different things: what was made with one of them gets the other. */
typedef void vs_doubles_tell(void *ctx, vs_where where, bool apart, const char *text);

/* Looks at all lines of a netlist. Definitions are compared with those in the same subcircuit, or
 * outside of all. Two that say the same are no slip, nor are those between .if and .endif, of which
 * ngspice takes one. */
void vs_doubles_look(const vs_line *lines, size_t count, vs_doubles_tell *tell, void *ctx);

#endif
