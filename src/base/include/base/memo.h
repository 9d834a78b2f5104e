/* SPDX-License-Identifier: GPL-3.0-or-later
 * A cache of a scene's sections. When a scene is read again with some of its keys changed, as for
 * each case of a study, only those keys are parsed anew. */
#ifndef VS_BASE_MEMO_H
#define VS_BASE_MEMO_H

#include "base/field.h"

enum { VS_MEMO_SECTIONS = 8 };

/* One section as it was read last. */
typedef struct vs_remembered {
  const vs_field *fields; /* which section; NULL: none yet. Borrowed */
  size_t count;           /* of the fields */
  char **word;            /* each key's text; NULL: it was not there; owned */
  bool *known;            /* whether the key's value is the one of that text; owned */
  void *values;           /* the section's struct as it was read; owned */
} vs_remembered;

/* Start from {0}; to be freed with vs_memo_free. */
typedef struct vs_memo {
  vs_remembered section[VS_MEMO_SECTIONS];
} vs_memo;

void vs_memo_free(vs_memo *memo);

/* Fills out, a struct of that size, just as vs_field_section_read does. A key that is written as it
 * was the last time, or that is missing again, gets the value that it had then. memo: NULL: there
 * is none. Errors: those of vs_field_section_read. */
vs_status vs_memo_read(vs_memo *memo, const vs_section *section, const vs_node *map, void *out,
                       size_t size, vs_error *err);

/* Adds all that is written in the node, without its places. Nodes that differ in a key, a text or
 * their order add other bytes. NULL adds a mark. */
void vs_memo_write(const vs_node *node, vs_text *out);

#endif
