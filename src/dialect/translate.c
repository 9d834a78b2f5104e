/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "dialect/translate.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "dialect/elements.h"
#include "dialect/functions.h"
#include "dialect/models.h"
#include "dialect/numbers.h"
#include "dialect/words.h"

/* Commas between assignments, "a=1, b=2", which ngspice never comes back from, become blanks. */
static void rewrite_commas(vs_rewriting *r) {
  int depth = 0;
  for (char *s = r->text.text; *s; s++) {
    depth += (strchr("({", *s) != NULL) - (strchr(")}", *s) != NULL);
    if (*s != ',' || depth) continue;
    const char *next = s + 1 + strspn(s + 1, " \t");
    if (!isalpha((unsigned char)*next)) continue;
    while (vs_words_goes_on(*next)) next++;
    next += strspn(next, " \t");
    if (*next == '=' && next[1] != '=') *s = ' ';
  }
}

/* SIN(offset amplitude frequency delay damping phase cycles): ngspice takes no notice of cycles. */
static vs_status check_sine(const vs_rewriting *r) {
  const char *sine = strcasestr(r->text.text, "sin"), *open = sine ? strchr(sine, '(') : NULL;
  vs_word w[VS_WORDS_MOST];
  if (!strchr("vViI", *r->text.text) || !open || sine[-1] > ' ') return VS_OK;
  vs_text inner = {0};
  vs_text_add(&inner, "%.*s", (int)strcspn(open + 1, ")"), open + 1);
  for (char *s = inner.text; *s; s++)
    if (*s == ',') *s = ' ';
  size_t count = vs_words_split(inner.text, w);
  vs_text_free(&inner);
  return count < 7 ? VS_OK
                   : vs_fail_at(r->err, vs_rewriting_place(r, sine, 3),
                                "SIN has six numbers in ngspice; the seventh, LTspice's number of "
                                "cycles, it leaves out: write a B source with u(time)");
}

vs_status vs_translate(vs_rewriting *r) {
  vs_status status = vs_numbers_check(r->line, r->tally, r->err);
  if (status) return status;
  vs_text_add(&r->text, "%s", r->line->text);
  if (!strncasecmp(r->text.text, ".param", 6) || !strncasecmp(r->text.text, ".subckt", 7) ||
      tolower((unsigned char)*r->text.text) == 'x')
    rewrite_commas(r);
  status = check_sine(r);
  if (!status) status = vs_models_rewrite(r);
  if (!status) status = vs_elements_rewrite(r);
  if (!status) status = vs_functions_rewrite(r);
  return status;
}
