/* SPDX-License-Identifier: GPL-3.0-or-later
 * The walk along a branch of orbits: from the orbit at the first value of the key, step by step in
 * the direction of the branch (pseudo-arclength), around folds, until it leaves the key's range or
 * cannot go on. Between neighbours it looks for marks. */
#ifndef VS_ORBIT_WALK_H
#define VS_ORBIT_WALK_H

#include <signal.h>

#include "orbit/marks.h"
#include "path.h"

/* A point as it was found, or a mark. */
typedef struct vs_walk_row {
  vs_path_point at;
  vs_mark mark; /* kind NULL: a point of the walk */
} vs_walk_row;

/* How a walk ended. */
typedef enum vs_walk_end {
  VS_WALK_REACHED, /* at the other end of the range */
  VS_WALK_BACK,    /* where it began */
  VS_WALK_MERGED,  /* in a branch of a smaller period */
  VS_WALK_STUCK,   /* in between: no orbit was found any more, or the scene is refused ahead */
  VS_WALK_SPENT,   /* in between: its budget is spent, of cycles or of points */
  VS_WALK_STOPPED  /* in between, by a signal */
} vs_walk_end;

/* Free with vs_walk_free, also after an error. */
typedef struct vs_walk {
  vs_along *along; /* borrowed */
  vs_path path;
  vs_walk_row *row; /* in the order along the branch, marks between their neighbours; owned */
  size_t count, room;
  size_t marks; /* how many of them are marks */
  vs_walk_end end;
  char why[512]; /* where it is stuck, or its budget is spent: the reason */
} vs_walk;

/* Walks. stop: set by a signal, the walk ends behind the next point. Errors: those of
 * vs_path_begin, where nothing is found. A walk that is stuck, spent or stopped is no error;
 * walk->end says so. */
vs_status vs_walk_go(vs_walk *walk, vs_along *along, int periods, const volatile sig_atomic_t *stop,
                     vs_error *err);
void vs_walk_free(vs_walk *walk);

#endif
