/* SPDX-License-Identifier: GPL-3.0-or-later
 * Finds the sources of a netlist that fire thyristors, and the firing that they have in common. */
#ifndef VS_IMPORT_GATES_H
#define VS_IMPORT_GATES_H

#include "import/roles.h"

/* Finds the gates, once the mains are known. `asked` is what --gate says; NULL: nothing. Errors,
 * with their place: those of vs_cast_roles. */
vs_status vs_gates_find(vs_roles_search *search, const char *asked);

/* A scene has one `firing` section, so gates may differ only in when they fire. Error, with its
 * place: they differ in something else. */
vs_status vs_gates_check_alike(const vs_roles_search *search);

/* Sets the scene's firing to that of the earliest gate; the other gates get a shift from it. */
void vs_gates_set_firing(vs_roles *roles);

#endif
