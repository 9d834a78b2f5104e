/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `fit`: finds parameters of scenes from measurements, and reports them. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "run/findings.h"

typedef struct vs_fit_command_options {
  const char *name;  /* a path, or the name of a fit that comes with the program */
  char *const *sets; /* KEY=VALUE of each --set */
  size_t n_sets;
  const char *profile; /* as for vs_fit_problem_read */
  const char *folder;  /* for the files; NULL: none are written */
  bool json;           /* prints JSON instead of the table */
  bool quiet;          /* no table, no warnings */
  bool allow_code;     /* the scenes may run code of their own */
  int digits;          /* significant ones in CSV files, 1..17 */
} vs_fit_command_options;

/* Errors: those of vs_fit_problem_read and vs_fit_result_of; the files cannot be written. If the
 * fit fails, nothing is written or printed. VS_RATING: everything is written, and the model does
 * not fit. */
vs_status vs_fit_command_run(const vs_fit_command_options *options, vs_error *err);

/* For the command `check`: reads a fit, up to its first mistake, and adds a line that describes it.
 * Errors: those of vs_fit_problem_read. */
vs_status vs_fit_command_check(const vs_check_options *options, vs_text *good, vs_error *err);
