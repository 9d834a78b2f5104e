/* SPDX-License-Identifier: GPL-3.0-or-later
 * The section of a page that shows the waveforms of one run, or of several in one picture. */
#pragma once

#include "plot/time_window.h"
#include "report/html.h"

/* Reads the runs and chooses the probes to show: the usual ones and, while there is room, others of
 * the run; only those that all runs have. The whole time is shown, or of a run with too many rows
 * for a page only the end. The stretch begins as {0}; vs_waveforms_close is due even after an
 * error. Errors: a file of a run is broken. */
vs_status vs_waveforms_open(vs_time_window *stretch, const char *const *folders, size_t count,
                            vs_error *err);
void vs_waveforms_close(vs_time_window *stretch);

/* Adds the section. Error: gnuplot is missing or fails. */
vs_status vs_waveforms_add(const vs_time_window *stretch, vs_html *html, vs_error *err);
