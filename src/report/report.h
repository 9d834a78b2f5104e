/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `plot` of a study's folder: report.html, which needs nothing but itself, and each of
 * its pictures as PNG beside it. */
#ifndef VS_REPORT_REPORT_H
#define VS_REPORT_REPORT_H

#include "command/plot.h"

/* With an output: only the first picture, into that file. The same study gives the same bytes.
 * Errors: those of reading the study, an overlay asked for, gnuplot missing or failing; then
 * nothing is written. */
vs_status vs_report_command(const vs_plot_options *options, vs_error *err);

#endif
