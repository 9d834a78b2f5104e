/* SPDX-License-Identifier: GPL-3.0-or-later
 * A hash table from names to numbers, so that reading a file of many thousand names takes a time
 * proportional to its size. Capitals make no difference. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct vs_name_slot {
  char *name; /* owned; NULL: nothing stands here */
  size_t number;
} vs_name_slot;

/* Begins as {0}; ends with vs_names_free. */
typedef struct vs_names {
  vs_name_slot *slot; /* a table of hashes, at most half of it in use; owned */
  size_t count, room;
} vs_names;

/* Gives the name that these `size` bytes spell this number, which replaces one that it had. The
 * name is copied. */
void vs_names_put(vs_names *names, const char *name, size_t size, size_t number);

/* Finds the number of the name that these `size` bytes spell; number may be NULL. Returns false if
 * there is no such name. */
bool vs_names_find(const vs_names *names, const char *name, size_t size, size_t *number);

void vs_names_free(vs_names *names);
