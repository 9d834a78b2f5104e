/* SPDX-License-Identifier: GPL-3.0-or-later
 * Disjoint sets of the numbers 0, 1, 2, ...: each number is in one set, and sets can be joined (a
 * union-find forest). */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* Begins as {0}; ends with vs_disjoint_sets_free. */
typedef struct vs_disjoint_sets {
  size_t *parent; /* of each number: one of its set that is less, or itself; owned */
  size_t count;   /* of the numbers */
} vs_disjoint_sets;

/* Adds the next number, in a set of its own, and returns it. */
size_t vs_disjoint_sets_add(vs_disjoint_sets *sets);

/* The least number of the set that this one is in. */
size_t vs_disjoint_sets_find(vs_disjoint_sets *sets, size_t number);

/* Joins the sets of two numbers; false: they were one already. */
bool vs_disjoint_sets_join(vs_disjoint_sets *sets, size_t a, size_t b);

void vs_disjoint_sets_free(vs_disjoint_sets *sets);
