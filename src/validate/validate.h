/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `validate`: closed forms, reference solutions, and tier against tier, each with its
 * error. */
#ifndef VS_VALIDATE_VALIDATE_H
#define VS_VALIDATE_VALIDATE_H

#include <signal.h>
#include <stdbool.h>

#include "validate/experiment.h"

/* The program's own, each list in a file checks_*.c. */
extern const vs_comparisons vs_single_comparisons, vs_control_comparisons, vs_steady_comparisons,
    vs_snubber_comparisons, vs_surge_comparisons, vs_tiers_comparisons;

typedef struct vs_validate_options {
  const char *word; /* only checks whose names have it, in small or capital letters; NULL: all */
  bool json;        /* on standard output instead of the table */
  bool quiet;       /* no table, no progress */
  bool list;        /* names the checks and does none */
  const volatile sig_atomic_t *stop; /* set by a signal: end */
} vs_validate_options;

/* Does the checks of some lists, one after the other. Errors: VS_RUN, a check is off, or a run that
 * it needs failed; VS_INPUT, no check has that word; VS_SIGNAL. */
vs_status vs_validate(const vs_comparisons *const *lists, size_t n_lists,
                      const vs_validate_options *options, vs_error *err);

vs_status vs_validate_command(const vs_validate_options *options, vs_error *err);

#endif
