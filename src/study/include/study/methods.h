/* SPDX-License-Identifier: GPL-3.0-or-later
 * The table of all methods. A new one is a file with its const struct, and a row in the table. */
#pragma once

#include "study/method.h"

/* NULL ends it. Of several methods that claim a section the first is taken. In this order a study's
 * methods are numbered: the first one's index runs slowest, and one that searches comes behind
 * those whose axes it takes. */
extern const vs_method *const vs_methods_all[];

/* The rows of the table, by the study's key under which they stand. */
extern const vs_method vs_threat_cases_method;       /* threats: what the scene has to withstand */
extern const vs_method vs_grid_method, vs_grid_list; /* vary: a grid; the rows of a CSV file */
extern const vs_method vs_sample_sobol, vs_sample_latin, vs_sample_monte_carlo,
    vs_sample_corners;                       /* sample: points of what is not known exactly */
extern const vs_method vs_worst_method;      /* find: a search for the worst case */
extern const vs_method vs_snubber_method;    /* snubber: a search for the cheapest one that holds */
extern const vs_method vs_design_method;     /* catalogue: a search for the cheapest parts */
extern const vs_method vs_derivative_method; /* sensitivity: derivatives as columns of each case */
