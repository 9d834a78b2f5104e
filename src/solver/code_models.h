/* SPDX-License-Identifier: GPL-3.0-or-later
 * ngspice's code models: types of devices that it loads from files beside its library, among them
 * the one that it makes a source with POLY of.
 *
 * ngspice goes through all the types of devices that it has several times in every step, also
 * those that the circuit has none of. Its own spinit loads a hundred of them, which take a
 * fifteenth of a run. So ngspice begins without any (solver/library.h), and they are loaded for
 * the first circuit that may need one. Results are the same to the bit with and without. */
#ifndef VS_SOLVER_CODE_MODELS_H
#define VS_SOLVER_CODE_MODELS_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "solver/library.h"

/* True where ngspice may make a code model of a line of the netlist. In another dialect it may do
 * so with almost any line. The first line is the title. */
bool vs_code_models_needed(char *const *netlist, size_t lines, const char *dialect);

/* Loads all code models. To be called once in a process. Error, VS_RUN: their folder is not beside
 * the library. */
vs_status vs_code_models_load(const vs_library *library, vs_error *err);

#endif
