/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/outline.h"

vs_status vs_outline_known_keys(const vs_node *map, const char *what, const vs_outline *keys,
                                vs_error *err) {
  enum { MOST = 96 };
  const char *names[MOST];
  size_t n = 0;
  for (const vs_outline *row = keys; row->takes && n < MOST; row++) names[n++] = row->key;
  const vs_section *more = keys[n].section;
  for (size_t k = 0; more && k < more->count && n < MOST; k++) names[n++] = more->fields[k].key;
  return vs_field_known_keys(map, what, names, n, err);
}
