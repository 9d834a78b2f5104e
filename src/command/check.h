/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `check`: everything that can be known of a scene or a deck before a run. */
#ifndef VS_COMMAND_CHECK_H
#define VS_COMMAND_CHECK_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/text.h"
#include "sim/sim.h"

typedef struct vs_check_options vs_check_options;
struct vs_check_options {
  const char *name; /* a path, or the name of a scene or else a deck that comes with the program */
  char *const *sets;
  size_t n_sets; /* for scenes only */
  bool json, quiet;
  /* Reads what is neither scene nor deck nor part, and adds what it is a good one of; NULL: it is
   * one of those. */
  vs_status (*other)(const vs_check_options *options, vs_text *good, vs_error *err);
};

/* Reads the file to its end, then takes the run's first step and no more. Prints all findings to
 * standard error, each with its line of the file; or as a JSON array to standard output. VS_INPUT:
 * there are some, and err says nothing more. Otherwise prints what it is a good one of, and
 * warnings. */
vs_status vs_check_command(const vs_check_options *options, vs_error *err);

#endif
