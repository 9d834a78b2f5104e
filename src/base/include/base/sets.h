/* SPDX-License-Identifier: GPL-3.0-or-later
 * Disjoint sets of the numbers 0, 1, 2, ...: each number is in one set, and sets can be joined (a
 * union-find forest). */
#ifndef VS_BASE_SETS_H
#define VS_BASE_SETS_H

#include <stdbool.h>
#include <stddef.h>

/* Begins as {0}; ends with vs_sets_free. */
typedef struct vs_sets {
  size_t *parent; /* of each number: one of its set that is less, or itself; owned */
  size_t count;   /* of the numbers */
} vs_sets;

/* Adds the next number, in a set of its own, and returns it. */
size_t vs_sets_add(vs_sets *sets);

/* The least number of the set that this one is in. */
size_t vs_sets_find(vs_sets *sets, size_t number);

/* Joins the sets of two numbers; false: they were one already. */
bool vs_sets_join(vs_sets *sets, size_t a, size_t b);

void vs_sets_free(vs_sets *sets);

#endif
