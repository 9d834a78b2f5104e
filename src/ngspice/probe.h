/* SPDX-License-Identifier: GPL-3.0-or-later
 * Does a solver do what the program relies on? A small circuit tells, in some milliseconds: a coil
 * behind a latch of 1 Gohm at a sine, and a capacitor that a resistor charges. Both have closed
 * forms, and what went wrong with one version of ngspice or another shows in them. */
#ifndef VS_NGSPICE_PROBE_H
#define VS_NGSPICE_PROBE_H

#include "ngspice/circuit.h"

enum { VS_PROBE_TEXT = 200 };

/* Lets the solver run the circuit, by the trapezoidal rule. `wrong` becomes the first thing that is
 * wrong with it, a sentence without a full stop; empty: nothing is. A run that fails is wrong, too.
 */
void vs_probe_run(const vs_circuit_kind *solver, char wrong[VS_PROBE_TEXT]);

#endif
