/* SPDX-License-Identifier: GPL-3.0-or-later
 * Circuits (ngspice/circuit.h) on libngspice. libngspice is one global instance in a process, so a
 * process has one such circuit at a time. */
#pragma once

#include "ngspice/circuit.h"

extern const vs_circuit_kind vs_ngspice_kind;

/* The version of the library that the program was built with, as its header says it. */
const char *vs_ngspice_version(void);
/* The version that runs, as the library itself says it once it has begun; before, as above. */
const char *vs_ngspice_running(void);

/* Begins the library, once in a process; whoever loads a circuit does it anyway. Error: VS_RUN, it
 * cannot. */
vs_status vs_ngspice_begin(vs_error *err);

/* False once ngspice has ended itself in this process, as some nonsense makes it do: nothing can be
 * loaded any more. */
bool vs_ngspice_usable(void);
