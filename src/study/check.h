/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `check`: everything that can be known of a scene or a deck before a run. */
#ifndef VS_STUDY_CHECK_H
#define VS_STUDY_CHECK_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

typedef struct vs_check_options {
  const char *name; /* a path, or the name of a scene or else a deck that comes with the program */
  char *const *sets;
  size_t n_sets; /* for scenes only */
  bool json, quiet;
} vs_check_options;

/* Reads the file to its end, then takes the run's first step and no more. Prints all findings to
 * standard error, each with its line of the file; or as a JSON array to standard output. VS_INPUT:
 * there are some, and err says nothing more. Otherwise prints what it is a good one of, and
 * warnings. */
vs_status vs_check_command(const vs_check_options *options, vs_error *err);

#endif
