/* SPDX-License-Identifier: GPL-3.0-or-later
 * A scene as it was read: the numbers of a run, what it records, what was measured of the machine,
 * which tier runs it and why. */
#pragma once

#include "base/path.h"
#include "control/control.h"
#include "measure/expect.h"
#include "measure/measures.h"
#include "run/ratings.h"
#include "run/tier_choice.h"
#include "run/warnings.h"

/* The word of `record` for all probes. */
extern const char vs_scene_all_probes[];

/* Where scenes, studies and fits that come with the program are. */
extern const vs_shelf vs_scene_shelf, vs_scene_study_shelf, vs_scene_fit_shelf;

/* Begins as zeros, or as a scene that was freed. Filled by vs_scene_read, and freed by
 * vs_scene_free also after an error. Not to be moved: its frame points into its setup. It has 300
 * kB, so zeros that are there already are not written again. */
typedef struct vs_scene {
  bool opened; /* it has had something else than zeros in it */
  char path[VS_PATH_SIZE];
  vs_tree tree;
  vs_setup setup;         /* constant once the scene is settled */
  vs_run_order order;     /* what its next run has besides; whoever runs it may change it */
  const char *tier_named; /* the word of --tier, borrowed; NULL: not given */
  const char *asks; /* what the command line asked the circuit tier for, borrowed; NULL: nothing */
  bool allow_code;  /* the command line allows code of the user's own (--allow-code) */
  bool held;        /* its control is off (vs_scene_disable_control) */
  bool of_period;   /* a period of its orbit is wanted, not its run; set before it is read */
  const vs_tier *tier;
  char why[VS_TIER_CHOICE_WHY];        /* why this tier */
  vs_frame frame;                      /* of this tier */
  vs_instruments instruments;          /* none where the scene has no such section */
  vs_control control;                  /* likewise */
  vs_quality_list quality;             /* currents whose quality is told */
  vs_expects expects;                  /* what may happen to devices, and has to */
  vs_ratings ratings;                  /* the user's own limits */
  int record[VS_CH_MOST], n_record;    /* channels of the frame, in the order of the columns */
  vs_value measured[VS_MOST_MEASURES]; /* SI; as the scene's `measured` says, in the order of
                                          vs_measure_at */
  vs_warnings warnings;                /* that are known before a run */
} vs_scene;

/* Reads a scene. name: a path, or the name of a scene that comes with the program. sets: KEY=VALUE
 * of each --set. tier: the word of --tier; NULL: not given. Errors: everything a scene can be wrong
 * in. Where err gathers findings, reading carries on from most of them. */
vs_status vs_scene_read(const char *name, char *const *sets, size_t n_sets, const char *tier,
                        vs_scene *scene, vs_error *err);
void vs_scene_free(vs_scene *scene);

/* vs_scene_read in two halves, for callers that alter the tree in between. where: the place at
 * which the name was written. */
vs_status vs_scene_open(const char *name, vs_where where, vs_scene *scene, vs_error *err);
vs_status vs_scene_read_sections(vs_scene *scene, const char *tier, vs_error *err);
/* Settles the scene once more after its tree was altered. Setup, tier and warnings are made anew,
 * as vs_scene_read_sections without --tier makes them; the deck is read again only where another is
 * named. `record` and `measured` stay as they are. */
vs_status vs_scene_reread(vs_scene *scene, vs_error *err);

/* Reads the same scene into `other` with these KEY=VALUE over its tree; run.tier=NAME also stands
 * above --tier. `other` is to be freed before `scene`, also after an error. Errors: those of
 * vs_scene_read_sections. */
vs_status vs_scene_with(const vs_scene *scene, const char *const *keys, size_t n_keys,
                        vs_scene *other, vs_error *err);

/* Takes the scene's control off for good, also where it is settled again, and adds a warning that
 * says so. A scene without a control stays as it is. Whoever asks for a periodic orbit gets that of
 * the angle firing.angle. */
void vs_scene_disable_control(vs_scene *scene);

/* Prints a line on standard error for each of the scene's warnings. */
void vs_scene_warn(const vs_scene *scene);

/* Makes a scene of tier auto take the circuit tier, as the command line asks for what only that
 * tier has. The scene must have been settled without an error. asks: "--raw"; it must outlive the
 * scene. Error: another tier is named. */
vs_status vs_scene_take_circuit(vs_scene *scene, const char *asks, vs_error *err);
