/* SPDX-License-Identifier: GPL-3.0-or-later
 * One run of a scene that is kept in memory: for what asks for its numbers instead of showing them.
 */
#ifndef VS_SCENE_TRIAL_H
#define VS_SCENE_TRIAL_H

#include "scene/session.h"

/* A scene with its session's result. also: shown every step, once the watchers have seen it (may be
 * NULL). Where the ladder was climbed result.scene is another than `scene`. All is freed with
 * vs_trial_free. */
typedef struct vs_trial {
  vs_scene scene;
  vs_result result;
  vs_status status;
  vs_error err;
} vs_trial;

/* scene, tier: as for vs_scene_read; sets: a NULL-ended list of KEY=VALUE. Never NULL; status and
 * err say how it went. */
vs_trial *vs_trial_run(const char *scene, const char *tier, const char *const *sets,
                       const vs_observer *also);
/* The same in two halves, for a test that alters the numbers in between. */
vs_trial *vs_trial_read(const char *scene, const char *tier, const char *const *sets);
void vs_trial_go(vs_trial *trial, const vs_observer *also);
void vs_trial_free(vs_trial *trial);

#endif
