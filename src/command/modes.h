/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `modes`: eigenfrequencies, damping, shapes, state space. */
#ifndef VS_COMMAND_MODES_H
#define VS_COMMAND_MODES_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

/* Prints the modes; with a folder writes modes.csv and the state space of Eqs. 84-87 as A.csv,
 * B.csv, C.csv, D.csv (plain matrices, 17 digits, no header). */
vs_status vs_modes_command(const char *scene, char *const *sets, size_t n_sets, const char *folder,
                           bool json, vs_error *err);

#endif
