/* SPDX-License-Identifier: GPL-3.0-or-later
 * All reductions: one plug for each vs_reduction that the deck's kinds name. */
#ifndef VS_MEASURE_REDUCTIONS_H
#define VS_MEASURE_REDUCTIONS_H

#include "measure/reducer.h"

/* The plugs, by vs_reduction. */
extern const vs_reducer *const vs_reductions_all[VS_REDUCTIONS];

#endif
