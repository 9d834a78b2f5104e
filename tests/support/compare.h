/* SPDX-License-Identifier: GPL-3.0-or-later
 * A run beside its reference in run.tolerance's norm: the largest error over the samples of p, u,
 * w, phi, i and force, each in parts of its own peak in the run. */
#pragma once

#include "oracle.h"

enum { COMPARED = 6 };
typedef struct comparison {
  double *table;     /* the oracle's: rows x ORACLE_COLUMNS, the first at t = 0 */
  size_t rows, next; /* next: how many have been seen */
  bool filling;      /* the table, by the run that is seen */
  double sample_s;
  double worst[COMPARED], peak[COMPARED]; /* SI */
} comparison;

/* Solves the scene; NULL: it has no solution. */
comparison *compare_with(const oracle_scene *scene);
/* With the run seen next: it fills the table. */
comparison *compare_with_run(const oracle_scene *scene);
void compare_again(comparison *c); /* for another run */
void compare_free(comparison *c);

/* An observer's accept; ctx: the comparison. */
vs_status compare_accept(void *ctx, const vs_step *step, vs_error *err);

/* The worst, and which it is (which may be NULL). Infinite when a row is missing or not a number.
 */
double compare_error(const comparison *c, const char **which);
