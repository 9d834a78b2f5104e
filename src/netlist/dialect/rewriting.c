/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dialect/rewriting.h"

#include <string.h>
#include <strings.h>

void vs_rewriting_replace(vs_rewriting *r, size_t offset, size_t n, const char *by) {
  vs_text changed = {0};
  vs_text_add(&changed, "%.*s%s%s", (int)offset, r->text.text, by, r->text.text + offset + n);
  vs_text_free(&r->text);
  r->text = changed;
}

void vs_rewriting_brace(vs_rewriting *r, size_t offset, size_t n) {
  vs_text by = {0};
  bool quoted = false;
  vs_text_add(&by, "{");
  for (const char *s = r->text.text + offset; n > 0; s++, n--) {
    quoted ^= *s == '\'';
    vs_text_add(&by, "%c",
                *s == '{' || (*s == '\'' && quoted) ? '('
                : *s == '}' || *s == '\''           ? ')'
                                                    : *s);
  }
  const size_t length = by.length - 1; /* as many as there were */
  vs_text_add(&by, "}");
  vs_rewriting_replace(r, offset, length, by.text);
  vs_text_free(&by);
}

void vs_rewriting_tell(vs_rewriting *r, const char *what) {
  vs_tally_add(r->tally, what, r->line->where);
}

vs_where vs_rewriting_place(const vs_rewriting *r, const char *at, size_t n) {
  const char *file = r->line->text;
  size_t offset = (size_t)(at - r->text.text);
  if (offset + n <= strlen(file) && !strncasecmp(file + offset, at, n))
    return vs_line_place(r->line, file + offset);
  for (const char *s = file; *s; s++)
    if (!strncasecmp(s, at, n)) return vs_line_place(r->line, s);
  return r->line->where;
}

void vs_rewriting_free(vs_rewriting *r) {
  vs_text_free(&r->text);
  vs_text_free(&r->more);
}
