/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/methods.h"

const vs_method *const vs_methods_all[] = {
    &vs_threat_cases_method, &vs_grid_list,          &vs_grid_method,       &vs_sample_sobol,
    &vs_sample_latin,        &vs_sample_monte_carlo, &vs_sample_corners,    &vs_worst_method,
    &vs_snubber_method,      &vs_design_method,      &vs_derivative_method, NULL};
