/* SPDX-License-Identifier: GPL-3.0-or-later
 * Cases of a study as scenes' files, which `run` takes. */
#pragma once

#include "method/design_choices.h"

/* Writes the scenes of run[n] into the folder's folder `cases`, each by the number of its run, with
 * everything that its file, `set` and --set say. Files that are named beside these get their whole
 * path. Those of an earlier answer go. Errors: a scene cannot be read, a file not be written. */
vs_status vs_design_scene_write(const vs_plan *plan, const vs_results *results, const uint64_t *run,
                                size_t n, const char *folder, vs_error *err);

/* Adds the limits of the point's parts that no source says, or that it calls typical. */
void vs_design_scene_unsure(const vs_plan *plan, const double *point, vs_text *text);

/* Adds a group "r1, c1 (no limit stated)" of a row's cell not_judged, of `length` bytes, but for
 * what the list of prices judges. */
void vs_design_scene_group(const vs_design *design, const char *group, size_t length,
                           vs_text *text);
