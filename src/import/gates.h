/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which sources of a netlist fire thyristors, and the firing that they have in common. */
#ifndef VS_IMPORT_GATES_H
#define VS_IMPORT_GATES_H

#include "import/roles.h"

/* Finds the gates, once the mains are known. `asked` is what --gate says; NULL: nothing. Errors,
 * with their place: those of vs_cast_roles. */
vs_status vs_gates_find(vs_roles_search *search, const char *asked);

/* A scene has one section firing: gates may differ in when they fire, and in nothing else. Error,
 * with its place: they do. */
vs_status vs_gates_check_alike(const vs_roles_search *search);

/* Sets the scene's firing: that of the gate that comes first. The others follow it. */
void vs_gates_set_firing(vs_roles *roles);

#endif
