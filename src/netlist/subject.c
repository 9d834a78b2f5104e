/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "subject.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "message.h"
#include "netlist/words.h"

/* True where the message speaks of the line's element, by one of its ways: "...: r1 a b ...", "...:
 * r1: ...", "... instance r1 ...", "... check node r1#branch". */
static bool is_element_of(const char *line, const char *message) {
  static const char *const BEFORE[] = {": ", "instance ", "check node ", "(instance: x"};
  size_t n = strcspn(line, " \t");
  if (n < 2 || *line == '.' || *line == '+') return false;
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE; k++)
    for (const char *s = message; (s = strstr(s, BEFORE[k]));) {
      s = vs_message_behind_path(s + strlen(BEFORE[k]));
      if (!strncasecmp(s, line, n) && strchr(" :#)", s[n])) return true;
    }
  return false;
}

const char *vs_subject_node(const char *line, const char *message) {
  static const char *const BEFORE[] = {"check node ", "trouble with node \""};
  for (size_t k = 0; k < sizeof BEFORE / sizeof *BEFORE && *line != '.'; k++) {
    const char *s = strstr(message, BEFORE[k]);
    if (!s) continue;
    s += strlen(BEFORE[k]);
    size_t n = strcspn(s, " \"");
    for (size_t dot = 0; dot < n; dot++)
      if (s[dot] == '.') s += dot + 1, n -= dot + 1, dot = 0;
    const char *from = line + strcspn(line, " \t");
    return n ? vs_words_find(line, from, s, n) : NULL;
  }
  return NULL;
}

const char *vs_subject_function(const char *line, const char *message) {
  static const char *const POWERS[] = {"pow", "pwr", "pwrs"};
  const char *name = vs_message_function(message), *found = NULL;
  if (!name || *line == '.') return NULL;
  found = vs_words_find(line, line, name, strcspn(name, " "));
  if (found || !vs_message_is_of_power(message) || !strchr("bBeEgG", *line)) return found;
  found = strstr(line, "**");
  if (!found) found = strchr(line, '^');
  for (size_t k = 0; k < sizeof POWERS / sizeof *POWERS && !found; k++)
    found = vs_words_find(line, line, POWERS[k], strlen(POWERS[k]));
  return found;
}

/* Finds a '=' with nothing behind it, which ngspice takes for an expression of no characters, or of
 * the next bracket. */
static const char *find_no_value(const char *line) {
  for (const char *s = line; (s = strchr(s, '=')); s++)
    if (strchr(")}", s[1 + strspn(s + 1, " \t")])) return s; /* or the end */
  return NULL;
}

const char *vs_subject_find(const char *line, const char *message) {
  size_t n = 0;
  const char *name = vs_message_parameter(message, &n);
  if (name) { /* a parameter stands in an expression, and so behind the first '{', quote or '=' */
    const char *from = *line == '.' ? strpbrk(line, "{'=( ") : strpbrk(line, "{'=");
    from = from ? vs_words_find(line, from, name, n) : NULL;
    while (from && vs_words_is_given(from + n)) from = vs_words_find(line, from + n, name, n);
    return from;
  }
  const char *expression = strstr(message, "xpression err: ");
  if (expression) {
    expression += 15;
    if (strlen(expression) < 2) return find_no_value(line); /* it may stand in any line */
    const char *whole = strcasestr(line, expression);
    while (vs_words_goes_on(expression[n])) n++;
    return whole || n < 2 ? whole : vs_words_find(line, line, expression, n);
  }
  name = vs_message_between(message, " '", '\'', &n);
  const char *word = name ? vs_words_find(line, line, name, n) : NULL;
  if (is_element_of(line, message)) return word ? word : line;
  return strstr(message, "circuit: no such function '") ? word : NULL;
}

bool vs_subject_is_quoted(const char *line, const char *message) {
  const char *at = isalpha((unsigned char)*line) ? strcasestr(message, line) : NULL;
  return at && !vs_words_goes_on(at[strlen(line)]);
}
