/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a MOSFET or an IGBT, tried. */
#ifndef VS_BENCH_TRANSISTOR_H
#define VS_BENCH_TRANSISTOR_H

#include "figures.h"

/* On-state, threshold, transconductance, breakdown, switching of an inductive load, the diode
 * inside. */
extern const vs_figures_kind vs_transistor_mosfet, vs_transistor_igbt;

#endif
