/* SPDX-License-Identifier: GPL-3.0-or-later
 * A scene as a functional mock-up unit, for masters of co-simulation. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

typedef struct vs_export_fmu_options {
  int fmi;           /* 2 or 3, the standard's version */
  bool with_program; /* the program is packed, with libngspice and what ships */
} vs_export_fmu_options;

/* Writes the scene as a unit to `output`, whose name ends with .fmu. Errors: VS_INPUT, the scene is
 * wrong, runs code of its own, or names files by relative paths; VS_RUN, the unit cannot be
 * written, or what is to be packed is missing. */
vs_status vs_export_fmu_command(const char *name, char *const *sets, size_t n_sets,
                                const char *output, const vs_export_fmu_options *options,
                                vs_error *err);
