/* SPDX-License-Identifier: GPL-3.0-or-later
 * A case of a study as a scene's file, which `run` takes. */
#ifndef VS_STUDY_DESIGN_SCENE_H
#define VS_STUDY_DESIGN_SCENE_H

#include "study/plan.h"

/* Adds the scene of the point, with everything that its file, `set` and --set say. Files that are
 * named beside these get their whole path. Error: the scene cannot be read. */
vs_status vs_design_scene_add(const vs_plan *plan, const double *point, vs_text *text,
                              vs_error *err);

#endif
