/* SPDX-License-Identifier: GPL-3.0-or-later
 * The walk along a branch of orbits: from the orbit at the first value of the key, step by step in
 * the direction of the branch (pseudo-arclength), around folds, until it leaves the key's range or
 * cannot go on. Between neighbours it looks for marks. */
#pragma once

#include <signal.h>

#include "branch_points.h"
#include "orbit/marks.h"

/* A point as it was found, or a mark. */
typedef struct vs_continuation_row {
  vs_branch_point at;
  vs_mark mark; /* kind NULL: a point of the walk */
} vs_continuation_row;

/* How a walk ended. */
typedef enum vs_continuation_end {
  VS_CONTINUATION_REACHED, /* at the other end of the range */
  VS_CONTINUATION_BACK,    /* where it began */
  VS_CONTINUATION_MERGED,  /* in a branch of a smaller period */
  VS_CONTINUATION_STUCK,   /* in between: no orbit was found any more, or the scene is refused ahead
                            */
  VS_CONTINUATION_SPENT,   /* in between: its budget is spent, of cycles or of points */
  VS_CONTINUATION_STOPPED  /* in between, by a signal */
} vs_continuation_end;

/* Free with vs_continuation_free, also after an error. */
typedef struct vs_continuation {
  vs_branch_parameter *along; /* borrowed */
  vs_branch_points path;
  vs_continuation_row
      *row; /* in the order along the branch, marks between their neighbours; owned */
  size_t count, room;
  size_t marks; /* how many of them are marks */
  vs_continuation_end end;
  char why[512]; /* where it is stuck, or its budget is spent: the reason */
} vs_continuation;

/* Walks. stop: set by a signal, the walk ends behind the next point. Errors: those of
 * vs_branch_points_begin, where nothing is found. A walk that is stuck, spent or stopped is no
 * error; walk->end says so. */
vs_status vs_continuation_go(vs_continuation *walk, vs_branch_parameter *along, int periods,
                             const volatile sig_atomic_t *stop, vs_error *err);
void vs_continuation_free(vs_continuation *walk);
