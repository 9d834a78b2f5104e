/* SPDX-License-Identifier: GPL-3.0-or-later
 * Finds the roles of a netlist: its mains, its gates, its coil. What a user says counts; else what
 * can be nothing else. */
#ifndef VS_IMPORT_CAST_H
#define VS_IMPORT_CAST_H

#include "import/roles.h"

/* Errors, with their place, each of which names the option that would decide: two or more could be
 * it, what is named is not there, or is of another kind. */
vs_status vs_cast_roles(const vs_elements *wiring, const vs_values *values,
                        const vs_roles_asked *asked, vs_roles *roles, vs_error *err);

#endif
