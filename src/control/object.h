/* SPDX-License-Identifier: GPL-3.0-or-later
 * A law of the user's own that is loaded into a child process: a shared object with a function
 * (object.c), or a functional mock-up unit (fmu.c). */
#pragma once

#include "base/path.h"
#include "child_process.h"
#include "law_input.h"

enum { VS_OBJECT_TROUBLE = 512 }; /* bytes of why a file is of no use, the end included */

/* The state of the regulator, or the first member of it. Begins as zeros. */
typedef struct vs_object {
  vs_law_input view;
  vs_child_process remote;
  char named[VS_PATH_SIZE]; /* the file, as the scene names it */
  char path[VS_PATH_SIZE];  /* the same, from the root */
  /* What the child does. load: returns the law; NULL: it is of no use, and trouble tells why.
   * decide: an angle, deg, unless it writes to `error` why not, as in vibrospice/law.h. end (may be
   * NULL): nobody asks any more. */
  void *(*load)(struct vs_object *o, char trouble[VS_OBJECT_TROUBLE]);
  double (*decide)(void *law, const vibrospice_firing *firing, char *error);
  void (*end)(void *law);
} vs_object;

/* For a law with the key `file`: what a regulator does with that (control/regulator.h). Before
 * vs_object_begin the three functions are set. */
bool vs_object_file(const vs_control_values *v, vs_where where, int k, char path[VS_PATH_SIZE]);
vs_status vs_object_check(const vs_control_values *v, vs_where where, vs_error *err);
vs_status vs_object_begin(vs_object *o, const vs_control_input *sight, vs_error *err);
void vs_object_tick(void *object, const vs_control_input *sight);
vs_status vs_object_decide(void *object, const vs_control_input *sight, double *angle_rad,
                           vs_error *err);
void vs_object_end(void *object);
