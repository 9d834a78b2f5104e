/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a study's file is read: its scene, its methods with their axes, its columns, and on trial the
 * scenes of its first cases. */
#pragma once

#include "study/plan.h"

/* Reads the study called name: a path, or the name of one that comes with the program. Errors:
 * everything a study can be wrong in, and the scene of its first case; a check carries on from
 * most. vs_plan_free even then. */
vs_status vs_study_file_read(const char *name, const vs_method *const *methods, char *const *sets,
                             size_t n_sets, vs_plan *plan, vs_error *err);
