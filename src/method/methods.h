/* SPDX-License-Identifier: GPL-3.0-or-later
 * The methods there are; each file methods_*.c publishes its own. */
#ifndef VS_METHOD_METHODS_H
#define VS_METHOD_METHODS_H

#include "study/plan.h"

extern const vs_method vs_grid_list, vs_grid_method, vs_sample_sobol, vs_sample_latin,
    vs_sample_monte_carlo, vs_worst_corners, vs_worst_method, vs_snubber_method;

#endif
