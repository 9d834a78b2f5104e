/* SPDX-License-Identifier: GPL-3.0-or-later
 * Resistors and capacitors, tried. */
#ifndef VS_BENCH_PASSIVE_H
#define VS_BENCH_PASSIVE_H

#include "figures.h"

/* Resistance at 1 V; capacitance, and the resistance in series with it, also of a snubber; of an
 * electrolytic capacitor these at 100 Hz, the resistance also at 10 kHz, and the leakage. */
extern const vs_figures_kind vs_passive_resistor, vs_passive_capacitor, vs_passive_snubber,
    vs_passive_electrolytic;

#endif
