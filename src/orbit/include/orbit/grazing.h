/* SPDX-License-Identifier: GPL-3.0-or-later
 * How little a parameter must change so that a contact with a stop comes or goes in a run. */
#pragma once

#include "orbit/variation.h"

/* The depth of the armature in a stop where it turns in the step, m; negative: so much is missing.
 * NaN: it does not turn there. */
double vs_grazing_depth(const vs_step *step, const vs_stop *stop);

/* The least change of p, over all steps so far, and when that contact is. */
typedef struct vs_grazing {
  double by, at_s; /* by: INFINITY at first */
} vs_grazing;

/* Takes a step that `variation`, which has the column of a parameter alone, has taken: what the
 * armature lacks of each stop, or has of it, where it turns, over what p makes of that. */
void vs_grazing_accept(vs_grazing *grazing, const vs_variation *variation, const vs_step *step);
