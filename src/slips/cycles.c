/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "slips/cycles.h"

#include <stdlib.h>

#include "base/text.h"

/* A definition that is being looked at, and the name in it that led to the next one. */
typedef struct step {
  const vs_definition *definition;
  vs_word name;
} step;

enum { NEW, OPEN, DONE }; /* what is known of a definition: OPEN ones are on the path */

/* Goes to the next definition that this one names, behind the last. NULL: there is none left. */
static const vs_definition *next(const vs_definitions *d, step *at) {
  const vs_definition *of = at->definition;
  const char *end = of->body.at + of->body.n;
  vs_mention mention;
  for (const char *s = at->name.at + at->name.n; vs_definitions_mention(s, end, &mention);
       s = mention.name.at + mention.name.n) {
    if (of->function && vs_definitions_argument(of, mention.name) >= 0) continue;
    const vs_definition *found = vs_definitions_get(d, mention, of->scope);
    if (!found) continue;
    at->name = mention.name;
    return found;
  }
  return NULL;
}

/* Tells of a circle of `count` steps, beginning with that which stands first in the netlist. */
static vs_status refuse(const step *circle, size_t count, vs_error *err) {
  enum { SHOWN = 5 };
  size_t first = 0;
  for (size_t k = 1; k < count; k++)
    if (circle[k].definition < circle[first].definition) first = k;
  const step *at = &circle[first];
  vs_text path = {0};
  for (size_t k = 1; k <= count; k++) {
    const vs_definition *to = circle[(first + k) % count].definition;
    if (k == SHOWN) vs_text_add(&path, ", and so on");
    if (k >= SHOWN && k < count) continue;
    vs_text_add(&path, "%s %s ", k > 1 ? ", which" : "", to->function ? "calls" : "needs");
    if (count == 1)
      vs_text_add(&path, "itself");
    else
      vs_text_add(&path, "%.*s", (int)to->name.n, to->name.at);
  }
  vs_fail_at(err, vs_definitions_place(at->definition->line, at->name), "%s %.*s%s; %s",
             at->definition->function ? "function" : "parameter", (int)at->definition->name.n,
             at->definition->name.at, path.text,
             at->definition->function ? "a formula is wanted that does without"
                                      : "a value is wanted that does without");
  vs_text_free(&path);
  return VS_INPUT;
}

vs_status vs_cycles_check(const vs_definitions *d, vs_error *err) {
  unsigned char *known = vs_alloc(d->count + 1, sizeof *known);
  step *path = vs_alloc(d->count + 1, sizeof *path);
  vs_status status = VS_OK;
  for (size_t k = 0; k < d->count && !status; k++) {
    size_t depth = 0;
    if (known[k] != NEW) continue;
    known[k] = OPEN;
    path[depth++] = (step){&d->list[k], {d->list[k].body.at, 0}};
    while (depth && !status) {
      const vs_definition *to = next(d, &path[depth - 1]);
      if (!to) {
        known[path[--depth].definition - d->list] = DONE;
      } else if (known[to - d->list] == OPEN) {
        size_t from = depth - 1;
        while (path[from].definition != to) from--;
        status = refuse(path + from, depth - from, err);
      } else if (known[to - d->list] == NEW) {
        known[to - d->list] = OPEN;
        path[depth++] = (step){to, {to->body.at, 0}};
      }
    }
  }
  free(path);
  free(known);
  return status;
}
