/* SPDX-License-Identifier: GPL-3.0-or-later
 * Finds the inductor of a netlist that is the coil of the EVA, and the resistor in series that
 * belongs to it. */
#ifndef VS_IMPORT_WINDING_H
#define VS_IMPORT_WINDING_H

#include "import/roles.h"

/* Finds the coil. `asked` is what --coil says, "L1+R4"; NULL: nothing. Errors, with their place:
 * those of vs_cast_roles. */
vs_status vs_winding_find(vs_roles_search *search, const char *asked);

#endif
