/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `validate`: makes the program's comparisons with closed forms and reference
 * solutions, and of tier with tier, and tells the error of each. In what it prints a comparison is
 * called a check. */
#pragma once

#include <signal.h>
#include <stdbool.h>

#include "validate/experiment.h"

typedef struct vs_validate_options {
  const char *word; /* only comparisons with this in their names, in either case; NULL: all */
  bool json;        /* JSON on standard output instead of the table */
  bool quiet;       /* no table, no progress; a comparison that is off is told on standard error */
  bool list;        /* prints the names and makes no comparison */
  const volatile sig_atomic_t *stop; /* set by a signal: the command ends */
} vs_validate_options;

/* Makes the comparisons of some lists, one after the other. Errors: VS_RUN, a comparison is off, or
 * a run that it needs failed; VS_INPUT, no comparison's name has that word; VS_SIGNAL, `stop` was
 * set. For tests; the command calls it with the program's own lists. */
vs_status vs_validate(const vs_comparisons *const *lists, size_t n_lists,
                      const vs_validate_options *options, vs_error *err);
