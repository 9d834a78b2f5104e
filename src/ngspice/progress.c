/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "progress.h"

#include <math.h>

/* A run makes no progress when it takes VS_PROGRESS_TRIES steps, failed ones too, for PROGRESS_S or
 * for one largest step. At such instants steps of 1e-12 s on average were measured, which is 1e7
 * steps for PROGRESS_S; a junction that rings undamped takes 3e3 at its worst. Steps are counted
 * and not seconds, so that every computer ends the run at the same step. */
static const double PROGRESS_S = 1e-5;

bool vs_progress_made(vs_progress *progress, double reached_s, double max_step_s) {
  progress->tries++;
  if (reached_s - progress->from_s >= fmin(max_step_s, PROGRESS_S))
    *progress = (vs_progress){.from_s = reached_s};
  return progress->tries < VS_PROGRESS_TRIES;
}
