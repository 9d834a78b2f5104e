/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a run tries when ngspice gives up: the same scene with other settings, one rung after the
 * other, each a few keys that a user could set. What was climbed stands in the result. */
#ifndef VS_SCENE_LADDER_H
#define VS_SCENE_LADDER_H

#include "scene/scene.h"

enum { VS_LADDER_KEYS = 4 }; /* at most, on one rung */

typedef struct vs_ladder {
  int rung;                      /* 0: the scene as it is */
  char keys[VS_LADDER_KEYS][64]; /* KEY=VALUE of this rung, as for --set */
  size_t n_keys;
  bool gear;                    /* the scene as it is: its method, */
  double step_s, trtol, pivrel; /* its largest step by Gear's rule, and ngspice's own */
  char failed[sizeof(((vs_error *)0)->text)]; /* how the scene as it is ended */
} vs_ladder;

const char *vs_ladder_text(int rung); /* what a rung is, in a few words */

/* Goes to the next rung that changes anything for the scene as it is; false: there is none, or
 * run.ladder stops before it: `stay` on the first rung, `climb` before the ideal thyristor. */
bool vs_ladder_climb(vs_ladder *ladder, const vs_scene *scene);
/* True where run.ladder: ideal would have had one rung more. */
bool vs_ladder_stopped_short(const vs_scene *scene);

/* Reads the scene of this rung into `other`: `scene` with the rung's keys. On a rung with an ideal
 * thyristor its ratings and limits are those of `scene`, which must live as long as `other`.
 * Errors: those of vs_scene_with; `other` is freed with vs_scene_free also after one. */
vs_status vs_ladder_scene(const vs_ladder *ladder, const vs_scene *scene, vs_scene *other,
                          vs_error *err);

#endif
