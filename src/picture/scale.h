/* SPDX-License-Identifier: GPL-3.0-or-later
 * How numbers of a column are shown: in which unit, on an even or a logarithmic axis, and colours
 * that print and that colour-blind people can tell apart. */
#ifndef VS_PICTURE_SCALE_H
#define VS_PICTURE_SCALE_H

#include <stdbool.h>
#include <stddef.h>

#include "survey/survey.h"

typedef struct vs_scale {
  double factor;   /* what is shown is factor times what study.csv says */
  bool log;        /* the axis */
  char unit[48];   /* "µF"; "" for none */
  char label[320]; /* "circuit.c1 / µF" */
} vs_scale;

vs_scale vs_scale_of(const vs_folder_column *column, vs_extent span);

/* "ohm" -> "Ω", "m/s2" -> "m/s²", "N.s/m" -> "N·s/m" */
void vs_scale_unit(const char *unit, char *pretty, size_t size);

/* Okabe and Ito's, in the order lines take them; yellow, which does not print, left out. */
enum { VS_COLOURS = 7 };
extern const char *const vs_scale_colours[VS_COLOURS];
extern const char vs_scale_colour_good[], vs_scale_colour_bad[]; /* blue, vermilion */
/* gnuplot's palette, in which lightness rises with the value (viridis). */
extern const char vs_scale_palette[];

#endif
