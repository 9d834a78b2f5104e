/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `run`: one scene, one sim, its files and its table. */
#ifndef VS_COMMAND_RUN_H
#define VS_COMMAND_RUN_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

typedef struct vs_run_options {
  const char *scene, *tier, *folder; /* tier, folder: NULL when not given */
  char *const *sets;
  size_t n_sets;
  bool json, quiet, reproducible;
  bool raw;                          /* run.raw too; wants a folder and the circuit tier */
  int digits;                        /* of run.csv */
  const volatile sig_atomic_t *stop; /* set by a signal: end, keep what there is */
} vs_run_options;

/* VS_RUN and VS_SIGNAL keep run.partial.csv (and run.partial.raw) in the folder; VS_INPUT writes
 * nothing. */
vs_status vs_run_command(const vs_run_options *options, vs_error *err);

#endif
