/* SPDX-License-Identifier: GPL-3.0-or-later
 * Fewer equations for the same circuit: an equation without capacitance, inductance and devices
 * gives one of its unknowns as shares of the others, once and for all. */
#pragma once

#include "equations.h"

/* Takes such unknowns out of the equations. Those that devices or signals ask for, of which -1 and
 * -2 are none, follow from the first `rows` (vs_equations_follow); the others are gone. Unknowns
 * have other numbers then. */
void vs_reduction_make(vs_equations *e, const int *signal, size_t signals);
