/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `plot`: what the paper shows in Figs. 9-11, from a run's files, drawn by gnuplot. */
#ifndef VS_COMMAND_PLOT_H
#define VS_COMMAND_PLOT_H

#include <stdbool.h>

#include "base/error.h"

typedef struct vs_plot_options {
  const char *folder;  /* holds run.csv of a run that recorded what the pictures need */
  const char *output;  /* NULL: the set of pictures in the folder; else one, in .png or .svg */
  const char *overlay; /* a CSV file of measured curves (command/overlay.h); NULL: none */
  bool quiet;
} vs_plot_options;

/* Names that cannot be: too long, with a line break, an output that is no picture or that cannot be
 * written. */
vs_status vs_plot_check(const vs_plot_options *options, vs_error *err);

/* A measured curve that none of the pictures has a panel for gets one on the last. Errors: no
 * run.csv, only a partial one, a column missing, an overlay that does not fit, gnuplot missing or
 * failing. */
vs_status vs_plot_command(const vs_plot_options *options, vs_error *err);

#endif
