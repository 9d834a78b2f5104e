/* SPDX-License-Identifier: GPL-3.0-or-later
 * A cache of a scene's sections. When a scene is read again with some of its keys changed, as for
 * each case of a study, only those keys are parsed anew. */
#pragma once

#include "base/field.h"

enum { VS_SECTION_CACHE_MOST = 8 };

/* One section as it was read last. */
typedef struct vs_cached_section {
  const vs_field *fields; /* which section; NULL: none yet. Borrowed */
  size_t count;           /* of the fields */
  char **word;            /* each key's text; NULL: it was not there; owned */
  bool *known;            /* whether the key's value is the one of that text; owned */
  void *values;           /* the section's struct as it was read; owned */
} vs_cached_section;

/* Start from {0}; to be freed with vs_section_cache_free. */
typedef struct vs_section_cache {
  vs_cached_section section[VS_SECTION_CACHE_MOST];
} vs_section_cache;

void vs_section_cache_free(vs_section_cache *memo);

/* Fills out, a struct of that size, just as vs_field_section_read does. A key that is written as it
 * was the last time, or that is missing again, gets the value that it had then. memo: NULL: there
 * is none. Errors: those of vs_field_section_read. */
vs_status vs_section_cache_read(vs_section_cache *memo, const vs_section *section,
                                const vs_node *map, void *out, size_t size, vs_error *err);

/* Adds all that is written in the node, without its places. Nodes that differ in a key, a text or
 * their order add other bytes. NULL adds a mark. */
void vs_section_cache_key(const vs_node *node, vs_text *out);
