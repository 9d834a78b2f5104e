/* SPDX-License-Identifier: GPL-3.0-or-later
 * The spectrum of a recorded curve over whole cycles of the mains. */
#pragma once

#include "base/error.h"
#include "plot/time_window.h"

/* The lines of a spectrum; line k is at the frequency k/span_s. */
typedef struct vs_fourier {
  double from_s, span_s; /* the stretch that it is taken over, whole cycles */
  size_t lines;          /* from 0, the mean, to below half the rows' frequency */
  double *rms;           /* [lines] in the column's unit; owned, to be freed with free() */
} vs_fourier;

/* Finds the spectrum over the last whole cycles between from_s and to_s. The curve is read at
 * equidistant instants, at least as many as there are rows; between rows it is a straight line. So
 * equidistant rows are taken as they are where their number has small factors. Errors, VS_INPUT: no
 * whole cycle lies between; the curve is not known throughout. For tests. */
vs_status vs_fourier_take(const vs_traces *traces, int column, const double window_s[2],
                          double cycle_s, vs_fourier *spectrum, vs_error *err);

/* Adds the spectra of all probes and runs to a gnuplot script. */
vs_status vs_fourier_add(const vs_time_window *stretch, vs_script *script, vs_error *err);

/* Adds all lines as CSV: frequency_hz, then for each probe the line's r.m.s. value as
 * NAME_rms_UNIT, in the column's own unit. With several runs the first column is the run's folder.
 */
vs_status vs_fourier_csv(const vs_time_window *stretch, vs_text *csv, vs_error *err);

/* Adds a line of text for each run: the time over which its spectrum is taken. */
vs_status vs_fourier_say(const vs_time_window *stretch, vs_text *words, vs_error *err);
