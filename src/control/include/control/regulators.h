/* SPDX-License-Identifier: GPL-3.0-or-later
 * The table of the laws of control. */
#pragma once

#include "control/regulator.h"

/* NULL stands behind the last. */
extern const vs_regulator *const vs_regulators[];

/* The laws, each in a file of its own. */
extern const vs_regulator vs_amplitude_regulator, vs_phase_regulator, vs_pipe_regulator,
    vs_object_regulator, vs_fmu_regulator;

/* The one of that name; NULL: there is none. */
const vs_regulator *vs_regulators_find(const char *name);
