/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "slips/conditions.h"

#include <stdbool.h>
#include <string.h>
#include <strings.h>

static bool is_statement(const char *text, const char *word) {
  size_t n = strlen(word);
  return !strncasecmp(text, word, n) && (!text[n] || strchr(" \t(),", text[n]));
}

vs_status vs_conditions_check(const vs_line *lines, size_t count, vs_error *err) {
  static const char *const WITHIN[] = {".else", ".elseif", ".endif"};
  size_t depth = 0;
  vs_where outermost = {0};
  for (size_t k = 0; k < count; k++) {
    const char *text = lines[k].text;
    if (*text != '.') continue;
    for (size_t w = 0; depth == 0 && w < sizeof WITHIN / sizeof *WITHIN; w++)
      if (is_statement(text, WITHIN[w]))
        return vs_fail_at(err, lines[k].where,
                          "%s stands here without an .if before it; write one, or leave this line "
                          "out",
                          WITHIN[w]);
    if (is_statement(text, ".if") && depth++ == 0) outermost = lines[k].where;
    if (is_statement(text, ".endif")) depth--;
  }
  return depth ? vs_fail_at(err, outermost,
                            "this .if has no .endif that closes it; write one behind its last line")
               : VS_OK;
}
