/* SPDX-License-Identifier: GPL-3.0-or-later
 * The methods there are; each file methods_*.c publishes its own. */
#ifndef VS_BATCH_METHODS_H
#define VS_BATCH_METHODS_H

#include "batch/plan.h"

extern const vs_method vs_method_list, vs_method_grid, vs_method_sobol, vs_method_latin,
    vs_method_monte_carlo, vs_method_corners, vs_method_worst, vs_method_snubber;

#endif
