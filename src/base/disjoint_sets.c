/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/disjoint_sets.h"

#include <stdlib.h>

#include "base/alloc.h"

size_t vs_disjoint_sets_add(vs_disjoint_sets *sets) {
  sets->parent = vs_alloc_grow(sets->parent, sets->count, sizeof *sets->parent);
  sets->parent[sets->count] = sets->count;
  return sets->count++;
}

size_t vs_disjoint_sets_find(vs_disjoint_sets *sets, size_t number) {
  size_t *parent = sets->parent;
  while (parent[number] != number) number = parent[number] = parent[parent[number]];
  return number;
}

bool vs_disjoint_sets_join(vs_disjoint_sets *sets, size_t a, size_t b) {
  a = vs_disjoint_sets_find(sets, a);
  b = vs_disjoint_sets_find(sets, b);
  sets->parent[a < b ? b : a] = a < b ? a : b;
  return a != b;
}

void vs_disjoint_sets_free(vs_disjoint_sets *sets) {
  free(sets->parent);
  *sets = (vs_disjoint_sets){0};
}
