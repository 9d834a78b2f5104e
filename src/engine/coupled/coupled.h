/* SPDX-License-Identifier: GPL-3.0-or-later
 * The tier "circuit": the netlist in its solver and the machine, stepped together. */
#ifndef VS_ENGINE_COUPLED_H
#define VS_ENGINE_COUPLED_H

#include "engine/sim.h"

extern const vs_tier vs_coupled_tier;

#endif
