/* SPDX-License-Identifier: GPL-3.0-or-later
 * Functions and parameters that need themselves, and what a line comes to once its functions are
 * written out, which ngspice does before it reads it. */
#pragma once

#include "netlist/cards.h"

/* How deep functions may call each other, and parameters need each other. ngspice 39 took 200
 * functions within each other in a tenth of a second, and refused 300 after nine seconds, as their
 * brackets did not find each other. It took 1000 parameters in a quarter of a second, 5000 in ten
 * seconds, and 20,000 not within its 20 s. */
enum { VS_DEFINITIONS_FUNCTIONS = 200, VS_DEFINITIONS_PARAMETERS = 1000 };

/* Characters of a line with its functions written out. A product of a voltage took ngspice 39 one
 * second of 110,000, and nine of 520,000. */
enum { VS_DEFINITIONS_LONGEST = 200000 };

/* Looks at all functions, and at the parameters outside of subcircuits: one of a subcircuit may be
 * given by the instance, and may have the name of an outer one that it is made of. Errors, each
 * with its place: the first definition that needs itself, directly or by others, of which ngspice
 * dies, or says nothing, or that one is not defined; one that others are needed for more deeply
 * than that; a line that comes to more characters. A few functions that call each other several
 * times can come to more than any memory holds. Names that are defined twice in their scope are
 * passed by. */
vs_status vs_definitions_check(const vs_cards *cards, vs_error *err);
