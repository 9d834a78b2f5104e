/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `sensitivity`: logarithmic derivatives of a scene's measures with respect to its
 * keys, as a table, as JSON, and as files. */
#pragma once

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

typedef struct vs_sensitivity_options {
  const char *scene, *tier; /* as for vs_scene_read */
  char *const *sets;        /* KEY=VALUE of each --set */
  size_t n_sets;
  const char *of, *to; /* names with commas between them; NULL: not given */
  bool steady;         /* a period of the orbit is looked at, of `period` firing periods */
  int period;
  const char *folder; /* gets sensitivity.csv and summary.json; NULL: none are written */
  bool json, quiet;
  bool allow_code;                   /* the scene may run code of its own */
  const volatile sig_atomic_t *stop; /* set by a signal; NULL: none */
} vs_sensitivity_options;

/* Errors, with nothing written: those of vs_scene_read and vs_sensitivity_find; VS_INPUT, nothing
 * is asked for. For tests. */
vs_status vs_sensitivity_command(const vs_sensitivity_options *options, vs_error *err);
