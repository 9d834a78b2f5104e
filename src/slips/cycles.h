/* SPDX-License-Identifier: GPL-3.0-or-later
 * Functions and parameters that need themselves, directly or by others. ngspice dies of such a
 * function, and says of such parameters nothing, or that one is not defined. */
#ifndef VS_SLIPS_CYCLES_H
#define VS_SLIPS_CYCLES_H

#include "slips/definitions.h"

/* Error: the first definition that needs itself, with the place where it names the next one. */
vs_status vs_cycles_check(const vs_definitions *d, vs_error *err);

/* Gives the numbers of all definitions, each behind those that it names. None needs itself. */
void vs_cycles_order(const vs_definitions *d, size_t *order);

#endif
