/* SPDX-License-Identifier: GPL-3.0-or-later
 * The keys of a scene by their dotted names ("firing.angle", "actuator.stop.stiffness",
 * "events.dip.at", "instruments.p.noise"), for whoever varies one. */
#pragma once

#include "run/scene.h"

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

/* The scene's key `spread`: what of it is not known exactly, {KEY: TOLERANCE, ...}. A tolerance is
 * a part of the key's value, "10 %"; or in the key's unit, "2 ohm"; or, of a device's value or of
 * its factor NAME_scale, what its part's file states: "tolerance", "ageing", or "tolerance and
 * ageing", whose factors are multiplied. "KEY with KEY" are two keys that go up and down together.
 */
enum { VS_SPREADS_MOST = 6 };
typedef struct vs_spreads {
  struct {
    char key[VS_KEY_SIZE]; /* "supply.voltage" */
    char unit[16];         /* of the two values */
    double value[2];       /* the ends: the lesser, the larger */
    size_t number;         /* of its spread, from 0; two keys that go together have the same */
  } item[2 * VS_SPREADS_MOST];
  size_t count, spreads; /* of the items; of the numbers */
} vs_spreads;

/* True for a tolerance in words: "tolerance", "ageing", "tolerance and ageing". */
bool vs_key_is_figure(const char *way);
/* Multiplies end[] by what such words stand for, parts of the key's value: the part's file of the
 * device whose value or factor the key is states them. Error: it does not. */
vs_status vs_key_figures(const vs_scene *scene, const char *key, const char *way, vs_where where,
                         double end[2], vs_error *err);

/* The value of item n at a corner. Bit k of a corner's number says at which end spread k is: 1, the
 * larger one. */
double vs_key_spread_at(const vs_spreads *spreads, size_t n, size_t corner);

/* Reads the key of a settled scene. Where the scene has none, the mains may be 10 % off, with
 * line_voltage of a deck that has such a parameter, and each varistor that has a factor of its own
 * by the tolerance and ageing that its part's file states, or by 10 % where it states neither.
 * Where these are more than VS_SPREADS_MOST, it is the one factor of all varistors, by 10 %. Errors
 * with their place: no such key, one that is no number or has no value, a tolerance that is none,
 * an end out of the key's range, more keys than VS_SPREADS_MOST.
 */
vs_status vs_key_spreads(const vs_scene *scene, vs_spreads *spreads, vs_error *err);
