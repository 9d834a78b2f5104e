/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a data sheet says of a triac, tried in both directions. */
#ifndef VS_BENCH_TRIAC_H
#define VS_BENCH_TRIAC_H

#include "figures.h"

/* As a thyristor either way, the gate in four quadrants, and the rise behind a commutation. */
extern const vs_figures_kind vs_triac_kind;

#endif
