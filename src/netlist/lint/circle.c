/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/circle.h"

#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

enum { NEW, OPEN, DONE }; /* what is known of a thing: OPEN ones are on the path */

/* Goes from a thing to all that it needs. Returns the length of the path if that ends where it has
 * been before, at path[*from]; 0: it does not. */
static size_t walk(size_t thing, size_t count, vs_circle_next *next, const void *ctx,
                   unsigned char *known, vs_circle_step *path, size_t *from, size_t **order) {
  size_t depth = 1;
  path[0] = (vs_circle_step){.thing = thing};
  known[thing] = OPEN;
  while (depth) {
    const size_t to = next(ctx, &path[depth - 1]);
    if (to == count) {
      known[path[--depth].thing] = DONE;
      if (*order) *(*order)++ = path[depth].thing;
    } else if (known[to] == OPEN) {
      for (*from = 0; path[*from].thing != to;) ++*from;
      return depth;
    } else if (known[to] == NEW) {
      known[to] = OPEN;
      path[depth++] = (vs_circle_step){.thing = to};
    }
  }
  return 0;
}

size_t vs_circle_find(size_t count, vs_circle_next *next, const void *ctx, vs_circle_step *path,
                      size_t *order) {
  unsigned char *known = vs_alloc(count + 1, sizeof *known);
  size_t length = 0, from = 0, least;
  for (size_t k = 0; k < count && !length; k++)
    if (known[k] == NEW) length = walk(k, count, next, ctx, known, path, &from, &order);
  free(known);
  least = from;
  for (size_t k = from; k < length; k++)
    if (path[k].thing < path[least].thing) least = k;
  vs_circle_step *turned = vs_alloc(count + 1, sizeof *turned);
  for (size_t k = least; k < length; k++) turned[k - least] = path[k];
  for (size_t k = from; k < least; k++) turned[length - least + k - from] = path[k];
  memcpy(path, turned, (length - from) * sizeof *path);
  free(turned);
  return length - from;
}

void vs_circle_tell(const vs_circle_step *path, size_t count, vs_circle_verb *verb, const void *ctx,
                    vs_text *text) {
  enum { SHOWN = 5 };
  for (size_t k = 1; k <= count; k++) {
    vs_word name;
    const char *does = verb(ctx, path[k % count].thing, &name);
    if (k == SHOWN) vs_text_add(text, ", and so on");
    if (k >= SHOWN && k < count) continue;
    vs_text_add(text, "%s %s ", k > 1 ? ", which" : "", does);
    if (count == 1)
      vs_text_add(text, "itself");
    else
      vs_text_add(text, "%.*s", (int)name.n, name.at);
  }
}
