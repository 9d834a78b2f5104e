/* SPDX-License-Identifier: GPL-3.0-or-later
 * ngspice's code models: types of devices that it loads from files beside its library, among them
 * the one that it makes a source with POLY of. Results are the same to the bit with and without
 * them, so that they are loaded for the first circuit that may need one (ngspice/library.h). */
#ifndef VS_NGSPICE_CODE_MODELS_H
#define VS_NGSPICE_CODE_MODELS_H

#include <stdbool.h>
#include <stddef.h>

/* True where ngspice may make a code model of a line of the netlist. In another dialect it may do
 * so with almost any line. The first line is the title. */
bool vs_code_models_needed(char *const *netlist, size_t lines, const char *dialect);

#endif
