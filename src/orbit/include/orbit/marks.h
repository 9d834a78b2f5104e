/* SPDX-License-Identifier: GPL-3.0-or-later
 * The marks of a branch: orbits at which something begins or ends, such as a fold or the grazing of
 * a stop. Each kind has a number that changes its sign there, and the mark is found as that
 * number's zero along the branch. */
#pragma once

#include <stdbool.h>

struct vs_model;
struct vs_branch_points;
struct vs_branch_point;

/* Two neighbours on the branch. */
typedef struct vs_marks_span {
  const struct vs_branch_point *a, *b;
  const struct vs_model *model;
  int count; /* of the states */
  double at; /* the value of the key that marks are asked for at; NaN: none */
} vs_marks_span;

/* Each kind is a constant. */
typedef struct vs_mark_kind {
  const char *name, *text;
  /* The number whose sign changes, at a point of the span. NaN: the model has no such marks. which:
   * of several, such as the model's stops, from 0. */
  double (*value)(const vs_marks_span *span, const struct vs_branch_point *at, int which);
  /* How many the model has. NULL: one. */
  int (*count)(const struct vs_model *model);
  /* Whether it is one, as the number may have other zeros. NULL: it is. */
  bool (*holds)(const struct vs_branch_point *at, int states);
  bool neutral;  /* a multiplier lies on the unit circle, so that the orbit is neither stable nor
                    unstable for its sake */
  bool in_pairs; /* two may lie so near that a step goes over both; the number then comes near to 0
                    without a change of its sign */
} vs_mark_kind;

/* The kinds, in the order of lists; NULL ends them. */
extern const vs_mark_kind *const vs_mark_kinds[];
/* The one of them that the walk itself finds: where the branch ends in one of a smaller period. */
extern const vs_mark_kind vs_mark_merging;

typedef struct vs_mark {
  const vs_mark_kind *kind; /* NULL: it is none */
  int which;
  double error; /* by how much the key may be off for the sake of the search, in the axis' unit */
} vs_mark;

/* Whether the kind's number has unlike signs at the ends of the span. */
bool vs_mark_between(const vs_mark *mark, const vs_marks_span *span);

/* Finds the orbit that is `part` of the way from one end of the span to the other. Returns false
 * where the iteration fails. */
bool vs_mark_middle(struct vs_branch_points *path, const vs_marks_span *span, double part,
                    struct vs_branch_point *at);

/* Finds the mark in the span: the orbit there, and mark->error. Returns false where the kind says
 * it is none after all. Where the iteration fails between the two, the mark is the nearer of the
 * two orbits between which it was last known to lie, and the error says how far they are apart. */
bool vs_mark_locate(struct vs_branch_points *path, const vs_marks_span *span, vs_mark *mark,
                    struct vs_branch_point *at);
