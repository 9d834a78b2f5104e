/* SPDX-License-Identifier: GPL-3.0-or-later
 * A column over two axes: cells in colour, and the line on which the limit is met. */
#ifndef VS_PICTURE_MAP_H
#define VS_PICTURE_MAP_H

#include "picture/sketch.h"

enum { VS_MAP_CELLS = 80 }; /* along each axis at most; more values share a cell */

/* The axes of the map: the two of most values. With further axes, or where values share a cell,
 * a cell shows the least margin, or the largest amount, among its cases. */
vs_status vs_map_draw(const vs_sketch *k, size_t column, vs_picture *p, vs_error *err);

/* Is each axis one of few enough values, so that the cases fill at least half of the map? */
bool vs_map_fits(const vs_sketch *k);

/* Pieces of the line on which a field is `level`, between the values of a grid (bilinear, so exact
 * for a plane). z[ny][nx], NAN: not known, no line passes there. each(ctx, x0, y0, x1, y1). */
typedef struct vs_field_grid {
  size_t nx, ny;
  const double *x, *y; /* rising */
  const double *z;
  bool x_log, y_log; /* between values as on a logarithmic axis */
} vs_field_grid;
void vs_map_contour(const vs_field_grid *grid, double level,
                    void (*each)(void *ctx, const double from[2], const double to[2]), void *ctx);

#endif
