/* SPDX-License-Identifier: GPL-3.0-or-later
 * The picture of a branch: the least and the largest travel over the key, stable parts as solid
 * lines, unstable ones dashed, and the marks as dots. */
#ifndef VS_ORBIT_DRAWING_H
#define VS_ORBIT_DRAWING_H

#include "walk.h"

/* Writes branch.png into the folder. Errors: those of vs_gnuplot_picture, and of the file. */
vs_status vs_drawing_write(const vs_walk *walk, const char *folder, vs_error *err);

#endif
