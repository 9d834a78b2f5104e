/* SPDX-License-Identifier: GPL-3.0-or-later
 * Functions that a netlist defines with .func lines outside of subcircuits. */
#ifndef VS_IMPORT_MACROS_H
#define VS_IMPORT_MACROS_H

#include "import/listing.h"

/* Returns a copy of an expression in which each call of such a function is replaced by the
 * function's body, with the call's arguments for its parameters. A call that does not fit its
 * function stays. free() it. */
char *vs_macros_expand(const vs_listing *listing, const char *expression);

#endif
