/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `plot`: what the paper shows in Figs. 9-11, from a run's files, drawn by gnuplot. */
#ifndef VS_STUDY_PLOT_H
#define VS_STUDY_PLOT_H

#include <stdbool.h>

#include "base/error.h"

/* folder: holds run.csv of a run that recorded what the pictures need. output: NULL for the set of
 * pictures in the folder, or one file ending in .png or .svg. Errors: no run.csv, only a partial
 * one, a column missing, gnuplot missing or failing. */
vs_status vs_plot_command(const char *folder, const char *output, bool quiet, vs_error *err);

#endif
