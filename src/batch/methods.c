/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "batch/methods.h"

const vs_method *const vs_methods[] = {&vs_method_list,  &vs_method_grid,        &vs_method_sobol,
                                       &vs_method_latin, &vs_method_monte_carlo, &vs_method_corners,
                                       &vs_method_worst, &vs_method_snubber,     NULL};
