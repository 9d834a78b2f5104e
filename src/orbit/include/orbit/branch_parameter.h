/* SPDX-License-Identifier: GPL-3.0-or-later
 * The scene key that a branch is followed over: which one, from where to where, and the scene with
 * another value of it. */
#pragma once

#include "run/axis.h"

/* Filled by vs_branch_parameter_read, freed by vs_branch_parameter_free also after an error. Values
 * of the key are in the axis' unit. Not to be moved: its axis points into it. */
typedef struct vs_branch_parameter {
  vs_axis axis;
  vs_scene *scene;               /* borrowed; its tree and its setup change with the key */
  double from, to;               /* the range, in the order given */
  double at;                     /* where marks are asked for, too; NaN: nowhere */
  double step;                   /* the largest change of the key from one point to the next, > 0 */
  char place[VS_KEY_SIZE + 128]; /* "--along KEY=FROM..TO", for messages */
} vs_branch_parameter;

/* How many points a branch without turns has at least, unless --step says more. */
enum { VS_ALONG_POINTS = 50 };

/* What the command line says of a branch. */
typedef struct vs_branch_parameter_words {
  const char *range; /* "KEY=FROM..TO", each end as the scene's file would have it */
  const char *step;  /* NULL: a 50th of the range */
  const char *at;    /* a value of the key; NULL: none */
} vs_branch_parameter_words;

/* Reads the words ("firing.angle=130deg..80deg"). Puts the key at FROM. Errors, VS_INPUT: the
 * text has another form; the scene has no such key; the key has words or whole numbers, or is one
 * on which no orbit depends; an end is not allowed; both are one; the step is none; `at` lies
 * outside of the range. */
vs_status vs_branch_parameter_read(vs_branch_parameter *along, vs_scene *scene,
                                   const vs_branch_parameter_words *words, vs_error *err);
void vs_branch_parameter_free(vs_branch_parameter *along);

/* Settles the scene with that value of the key, to all its digits. Errors: those of
 * vs_scene_reread. */
vs_status vs_branch_parameter_move(vs_branch_parameter *along, double key, vs_error *err);
