/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/names.h"

#include <stdint.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"

/* FNV-1a (Fowler, Noll, Vo), of the lower case of ASCII as strncasecmp has it. */
static uint64_t hash_of(const char *name, size_t size) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (size_t k = 0; k < size; k++) {
    unsigned char c = (unsigned char)name[k];
    hash = (hash ^ (c >= 'A' && c <= 'Z' ? c + 32u : c)) * 0x100000001b3u;
  }
  return hash;
}

/* Where the name stands, or where it would. There is room for one more. */
static vs_name_slot *slot_of(const vs_names *n, const char *name, size_t size) {
  for (size_t k = (size_t)(hash_of(name, size) % n->room);; k = (k + 1) % n->room) {
    vs_name_slot *slot = &n->slot[k];
    if (!slot->name || (!strncasecmp(slot->name, name, size) && !slot->name[size])) return slot;
  }
}

static void grow(vs_names *n) {
  vs_names more = {.room = n->room ? 2 * n->room : 16, .count = n->count};
  more.slot = vs_alloc(more.room, sizeof *more.slot);
  for (size_t k = 0; k < n->room; k++)
    if (n->slot[k].name) *slot_of(&more, n->slot[k].name, strlen(n->slot[k].name)) = n->slot[k];
  free(n->slot);
  *n = more;
}

void vs_names_put(vs_names *n, const char *name, size_t size, size_t number) {
  if (2 * (n->count + 1) > n->room) grow(n);
  vs_name_slot *slot = slot_of(n, name, size);
  if (!slot->name) {
    slot->name = vs_alloc_part(name, size);
    n->count++;
  }
  slot->number = number;
}

bool vs_names_find(const vs_names *n, const char *name, size_t size, size_t *number) {
  const vs_name_slot *slot = n->room ? slot_of(n, name, size) : NULL;
  if (!slot || !slot->name) return false;
  if (number) *number = slot->number;
  return true;
}

void vs_names_free(vs_names *n) {
  for (size_t k = 0; k < n->room; k++) free(n->slot[k].name);
  free(n->slot);
  *n = (vs_names){0};
}
