/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/trial.h"

#include <stdlib.h>

static vs_status accept_step_of_trial(void *ctx, const vs_step *step, const vs_result *result,
                                      vs_error *err) {
  const vs_observer *also = ctx;
  (void)result;
  return also->accept(also->ctx, step, err);
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
  const vs_session_listener guest = {.ctx = (void *)(size_t)also, .accept = accept_step_of_trial};
  const vs_session session = {.guest = also ? &guest : NULL};
  t->status = vs_session_run(&session, &t->scene, &t->result, &t->err);
}

vs_trial *vs_trial_run(const char *name, const char *tier, const char *const *sets,
                       const vs_observer *also) {
  vs_trial *t = vs_trial_read(name, tier, sets);
  vs_trial_go(t, also);
  return t;
}

void vs_trial_free(vs_trial *t) {
  vs_result_free(&t->result);
  vs_scene_free(&t->scene);
  free(t);
}
