/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/nesting.h"

#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "lint/circle.h"

typedef struct subcircuit {
  vs_word name;
  size_t begin, end; /* its line .subckt and its .ends */
  size_t number;     /* in the order of the lines */
} subcircuit;

typedef struct netlist {
  const vs_line *lines;
  const vs_word *called;
  subcircuit *list, *sorted; /* in the order of the lines, and by names */
  size_t count;
} netlist;

static int compare_names(const void *a, const void *b) {
  return vs_words_compare(((const subcircuit *)a)->name, ((const subcircuit *)b)->name);
}

/* Finds the subcircuits in their order. */
static void find_subcircuits(netlist *all, size_t n_lines) {
  size_t *open = NULL, depth = 0;
  for (size_t k = 0; k < n_lines; k++) {
    vs_word w[VS_WORDS_MOST];
    const char *text = all->lines[k].text;
    if (vs_words_begin(text, ".subckt") && vs_words_split(text, w) > 1) {
      all->list = vs_alloc_grow(all->list, all->count, sizeof *all->list);
      all->list[all->count] = (subcircuit){w[1], k, n_lines, all->count};
      open = vs_alloc_grow(open, depth, sizeof *open);
      open[depth++] = all->count++;
    } else if (vs_words_begin(text, ".ends") && depth)
      all->list[open[--depth]].end = k;
  }
  free(open);
  all->sorted = vs_alloc(all->count + 1, sizeof *all->sorted);
  if (all->count) memcpy(all->sorted, all->list, all->count * sizeof *all->list);
  qsort(all->sorted, all->count, sizeof *all->sorted, compare_names);
}

/* The only subcircuit of that name; all->count: there is none, or several. */
static size_t find_only(const netlist *all, vs_word name) {
  const subcircuit wanted = {.name = name}, *end = all->sorted + all->count;
  const subcircuit *found = bsearch(&wanted, all->sorted, all->count, sizeof wanted, compare_names);
  if (!found || (found > all->sorted && !compare_names(found - 1, found)) ||
      (found + 1 < end && !compare_names(found + 1, found)))
    return all->count;
  return found->number;
}

/* Goes to the next subcircuit that this one has an instance of, past those that it defines. */
static size_t next_instance(const void *ctx, vs_circle_step *at) {
  const netlist *all = ctx;
  const subcircuit *of = &all->list[at->thing];
  size_t inner = at->thing + 1; /* the next subcircuit by lines */
  for (size_t k = at->name.n ? at->line + 1 : of->begin + 1; k < of->end; k++) {
    while (inner < all->count && all->list[inner].begin < k) inner++;
    if (inner < all->count && all->list[inner].begin == k) {
      k = all->list[inner].end;
      continue;
    }
    const size_t to = all->called[k].n ? find_only(all, all->called[k]) : all->count;
    if (to == all->count) continue;
    at->line = k;
    at->name = all->called[k];
    return to;
  }
  return all->count;
}

static const char *verb(const void *ctx, size_t thing, vs_word *name) {
  *name = ((const netlist *)ctx)->list[thing].name;
  return "calls";
}

vs_status vs_nesting_check(const vs_line *lines, const vs_word *called, size_t count,
                           vs_error *err) {
  netlist all = {.lines = lines, .called = called};
  find_subcircuits(&all, count);
  vs_circle_step *path = vs_alloc(all.count + 1, sizeof *path);
  const size_t length = vs_circle_find(all.count, next_instance, &all, path, NULL);
  if (length) {
    const vs_word name = all.list[path[0].thing].name;
    vs_text text = {0};
    vs_circle_tell(path, length, verb, &all, &text);
    vs_fail_at(err, lines[path[0].line].where,
               "subcircuit %.*s%s; an instance of another one is wanted here", (int)name.n, name.at,
               text.text);
    vs_text_free(&text);
  }
  free(path);
  free(all.list);
  free(all.sorted);
  return length ? VS_INPUT : VS_OK;
}
