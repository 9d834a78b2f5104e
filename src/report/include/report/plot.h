/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `plot` of a run's folder: the pictures of report/plot/sheets.h, drawn by gnuplot. */
#pragma once

#include <stdbool.h>

#include "base/error.h"

/* The names, without .png or .svg, of the pictures that are drawn into a run's folder; NULL ends
 * them. A run that replaces an older one removes them. */
extern const char *const vs_plot_pictures[];

typedef struct vs_plot_options {
  const char *folder; /* of the run; its run.csv has the columns that the run recorded */
  const char *output; /* the one picture to draw, ending in .png or .svg; NULL: the set of pictures,
                         in the folder */
  const char *overlay; /* a CSV file of measured curves (report/plot/overlay.h); NULL: none */
  bool quiet;
} vs_plot_options;

/* Checks the names before anything is drawn. Errors: VS_INPUT, a name is too long or has a line
 * break; the output is no picture or cannot be written. */
vs_status vs_plot_check(const vs_plot_options *options, vs_error *err);

/* Draws the pictures. A panel whose column was not recorded is left out; a measured curve without a
 * panel in any picture gets one in the last. Errors: there is no run.csv, or only a partial one; no
 * picture, or not the one that -o names, has a recorded column; the overlay does not fit; gnuplot
 * is missing or fails. */
vs_status vs_plot_command(const vs_plot_options *options, vs_error *err);
