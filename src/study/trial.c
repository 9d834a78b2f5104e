/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/trial.h"

#include <stdlib.h>

#include "base/text.h"

static vs_status accept(void *ctx, const vs_step *step, vs_error *err) {
  vs_trial *t = ctx;
  t->steps++;
  vs_measures_accept(t->measures, step);
  vs_devices_accept(t->devices, step);
  vs_energy_accept(&t->energy, step);
  return t->also ? t->also->accept(t->also->ctx, step, err) : VS_OK;
}

vs_trial *vs_trial_read(const char *name, const char *tier, const char *const *sets) {
  vs_trial *t = vs_alloc(1, sizeof *t);
  size_t n = 0;
  while (sets && sets[n]) n++;
  t->status = vs_scene_read(name, (char *const *)(size_t)sets, n, tier, &t->scene, &t->err);
  return t;
}

void vs_trial_go(vs_trial *t, const vs_observer *also) {
  if (t->status) return;
  t->also = also;
  t->measures = vs_measures_new(&t->scene.frame);
  t->devices = vs_devices_new(&t->scene.frame);
  t->energy.frame = &t->scene.frame;
  vs_observer observer = {t, accept};
  t->status = vs_sim_run(t->scene.tier, &t->scene.setup, &observer, &t->err);
  vs_measures_finish(t->measures, t->values);
  vs_energy_finish(&t->energy);
  vs_devices_finish(t->devices);
}

vs_trial *vs_trial_run(const char *name, const char *tier, const char *const *sets,
                       const vs_observer *also) {
  vs_trial *t = vs_trial_read(name, tier, sets);
  vs_trial_go(t, also);
  return t;
}

void vs_trial_free(vs_trial *t) {
  vs_measures_free(t->measures);
  vs_devices_free(t->devices);
  vs_scene_free(&t->scene);
  free(t);
}
