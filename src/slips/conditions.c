/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "slips/conditions.h"

#include "dialect/words.h"

vs_status vs_conditions_check(const vs_line *lines, size_t count, vs_error *err) {
  static const char *const WITHIN[] = {".else", ".elseif", ".endif"};
  size_t depth = 0;
  vs_where outermost = {0};
  for (size_t k = 0; k < count; k++) {
    const char *text = lines[k].text;
    if (*text != '.') continue;
    for (size_t w = 0; depth == 0 && w < sizeof WITHIN / sizeof *WITHIN; w++)
      if (vs_words_is(vs_words_at(text), WITHIN[w]))
        return vs_fail_at(err, lines[k].where,
                          "%s stands here without an .if before it; write one, or leave this line "
                          "out",
                          WITHIN[w]);
    if (vs_words_is(vs_words_at(text), ".if") && depth++ == 0) outermost = lines[k].where;
    if (vs_words_is(vs_words_at(text), ".endif")) depth--;
  }
  return depth ? vs_fail_at(err, outermost,
                            "this .if has no .endif that closes it; write one behind its last line")
               : VS_OK;
}
