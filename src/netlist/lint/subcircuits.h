/* SPDX-License-Identifier: GPL-3.0-or-later
 * Subcircuits that have themselves within, instances with parameters that their subcircuit has not,
 * and what is defined twice. */
#pragma once

#include "netlist/cards.h"

/* Error: a subcircuit that calls itself, directly or by others, with the line of the call. ngspice
 * says that the innermost it came to is not known. */
vs_status vs_subcircuits_circles(const vs_cards *cards, vs_error *err);

/* Checks the parameters of all instances (lines X...) against their subcircuits. A subcircuit has
 * the parameters of its line .subckt and of each .param in it, and m. Errors: others, each with its
 * place and the nearest name, which ngspice ignores silently. */
vs_status vs_subcircuits_parameters(const vs_cards *cards, vs_error *err);

/* Is given each slip and its place. `apart`: the two stand in different files, outside of all
 * subcircuits, and say different things: what was made with one of them gets the other. */
typedef void vs_subcircuits_tell(void *ctx, vs_where where, bool apart, const char *text);

/* Looks for models and subcircuits that are defined twice in the same scope, of which ngspice
 * silently takes the first, and for lines .ends with another name than their .subckt has. Two that
 * say the same are no slip, nor are those between .if and .endif, of which ngspice takes one. */
void vs_subcircuits_doubles(const vs_cards *cards, vs_subcircuits_tell *tell, void *ctx);
