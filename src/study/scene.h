/* SPDX-License-Identifier: GPL-3.0-or-later
 * A scene, read: the numbers of a run, what to record, what was measured, which tier and why. */
#ifndef VS_STUDY_SCENE_H
#define VS_STUDY_SCENE_H

#include "base/path.h"
#include "sim/sim.h"
#include "watch/measures.h"

extern const vs_shelf vs_scene_shelf, vs_study_shelf;

/* At most; of limits that nothing is held against. */
enum { VS_IDLE_LIMITS = 8, VS_WARNINGS = 4 + VS_DECK_PARTS + VS_DECK_DEVICES + VS_IDLE_LIMITS };

typedef struct vs_scene {
  char path[VS_PATH_SIZE];
  vs_tree tree;
  vs_setup setup;
  const char *tier_named; /* --tier's word, borrowed; NULL: not given */
  const char *asks; /* what the command line asked the circuit tier for, borrowed; NULL: nothing */
  const vs_tier *tier;
  char why[256];  /* this tier */
  vs_frame frame; /* of this tier; its channels are what `record` chooses from */
  int record[VS_CH_MOST], n_record;
  vs_value measured[VS_MEASURES]; /* SI */
  vs_error warnings[VS_WARNINGS]; /* with their place, if what they warn of was written */
  size_t n_warnings;
} vs_scene;

/* name: a path, or the name of a scene that comes with the program. sets: the --set arguments.
 * tier: --tier's, NULL when not given. Errors: everything a scene can be wrong in; a check carries
 * on from most of them. vs_scene_free even then. */
vs_status vs_scene_read(const char *name, char *const *sets, size_t n_sets, const char *tier,
                        vs_scene *scene, vs_error *err);
void vs_scene_free(vs_scene *scene);

/* The same in two halves, for what alters the tree in between: where is of the name. */
vs_status vs_scene_open(const char *name, vs_where where, vs_scene *scene, vs_error *err);
vs_status vs_scene_settle(vs_scene *scene, const char *tier, vs_error *err);
/* Once more after the tree was altered: the setup and its tier anew, as vs_scene_settle without
 * --tier would have them (the deck is read again only if another is named), and its warnings; what
 * to record and what was measured stay as they are. */
vs_status vs_scene_again(vs_scene *scene, vs_error *err);

/* The same scene with these KEY=VALUE over its tree, read anew into `other`, which is freed with
 * vs_scene_free also after an error, and before `scene`. Errors: those of vs_scene_settle. */
vs_status vs_scene_with(const vs_scene *scene, const char *const *keys, size_t n_keys,
                        vs_scene *other, vs_error *err);
/* What is to be said of a deck without the port mains; NULL: it has one, or its ports are not
 * known.
 */
const char *vs_scene_without_mains(const vs_deck *deck);

/* A line for each warning on standard error. */
void vs_scene_warn(const vs_scene *scene);

/* For what only the circuit tier has, and the command line asks for: tier auto takes that tier.
 * The scene must have been settled well. asks: "--raw", lives as long as the scene. Error: another
 * tier is named. */
vs_status vs_scene_take_circuit(vs_scene *scene, const char *asks, vs_error *err);

/* The sections of a scene and the values they filled, for print-outs; index from 0, false: no more.
 */
typedef struct vs_scene_part {
  const vs_section *section;
  const void *values;
  size_t size; /* of the struct of values, bytes */
} vs_scene_part;
enum { VS_SCENE_PARTS = 9 };
vs_scene_part vs_scene_part_at(const vs_scene *scene, int index);

#endif
