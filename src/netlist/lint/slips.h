/* SPDX-License-Identifier: GPL-3.0-or-later
 * Slips: mistakes in lines of a netlist that ngspice accepts silently, and that make another
 * circuit of it. */
#pragma once

#include "netlist/cards.h"

/* Looks at a line that is taken apart alone. Errors with their place, and what would be right: a
 * bracket or brace that is not closed, or is
 * one too many; an R, C or L of nothing but two nodes; times of a PWL of which one lies before the
 * last; what vs_couplings_line finds; a POLY(n) with too few nodes,
 * sources or coefficients; a T without a delay; a U of too many segments. What stands in double
 * quotes is not looked at, nor are the round brackets of a .model, which ngspice takes for blanks.
 */
vs_status vs_slips_line(const vs_cards *one, vs_error *err);

/* How many segments ngspice makes of a line U..., of which each is two devices; 0: it is none. */
double vs_slips_segments(const char *line);

/* Error: outside of subcircuits a node is called time or temper, with its place. ngspice then tells
 * the time in the place of the node's voltage, or runs out of memory. */
vs_status vs_slips_names(const vs_cards *cards, vs_error *err);

/* Errors: in lines X... a parameter that has no value, as "r= c=7", which ngspice reads as
 * something else; a name behind the last value, which ngspice leaves out. */
vs_status vs_slips_instances(const vs_cards *cards, vs_error *err);

/* Errors, each with its place: the gain of an E, F, G or H is a bare name that ngspice takes for 0,
 * as no .param or .subckt defines it, wherever that stands, or as it stands in brackets or in a
 * line with commas. `known` has the names that are defined besides, and gets the others. */
vs_status vs_slips_gains(const vs_cards *cards, vs_names *known, vs_error *err);

/* Errors: a line is an .else, .elseif or .endif, and no .if is open there, for which ngspice gives
 * no reason; or an .if that no .endif closes, behind which ngspice silently leaves all out. */
vs_status vs_slips_conditions(const vs_line *lines, size_t count, vs_error *err);
