/* SPDX-License-Identifier: GPL-3.0-or-later
 * All reductions: one plug for each vs_reduction that the deck's kinds name. */
#ifndef VS_STRESS_REDUCTIONS_H
#define VS_STRESS_REDUCTIONS_H

#include "stress/reducer.h"

/* The plugs, by vs_reduction. */
extern const vs_reducer *const vs_reductions_all[VS_REDUCTIONS];

#endif
