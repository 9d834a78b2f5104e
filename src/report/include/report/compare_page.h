/* SPDX-License-Identifier: GPL-3.0-or-later
 * The page that shows two runs, or two studies, side by side: verdicts, keys that differ, curves in
 * one picture, measures or columns. */
#pragma once

#include "base/error.h"

/* Checks the folder for the page. Error, VS_INPUT: it holds a run or a study, whose own page this
 * one would replace. */
vs_status vs_compare_page_check(const char *folder, vs_error *err);

/* Writes report.html into the folder, which is made if it does not exist. json: what `compare
 * --json` prints of the two. Errors: a file of a run is broken; gnuplot is missing or fails; the
 * page cannot be written. */
vs_status vs_compare_page_write(const char *json, const char *folder, vs_error *err);
