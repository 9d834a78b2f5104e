/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/words.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

static const char BLANKS[] = " \t";

bool vs_words_goes_on(char c) {
  return isalnum((unsigned char)c) || c == '_';
}

/* strchr(set, c) for a set of a few characters, which a loop is done with sooner. */
static bool is_of(const char *set, char c) {
  while (*set && *set != c) set++;
  return *set;
}

/* Returns what is behind a word: the first character out of `ends` that stands in no brace, bracket
 * or quote, or the end of the text. */
static const char *behind(const char *s, const char *ends) {
  enum { OPENS = 1, CLOSES, QUOTES };
  static const unsigned char KIND[256] = {
      ['('] = OPENS,  ['{'] = OPENS,  ['['] = OPENS,  [')'] = CLOSES,
      ['}'] = CLOSES, [']'] = CLOSES, ['"'] = QUOTES, ['\''] = QUOTES};
  int depth = 0;
  char quote = '\0';
  for (; *s; s++) {
    unsigned char kind = KIND[(unsigned char)*s];
    if (depth == 0 && !quote && is_of(ends, *s)) break;
    if (quote)
      quote = *s == quote ? '\0' : quote;
    else if (kind == QUOTES)
      quote = *s;
    else if (kind == OPENS)
      depth++;
    else if (kind == CLOSES)
      depth -= depth > 0;
  }
  return s;
}

size_t vs_words_split(const char *text, vs_word words[VS_WORDS_MOST]) {
  size_t count = 0;
  for (const char *s = text + strspn(text, BLANKS); *s && count < VS_WORDS_MOST;) {
    const char *end = behind(s, BLANKS);
    words[count++] = (vs_word){s, (size_t)(end - s)};
    s = end + strspn(end, BLANKS);
  }
  return count;
}

bool vs_words_is(vs_word word, const char *text) {
  return strlen(text) == word.n && !strncasecmp(word.at, text, word.n);
}

vs_word vs_words_of(const char *text) {
  return (vs_word){text, strlen(text)};
}

int vs_words_compare(vs_word a, vs_word b) {
  int order = strncasecmp(a.at, b.at, a.n < b.n ? a.n : b.n);
  return order ? order : (a.n > b.n) - (a.n < b.n);
}

bool vs_words_begin(const char *line, const char *word) {
  size_t n = strlen(word);
  return !strncasecmp(line, word, n) && (!line[n] || strchr(BLANKS, line[n]));
}

const char *vs_words_find(const char *text, const char *from, const char *name, size_t n) {
  for (const char *s = from; *s; s++)
    if (!strncasecmp(s, name, n) && !vs_words_goes_on(s[n]) &&
        (s == text || !vs_words_goes_on(s[-1])))
      return s;
  return NULL;
}

bool vs_words_is_given(const char *end) {
  end += strspn(end, BLANKS);
  return *end == '=' && end[1] != '=';
}

bool vs_words_parameter(const char *from, const char *name, vs_word *whole, vs_word *value) {
  size_t n = strlen(name);
  const int first = tolower((unsigned char)*name);
  for (const char *s = from; *s; s++) {
    if (is_of("({['\"", *s)) { /* passes by what it keeps together */
      s = behind(s, " \t=,");
      if (!*s) return false;
      continue;
    }
    if (tolower((unsigned char)*s) != first) continue;
    bool within = s > from && vs_words_goes_on(s[-1]);
    if (within || strncasecmp(s, name, n) || vs_words_goes_on(s[n])) continue;
    if (!vs_words_is_given(s + n)) continue;
    const char *equals = s + n + strspn(s + n, BLANKS);
    value->at = equals + 1 + strspn(equals + 1, BLANKS);
    const char *end = behind(value->at, BLANKS);
    value->n = (size_t)(end - value->at);
    *whole = (vs_word){s, (size_t)(end - s)};
    return true;
  }
  return false;
}

size_t vs_words_arguments(const char *open, vs_word arguments[VS_WORDS_MOST], const char **end) {
  size_t count = 0;
  for (const char *s = open + 1; count < VS_WORDS_MOST;) {
    s += strspn(s, BLANKS);
    const char *stop = behind(s, ",)");
    if (!*stop) return 0;
    size_t n = (size_t)(stop - s);
    while (n > 0 && strchr(BLANKS, s[n - 1])) n--;
    arguments[count++] = (vs_word){s, n};
    *end = stop + 1;
    if (*stop == ')') return count;
    s = stop + 1;
  }
  return 0;
}

void vs_words_unbrace(char *line) {
  if (tolower((unsigned char)*line) != 'x' && !vs_words_begin(line, ".subckt")) return;
  for (char *s = line; (s = strchr(s, '{')); s++) {
    const char *name = s + 1 + strspn(s + 1, BLANKS), *end = name;
    char *close = strchr(s, '}');
    while (vs_words_goes_on(*end)) end++;
    if (end > name && close && vs_words_is_given(end) && strchr(BLANKS, s[-1])) *s = *close = ' ';
  }
}

/* ---- words of an element ---- */

vs_word vs_words_at(const char *s) {
  return (vs_word){s, strcspn(s, VS_WORDS_BETWEEN)};
}

const char *vs_words_next(const char *s) {
  s += strcspn(s, VS_WORDS_BETWEEN);
  return s + strspn(s, VS_WORDS_BETWEEN);
}

bool vs_words_is_ground(vs_word node) {
  return vs_words_is(node, "0") || vs_words_is(node, "gnd");
}
