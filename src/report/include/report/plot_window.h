/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `plot` with options for probes, a stretch of time, several runs, spectra or orbits.
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

typedef struct vs_plot_window_options {
  char *const *folders; /* of runs, [n_folders] */
  size_t n_folders;
  const char *probes;    /* their names, separated by commas; NULL: the usual ones */
  const char *from, *to; /* times with their units; NULL: chosen automatically */
  const char *output; /* the picture, ending in .png or .svg; NULL: one of each in the first folder
                       */
  bool fft, orbit;    /* spectra, or orbits, instead of curves over time */
  bool quiet;
} vs_plot_window_options;

/* Draws the picture; for spectra also writes the numbers as CSV beside it. Errors: those of reading
 * the runs; no such probe; no such stretch of time; both spectra and orbits are asked for; gnuplot
 * is missing or fails. */
vs_status vs_plot_window_command(const vs_plot_window_options *options, vs_error *err);

/* True if an event of the scene begins in this folder's run. */
bool vs_plot_window_wanted(const char *folder);
