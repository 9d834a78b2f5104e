/* SPDX-License-Identifier: GPL-3.0-or-later
 * The methods that stand under `vary`: a grid, and the rows of a CSV file. */
#ifndef VS_STUDY_GRID_H
#define VS_STUDY_GRID_H

#include "study/method.h"

extern const vs_method vs_grid_method, vs_grid_list;

#endif
