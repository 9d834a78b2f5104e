/* SPDX-License-Identifier: GPL-3.0-or-later
 * The page of one run, report.html: verdict, energy flow, waveforms, measures, parameters. */
#ifndef VS_REPORT_DIGEST_H
#define VS_REPORT_DIGEST_H

#include <stdbool.h>

#include "base/error.h"

/* Writes report.html into the run's folder; it needs no other file. Where the folder has no
 * summary.json nothing is written. Errors: a file of the run is broken; gnuplot is missing or
 * fails; the page cannot be written. */
vs_status vs_digest_write(const char *folder, bool quiet, vs_error *err);

#endif
