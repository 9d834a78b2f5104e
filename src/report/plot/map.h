/* SPDX-License-Identifier: GPL-3.0-or-later
 * A column over two axes: coloured cells, and the line on which the column is at its limit. */
#pragma once

#include "plot/study_plot.h"

/* A field on the points of a grid. */
typedef struct vs_field_grid {
  size_t nx, ny;
  const double *x, *y; /* [nx], [ny], rising */
  const double *z;     /* [ny][nx]; NaN: not known */
  bool x_log, y_log;   /* distances between values are logarithmic */
} vs_field_grid;

/* Calls each(ctx, from, to) for the pieces of the line on which the field is `level`. Between the
 * grid's points the field is bilinear, so that the line of a plane is exact. Where the field is not
 * known there is no line. For tests. */
void vs_map_contour(const vs_field_grid *grid, double level,
                    void (*each)(void *ctx, const double from[2], const double to[2]), void *ctx);
