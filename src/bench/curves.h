/* SPDX-License-Identifier: GPL-3.0-or-later
 * The picture of a part that was tried. */
#ifndef VS_BENCH_CURVES_H
#define VS_BENCH_CURVES_H

#include "figures.h"

/* Draws all curves side by side into a PNG of `size` bytes, to be freed by the caller. Errors:
 * VS_RUN, gnuplot is not installed or failed. */
vs_status vs_curves_draw(const vs_figures *figures, const char *title, char **picture, size_t *size,
                         vs_error *err);

#endif
