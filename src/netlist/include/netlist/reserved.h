/* SPDX-License-Identifier: GPL-3.0-or-later
 * Names that ngspice keeps for itself in expressions: its functions, constants and variables. A
 * parameter of such a name is not what ngspice reads there: a B source takes E for 2.718 and not
 * for what '.param E=50' says. So the netlist that ngspice is given has another name in its place,
 * and messages have the user's. */
#pragma once

#include <stdbool.h>

#include "base/text.h"
#include "netlist/cards.h"

/* The n-th of these names, from 0; NULL: there are no more. *pspice: it is one in PSpice's dialect
 * alone. For tests. */
const char *vs_reserved_at(size_t n, bool *pspice);

/* True for one of these names, in capitals or not; those of PSpice's dialect count with pspice. */
bool vs_reserved_is(const char *name, bool pspice);

/* True for a name that this file may give to a parameter, which no user's may have. */
bool vs_reserved_is_ours(const char *name);

/* The number that pi or e is where nobody defines it; NaN: it is another name. */
double vs_reserved_constant(const char *name);

/* Adds the name under which ngspice knows the user's parameter. */
void vs_reserved_write(const char *name, bool pspice, vs_text *out);

/* Parameters that are declared beside the lines, as those of '*$ param' are. */
typedef struct vs_reserved_given {
  const char *const *name;
  size_t count;
} vs_reserved_given;

/* Renames the parameters of such names in all lines: where they are defined, where instances give
 * them a value, and in the expressions in which they are known, which are those of their subcircuit
 * and of what stands within it. Functions of the same name stay, as do nodes and elements. Writes
 * numbers for pi and e where only a B source would know them, and nobody defines them. `cards` are
 * those of the lines. Returns whether a line was changed. */
bool vs_reserved_rename(const vs_cards *cards, vs_line *lines, vs_reserved_given given,
                        bool pspice);

/* Puts the user's names in the place of these in a message. */
void vs_reserved_restore(char *message);
