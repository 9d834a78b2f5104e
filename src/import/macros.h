/* SPDX-License-Identifier: GPL-3.0-or-later
 * Functions that a netlist defines by lines .func, outside of subcircuits. */
#ifndef VS_IMPORT_MACROS_H
#define VS_IMPORT_MACROS_H

#include "import/listing.h"

/* Returns a copy of an expression in which each call of such a function has given place to what the
 * function says, with the call's arguments in the place of its parameters. free() it. A call that
 * does not fit its function stays as it is. */
char *vs_macros_expand(const vs_listing *listing, const char *expression);

#endif
