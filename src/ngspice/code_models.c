/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "code_models.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "netlist/words.h"

/* What turns a line E, F, G or H, or one that continues it, into a code model. */
static bool has_form(const char *line) {
  static const char *const FORMS[] = {"poly", "table", "laplace", "freq", "and(", "or("};
  bool found = false;
  for (size_t k = 0; k < sizeof FORMS / sizeof *FORMS && !found; k++)
    found = strcasestr(line, FORMS[k]);
  return found;
}

/* A polynomial need not be called one: ngspice knows it by the number of words, too. What an
 * .include brings is not seen here. */
static bool may_need(const char *line) {
  vs_word w[VS_WORDS_MOST];
  size_t count = vs_words_split(line, w);
  if (count == 0) return false;
  switch (tolower((unsigned char)*w[0].at)) {
  case 'a':
  case 'n':
  case 'u':
    return true;
  case 'e':
  case 'g':
    return count != 6 || strchr(line, '=') || has_form(line);
  case 'f':
  case 'h':
    return count != 5 || strchr(line, '=') || has_form(line);
  case '+':
    return has_form(line);
  case '.':
    return !strncasecmp(w[0].at, ".inc", 4) || !strncasecmp(w[0].at, ".lib", 4);
  default:
    return false;
  }
}

bool vs_code_models_needed(char *const *netlist, size_t lines, const char *dialect) {
  bool needed = *dialect;
  for (size_t k = 1; k < lines && !needed; k++) needed = may_need(netlist[k]);
  return needed;
}
