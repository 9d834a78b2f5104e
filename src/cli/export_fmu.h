/* SPDX-License-Identifier: GPL-3.0-or-later
 * A scene as a functional mock-up unit, for masters of co-simulation. */
#ifndef VS_CLI_EXPORT_FMU_H
#define VS_CLI_EXPORT_FMU_H

#include <stddef.h>

#include "base/error.h"

/* Writes the scene as a unit to `output`, whose name ends with .fmu. fmi: 2 or 3, the standard's
 * version. Errors: VS_INPUT, the scene is wrong, runs code of its own, or names files by relative
 * paths; VS_RUN, the unit cannot be written. */
vs_status vs_export_fmu_command(const char *name, char *const *sets, size_t n_sets,
                                const char *output, int fmi, vs_error *err);

#endif
