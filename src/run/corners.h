/* SPDX-License-Identifier: GPL-3.0-or-later
 * The corners of a scene: runs at all ends of what its key `spread` says is not known exactly, and
 * the worst line of each one's verdict. */
#ifndef VS_RUN_CORNERS_H
#define VS_RUN_CORNERS_H

#include <signal.h>

#include "run/result.h"

/* How the scene is read and run; all of it is borrowed. */
typedef struct vs_corners_order {
  const char *scene; /* its name or path */
  char *const *sets; /* KEY=VALUE of each --set */
  size_t n_sets;
  bool allow_code, quiet;
  vs_status (*steady)(vs_scene *scene, vs_error *err); /* as in vs_session */
  const volatile sig_atomic_t *stop;                   /* set by a signal: the run ends */
} vs_corners_order;

/* Reads all of them, then runs them, one behind the other, each with a second run for the errors of
 * its margins. One that fails is noted, and the others go on. Nothing is written or printed but
 * progress. Errors: those of the key spread, and of a scene that cannot be read at a corner, which
 * name the corner, with nothing run; VS_SIGNAL. */
vs_status vs_corners_run(const vs_corners_order *order, const vs_scene *nominal,
                         vs_corners *corners, vs_error *err);

#endif
