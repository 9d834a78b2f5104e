/* SPDX-License-Identifier: GPL-3.0-or-later
 * The page of one run, report.html: verdict, energy flow, waveforms, measures, parameters. */
#pragma once

#include <stdbool.h>

#include "base/error.h"
#include "base/tree.h"
#include "report/html.h"

/* Writes report.html, which needs no other file, into the run's folder; writes nothing if the
 * folder has no summary.json. Errors: a file of the run is broken; gnuplot is missing or fails; the
 * page cannot be written. */
vs_status vs_run_page_write(const char *folder, bool quiet, vs_error *err);

/* The parts of the page that need summary.json alone: everything before the first section, with the
 * title; the verdict and the energy flow; measures and parameters. For tests. */
void vs_run_page_head(vs_html *html, const char *folder, const vs_node *summary, double until_s);
void vs_run_page_verdict(vs_html *html, const vs_node *summary);
void vs_run_page_values(vs_html *html, const vs_node *summary);
