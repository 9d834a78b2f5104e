/* SPDX-License-Identifier: GPL-3.0-or-later
 * Finds the roles in a netlist: the mains, the gates, the coil. What the user says decides; without
 * it, only an element that is the sole candidate is taken. */
#ifndef VS_IMPORT_CAST_H
#define VS_IMPORT_CAST_H

#include "import/roles.h"

/* Errors, each with its place and the option that would decide: several elements could have the
 * role, or the element that the user named does not exist or is of the wrong kind. */
vs_status vs_cast_roles(const vs_elements *wiring, const vs_values *values,
                        const vs_roles_asked *asked, vs_roles *roles, vs_error *err);

#endif
