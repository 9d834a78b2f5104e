/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `modes`: eigenfrequencies, damping, shapes and state space of a scene's machine. */
#ifndef VS_CLI_MODES_H
#define VS_CLI_MODES_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

/* Prints the modes as a table or as JSON. With a folder it also writes there modes.csv and the
 * state space of Eqs. 84-87 as A.csv, B.csv, C.csv, D.csv: plain matrices of 17 digits without a
 * header. scene, sets: as for vs_scene_read. folder: NULL, nothing is written. quiet: no table is
 * printed, and JSON all the same. Errors: everything a scene can be wrong in; VS_RUN, no
 * eigenvalues are found; a file cannot be written. */
vs_status vs_modes_command(const char *scene, char *const *sets, size_t n_sets, const char *folder,
                           bool json, bool quiet, vs_error *err);

#endif
