/* SPDX-License-Identifier: GPL-3.0-or-later
 * The spectrum of a recorded curve over whole cycles of the mains. */
#ifndef VS_REPORT_FOURIER_H
#define VS_REPORT_FOURIER_H

#include "base/error.h"
#include "plot/time_window.h"

/* Lines of a spectrum; line k is at k/span_s. */
typedef struct vs_fourier {
  double from_s, span_s; /* over which time it is taken, whole cycles */
  size_t lines;          /* from 0, the direct part, to below half the rows' frequency */
  double *rms;           /* [lines] in the column's unit; owned, to be freed with free() */
} vs_fourier;

/* Takes the spectrum over the last whole cycles between from_s and to_s. The curve is read at as
 * many equal instants as there are rows, so that rows at equal distances are taken as they are;
 * between rows it is a straight line. Errors, VS_INPUT: no whole cycle lies between; the curve is
 * not known all along. For tests. */
vs_status vs_fourier_take(const vs_traces *traces, int column, const double window_s[2],
                          double cycle_s, vs_fourier *spectrum, vs_error *err);

/* Adds the spectra of all probes and runs to a script for gnuplot. */
vs_status vs_fourier_add(const vs_time_window *stretch, vs_script *script, vs_error *err);

/* Adds all lines as CSV: frequency_hz, then the rms of each probe's line as NAME_rms_UNIT in the
 * column's own unit. Of several runs the first column is the run's folder. */
vs_status vs_fourier_csv(const vs_time_window *stretch, vs_text *csv, vs_error *err);

/* Adds in words, a line for each run, over which time its spectrum is taken. */
vs_status vs_fourier_say(const vs_time_window *stretch, vs_text *words, vs_error *err);

#endif
