/* SPDX-License-Identifier: GPL-3.0-or-later
 * Functions and parameters that need themselves, directly or by others. ngspice dies of such a
 * function, and says of such parameters nothing, or that one is not defined. */
#ifndef VS_NETLIST_CYCLES_H
#define VS_NETLIST_CYCLES_H

#include "lint/definitions.h"

/* Error: the first definition that needs itself, with the place where it names the next one. */
vs_status vs_cycles_check(const vs_definitions *d, vs_error *err);

/* How deep functions may call each other, and parameters need each other. ngspice 39 took 200
 * functions within each other in a tenth of a second, and refused 300 after nine seconds, as their
 * brackets did not find each other. It took 1000 parameters in a quarter of a second, 5000 in ten
 * seconds, and 20,000 not within its 20 s. */
enum { VS_CYCLES_FUNCTIONS = 200, VS_CYCLES_PARAMETERS = 1000 };

/* Error: the first definition that is deeper, with its place. None needs itself. */
vs_status vs_cycles_check_depth(const vs_definitions *d, vs_error *err);

/* Gives the numbers of all definitions, each behind those that it names. None needs itself. */
void vs_cycles_order(const vs_definitions *d, size_t *order);

#endif
