/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is tried when a solver gives up on a scene: the same scene with other settings, one rung
 * after the other. A rung is a few keys that a user could set. The result says how far was climbed.
 */
#pragma once

#include "run/scene.h"

enum { VS_LADDER_KEYS = 4 }; /* at most, on one rung */

typedef struct vs_ladder {
  int rung;                      /* 0: the scene as it is */
  char keys[VS_LADDER_KEYS][64]; /* KEY=VALUE of this rung, as for --set */
  size_t n_keys;
  bool gear;                                  /* method of the scene as it is */
  double own_step_s;                          /* largest step of the scene as it is, s */
  double step_s;                              /* the same by Gear's rule */
  double tolerance;                           /* run.tolerance of the scene as it is */
  double trtol, pivrel;                       /* ngspice's own settings in the scene as it is */
  char failed[sizeof(((vs_error *)0)->text)]; /* error of the scene as it is; empty before the
                                                 first climb */
} vs_ladder;

/* What a rung is, in a few words. */
const char *vs_ladder_text(int rung);

/* Goes to the next rung that changes anything for the scene as it is, and fills its keys. Returns
 * false where there is none, or where run.ladder stops before it: `stay` on the first rung, `climb`
 * before the ideal thyristor. */
bool vs_ladder_climb(vs_ladder *ladder, const vs_scene *scene);
/* True: `run.ladder: ideal` would have one rung more for this scene. */
bool vs_ladder_stopped_short(const vs_scene *scene);

/* Reads the scene of this rung into `other`: `scene` with the rung's keys. On a rung with an ideal
 * thyristor its ratings and limits are those of `scene`, which must live as long as `other`.
 * Errors: those of vs_scene_with; `other` is freed with vs_scene_free also after one. */
vs_status vs_ladder_scene(const vs_ladder *ladder, const vs_scene *scene, vs_scene *other,
                          vs_error *err);
