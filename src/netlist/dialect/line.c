/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/line.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"

void vs_line_join(vs_line *l, const char *text, vs_where where) {
  size_t n = strlen(text), begin = l->text ? l->length + 1 : 0;
  if (begin + n + 1 > l->room) {
    l->room = 2 * (begin + n + 1);
    l->text = vs_resize(l->text, l->room, 1);
  }
  if (begin)
    l->text[l->length] = ' ';
  else
    l->where = where;
  memcpy(l->text + begin, text, n + 1);
  l->length = begin + n;
  l->joint = vs_alloc_grow(l->joint, l->n_joints, sizeof *l->joint);
  l->joint[l->n_joints++] = (vs_joint){begin, where};
}

void vs_line_change(vs_line *l, char *text) {
  if (l->written)
    free(l->text);
  else
    l->written = l->text;
  l->text = text;
}

vs_where vs_line_place(const vs_line *l, const char *at) {
  const char *text = l->written ? l->written : l->text;
  size_t offset = (size_t)(at - text), k = l->n_joints;
  while (k > 1 && l->joint[k - 1].at > offset) k--;
  if (k == 0) return l->where;
  vs_where where = l->joint[k - 1].where;
  where.column += vs_text_column(text + l->joint[k - 1].at, at) - 1;
  return where;
}

vs_where vs_line_place_of(const vs_line *l, vs_word word) {
  if (!l->written) return vs_line_place(l, word.at);
  /* of the words that are alike in the file, the one that is as many of them into the line */
  const char *at = NULL, *from = l->written;
  for (const char *s = l->text; (s = vs_words_find(l->text, s, word.at, word.n)) && s <= word.at;
       s += word.n) {
    const char *next = vs_words_find(l->written, from, word.at, word.n);
    if (!next) break;
    at = next;
    from = at + word.n;
  }
  return at ? vs_line_place(l, at) : l->where;
}

void vs_line_free(vs_line *l) {
  free(l->text);
  free(l->written);
  free(l->joint);
  *l = (vs_line){0};
}
