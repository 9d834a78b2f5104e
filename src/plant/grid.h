/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reads a table of an actuator: a CSV file whose first line names its columns in any order, z_m,
 * i_a, lambda_wb and, if wanted, force_n. Other prefixes of the units are taken (z_mm, i_ma). Its
 * gaps and currents form a grid: every gap has the same currents. */
#ifndef VS_PLANT_GRID_H
#define VS_PLANT_GRID_H

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

#include "base/error.h"

/* The table in SI; vs_grid_free it. flux_wb and force_n at z_m[k], i_a[n] are item k*n_i + n. */
typedef struct vs_grid {
  size_t n_z, n_i; /* gaps and currents, at least 4 each */
  double *z_m;     /* > 0, rising; owns the memory of all four */
  double *i_a;     /* from 0 on, rising */
  double *flux_wb; /* rises with i, 0 where i is */
  double *force_n; /* as in the file, of either sign; NULL: it has no such column */
  bool added_zero; /* the file has no rows of i = 0; lambda = 0 is taken there */
} vs_grid;

/* file: its name, for errors, which are all told with their line: an unknown or missing column, no
 * number, a gap or a current below 0, no grid, flux linkages that do not rise with the current. */
vs_status vs_grid_read(const char *file, FILE *stream, vs_grid *grid, vs_error *err);
void vs_grid_free(vs_grid *grid);

#endif
