/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `plot` for a study's folder: report.html, which needs no other file, and each of its
 * pictures as PNG beside it. */
#pragma once

#include "report/plot.h"
#include "study/method.h"

/* Draws the study in the folder; with an output only its first picture, into that file. methods:
 * all methods there are; NULL ends them. The same study gives the same bytes. Errors, after which
 * nothing is written: those of reading the study; an overlay is asked for; gnuplot is missing or
 * fails. */
vs_status vs_report_command(const vs_plot_options *options, const vs_method *const *methods,
                            vs_error *err);
