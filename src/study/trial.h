/* SPDX-License-Identifier: GPL-3.0-or-later
 * One run of a scene that is kept in memory: for what asks for its numbers instead of showing them.
 */
#ifndef VS_STUDY_TRIAL_H
#define VS_STUDY_TRIAL_H

#include "study/scene.h"
#include "watch/devices.h"
#include "watch/energy.h"

/* All measures taken. scene, tier: as for vs_scene_read; sets: a NULL-ended list of KEY=VALUE.
 * also: shown every step as well (may be NULL). The scene is freed with vs_trial_free. */
typedef struct vs_trial {
  vs_scene scene;
  vs_value values[VS_MEASURES];
  vs_energy energy;
  vs_measures *measures;
  vs_devices *devices; /* NULL: the deck has none */
  const vs_observer *also;
  long steps;
  vs_status status;
  vs_error err;
} vs_trial;
vs_trial *vs_trial_run(const char *scene, const char *tier, const char *const *sets,
                       const vs_observer *also);
/* The same in two halves, for a test that alters the numbers in between. */
vs_trial *vs_trial_read(const char *scene, const char *tier, const char *const *sets);
void vs_trial_go(vs_trial *trial, const vs_observer *also);
void vs_trial_free(vs_trial *trial);

#endif
