/* SPDX-License-Identifier: GPL-3.0-or-later
 * Resistors and capacitors, tried. */
#ifndef VS_ACCEPTANCE_PASSIVE_H
#define VS_ACCEPTANCE_PASSIVE_H

#include "acceptance/figures.h"

/* Resistance at 1 V; capacitance, and the resistance in series with it. */
extern const vs_figures_kind vs_passive_resistor, vs_passive_capacitor;

#endif
