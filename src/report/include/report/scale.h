/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a column's numbers are shown: in which unit, and on a linear or logarithmic axis. Also
 * colours that print well and that colour-blind people can tell apart. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "study/study_results.h"

typedef struct vs_scale {
  double factor;   /* study.csv's number times factor is shown */
  bool log;        /* the axis is logarithmic */
  char unit[48];   /* "µF"; "" for none */
  char label[320]; /* "circuit.c1 / µF" */
} vs_scale;

/* Chooses the prefix of the unit that gives the largest amount (on a logarithmic axis the middle
 * one) up to three digits before the decimal point. A margin is shown in per cent. An axis is
 * logarithmic if the manifest says so of a range, or if a list's values are spaced like that. */
vs_scale vs_scale_of(const vs_folder_column *column, vs_extent span);

/* Writes the unit in its usual typography: "ohm" -> "Ω", "m/s2" -> "m/s²", "N.s/m" -> "N·s/m" */
void vs_scale_unit(const char *unit, char *pretty, size_t size);

/* Okabe and Ito's palette (Color Universal Design, 2008), in the order in which lines get their
 * colours; without yellow, which does not print well. */
enum { VS_COLOURS = 7 };
extern const char *const vs_scale_colours[VS_COLOURS];
extern const char vs_scale_colour_good[], vs_scale_colour_bad[]; /* blue, vermilion */
/* gnuplot's palette, in which lightness rises with the value (viridis). */
extern const char vs_scale_palette[];
