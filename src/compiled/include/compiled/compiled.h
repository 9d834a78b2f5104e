/* SPDX-License-Identifier: GPL-3.0-or-later
 * A circuit solver that takes a netlist's cards as modified nodal equations
 *
 *   M y' = f(t, y)
 *
 * and integrates them by RODASP, a Rosenbrock method of fourth order (rodas.h). It solves what the
 * shipped decks are made of, and refuses a netlist with anything else by the element's name:
 *
 *   R C L K V I E F G H B S W D Q M X, with .param, .func, .model d, npn, pnp, vdmos, sw and csw; V
 *   and I constant, from outside, or by pulse, sin and pwl; E and G with a gain, POLY and VALUE, F
 *   and H with a gain and POLY. */
#pragma once

#include "ngspice/circuit.h"

extern const vs_circuit_kind vs_compiled_kind;
