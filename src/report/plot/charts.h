/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of picture that show a column case by case, or over one or two axes. */
#ifndef VS_REPORT_CHARTS_H
#define VS_REPORT_CHARTS_H

#include "plot/sketch.h"

/* "curve": the column over the one axis. Where there is a second axis that has few words, a line
 * for each of them. */
extern const vs_chart vs_charts_curve;
/* "cases": the column over the number of the case. */
extern const vs_chart vs_charts_cases;
/* "path": the same with the worst so far, for a search. */
extern const vs_chart vs_charts_path;
/* "cloud": points in colour, for cases that lie anywhere between two axes that are numbers. */
extern const vs_chart vs_charts_cloud;

#endif
