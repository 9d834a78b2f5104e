/* SPDX-License-Identifier: GPL-3.0-or-later
 * The kind of picture that shows what a search for something that holds has tried. */
#ifndef VS_REPORT_FEASIBLE_H
#define VS_REPORT_FEASIBLE_H

#include "plot/sketch.h"

/* "feasible": the candidates that the manifest names over the first two axes that have a range,
 * which of them hold and which is the answer. It is the same for every column. Where the manifest
 * names no candidates there is no picture. */
extern const vs_chart vs_feasible_chart;

#endif
