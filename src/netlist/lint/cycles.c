/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/cycles.h"

#include <stdlib.h>

#include "lint/circle.h"

/* Goes to the next definition that this one names. */
static size_t next_named(const void *ctx, vs_circle_step *at) {
  const vs_definitions *d = ctx;
  const vs_definition *of = &d->list[at->thing];
  const char *end = of->body.at + of->body.n;
  vs_mention mention;
  for (const char *s = at->name.n ? at->name.at + at->name.n : of->body.at;
       vs_definitions_mention(s, end, &mention); s = mention.name.at + mention.name.n) {
    if (of->function && vs_definitions_argument(of, mention.name) >= 0) continue;
    const vs_definition *found = vs_definitions_get(d, mention, of->scope);
    if (!found) continue;
    at->name = mention.name;
    return (size_t)(found - d->list);
  }
  return d->count;
}

static const char *verb(const void *ctx, size_t thing, vs_word *name) {
  const vs_definition *to = &((const vs_definitions *)ctx)->list[thing];
  *name = to->name;
  return to->function ? "calls" : "needs";
}

vs_status vs_cycles_check(const vs_definitions *d, vs_error *err) {
  vs_circle_step *path = vs_alloc(d->count + 1, sizeof *path);
  const size_t count = vs_circle_find(d->count, next_named, d, path, NULL);
  if (count) {
    const vs_definition *first = &d->list[path[0].thing];
    vs_text text = {0};
    vs_circle_tell(path, count, verb, d, &text);
    vs_fail_at(err, vs_line_place_of(first->line, path[0].name),
               "%s %.*s%s; a %s is wanted that does without",
               first->function ? "function" : "parameter", (int)first->name.n, first->name.at,
               text.text, first->function ? "formula" : "value");
    vs_text_free(&text);
  }
  free(path);
  return count ? VS_INPUT : VS_OK;
}

vs_status vs_cycles_check_depth(const vs_definitions *d, vs_error *err) {
  size_t *order = vs_alloc(d->count + 1, sizeof *order),
         *depth = vs_alloc(d->count + 1, sizeof *depth);
  vs_status status = VS_OK;
  vs_cycles_order(d, order);
  for (size_t k = 0; k < d->count && !status; k++) {
    const vs_definition *of = &d->list[order[k]];
    const size_t most = of->function ? VS_CYCLES_FUNCTIONS : VS_CYCLES_PARAMETERS;
    vs_circle_step at = {.thing = order[k]};
    size_t deepest = 0; /* of those of its kind that it names */
    for (size_t to; (to = next_named(d, &at)) < d->count;)
      if (d->list[to].function == of->function && depth[to] > deepest) deepest = depth[to];
    depth[order[k]] = deepest + 1;
    if (deepest >= most)
      status = vs_fail_at(
          err, vs_line_place_of(of->line, of->name),
          of->function ? "function %.*s calls others, which call others, and so on more than "
                         "%zu deep; a formula with fewer calls within each other is wanted"
                       : "parameter %.*s needs others, which need others, and so on more "
                         "than %zu deep; a value that needs fewer is wanted",
          (int)of->name.n, of->name.at, most);
  }
  free(depth);
  free(order);
  return status;
}

void vs_cycles_order(const vs_definitions *d, size_t *order) {
  vs_circle_step *path = vs_alloc(d->count + 1, sizeof *path);
  vs_circle_find(d->count, next_named, d, path, order);
  free(path);
}
