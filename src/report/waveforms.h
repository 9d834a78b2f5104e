/* SPDX-License-Identifier: GPL-3.0-or-later
 * The section of a page that shows the waveforms of a run, or of several over one another. */
#ifndef VS_REPORT_WAVEFORMS_H
#define VS_REPORT_WAVEFORMS_H

#include "plot/time_window.h"
#include "report/html.h"

/* Reads the runs and chooses what is shown: the usual probes and, as far as there is room, what the
 * deck has besides; of these what all runs have. It is the whole time, or where a run has too many
 * rows for a page the time of the last ones. The stretch begins as {0}; vs_waveforms_close even
 * after an error. Errors: a file of a run is broken. */
vs_status vs_waveforms_open(vs_time_window *stretch, const char *const *folders, size_t count,
                            vs_error *err);
void vs_waveforms_close(vs_time_window *stretch);

/* Adds the section. Error: gnuplot is missing or fails. */
vs_status vs_waveforms_add(const vs_time_window *stretch, vs_html *html, vs_error *err);

#endif
