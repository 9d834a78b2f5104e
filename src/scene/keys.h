/* SPDX-License-Identifier: GPL-3.0-or-later
 * The keys of a scene by their dotted names ("firing.angle", "actuator.stop.stiffness",
 * "events.dip.at", "instruments.p.noise"), for whoever varies one. */
#ifndef VS_SCENE_KEYS_H
#define VS_SCENE_KEYS_H

#include "scene/scene.h"

enum { VS_KEY_SIZE = 192 }; /* bytes of a key's name at most */

/* One key, and where its value is in a scene, from which field and value are borrowed. */
typedef struct vs_key {
  char name[VS_KEY_SIZE], section[VS_KEY_SIZE]; /* "circuit.r1", "circuit" */
  const vs_field *field;
  const void *value; /* the member that the field fills; NULL: the scene has no value */
} vs_key;

/* Finds the scene's key of that name. Error, at `where`: there
 * is none; the nearest is named. */
vs_status vs_key_find(const vs_scene *scene, const char *name, vs_where where, vs_key *key,
                      vs_error *err);

/* The key's value as a number, SI; a whole number's word ("once") is 0. NaN: it has none, or is no
 * number. */
double vs_key_number(const vs_key *key);

#endif
