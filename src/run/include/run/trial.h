/* SPDX-License-Identifier: GPL-3.0-or-later
 * One run of a scene that is kept in memory, for those who ask for its numbers instead of showing
 * them: comparisons and tests. */
#pragma once

#include "run/session.h"

/* A scene with the result of its run. Where the ladder was climbed, result.scene is another one
 * than `scene`. vs_trial_free frees all of it. */
typedef struct vs_trial {
  vs_scene scene;
  vs_result result;
  vs_status status; /* how reading or running went */
  vs_error err;
} vs_trial;

/* Reads and runs a scene. scene, tier: as for vs_scene_read. sets: a list of KEY=VALUE that NULL
 * ends; it may be NULL. also: is shown every step, once the watchers have seen it; it may be NULL.
 * Never returns NULL. */
vs_trial *vs_trial_run(const char *scene, const char *tier, const char *const *sets,
                       const vs_observer *also);
/* The same in two halves, for tests that alter the numbers in between. Where reading failed,
 * vs_trial_go does nothing. */
vs_trial *vs_trial_read(const char *scene, const char *tier, const char *const *sets);
void vs_trial_go(vs_trial *trial, const vs_observer *also);
void vs_trial_free(vs_trial *trial);
