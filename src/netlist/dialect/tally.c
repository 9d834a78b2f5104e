/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/tally.h"

#include <stdio.h>
#include <string.h>

void vs_tally_add(vs_tally *t, const char *what, vs_where where) {
  size_t k = 0;
  while (k < t->count && strcmp(t->item[k].what, what)) k++;
  if (k == VS_TALLY_KINDS) return;
  if (k == t->count) t->item[t->count++] = (struct vs_tallied){what, where, 0};
  t->item[k].count++;
}

void vs_tally_tell(const vs_tally *t, size_t k, char *text, size_t size) {
  const struct vs_tallied *item = &t->item[k];
  int n = snprintf(text, size, "%s", item->what);
  if (item->count > 1 && n > 0 && (size_t)n < size)
    snprintf(text + n, size - (size_t)n, " (%zu times, here first)", item->count);
}
