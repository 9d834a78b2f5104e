/* SPDX-License-Identifier: GPL-3.0-or-later
 * The picture of a run's verdict: one bar per line, as long as its margin. */
#pragma once

#include <stdbool.h>

#include "base/gnuplot.h"
#include "base/tree.h"
#include "report/html.h"

/* Writes the gnuplot script, and the picture's width and height in pixels. Violated lines come
 * first, then undecided ones, held ones, and those that the scene waives; within each group the
 * tightest first. At most twelve are drawn, and the rest is counted. False: the verdict has no
 * line, and nothing is written. Exported for tests. */
bool vs_margin_bars_script(const vs_node *summary, bool svg, vs_script *script, int size[2]);

/* Draws verdict.png and verdict.svg into the run's folder. Draws nothing if the folder has no
 * run.csv or no summary.json, or if the verdict has no line. Errors: summary.json is broken;
 * gnuplot is missing or fails; a picture cannot be written. */
vs_status vs_margin_bars_draw(const char *folder, bool quiet, vs_error *err);

/* The stress and the limit of a line of the verdict; of a rating those of the end that its margin
 * belongs to. NaN: not known. */
void vs_margin_bars_stress(const vs_node *line, double *value, double *limit);

/* " (assumed)", " (typical)" or both, of the limit of a line of the verdict, or of a figure that
 * its stress is made of; else nothing. */
const char *vs_margin_bars_unsure(const vs_node *line);

/* True for a rating whose ends are both lines of devices as well, with the same values and limits:
 * v_ak beside v_forward and v_reverse. Pictures and pages show it once. */
bool vs_margin_bars_repeats(const vs_node *verdict, const vs_node *line);

/* Adds the picture to a page; adds nothing if the verdict has no line. Error: gnuplot is missing or
 * fails. */
vs_status vs_margin_bars_add(const vs_node *summary, vs_html *html, vs_error *err);
