/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/parameters.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"

static const char BLANKS[] = " \t";

const char *vs_parameters_next(const char *line, const char *s, const char **at, size_t *n) {
  int depth = 0;
  for (; *s; s++) {
    if (*s == '\'' || *s == '"') {
      s = strchr(s + 1, *s);
      if (!s) return NULL;
    }
    depth += (*s == '{' || *s == '(') - (*s == '}' || *s == ')');
    if (*s != '=' || depth || s == line || s[1] == '=' || strchr("=<>!", s[-1])) continue;
    const char *end = s, *begin;
    while (end > line && strchr(BLANKS, end[-1])) end--;
    for (begin = end; begin > line && vs_words_goes_on(begin[-1]);) begin--;
    *at = begin;
    *n = (size_t)(end - begin);
    return s + 1;
  }
  return NULL;
}

/* Returns the length of the name at s; 0: none begins there. */
static size_t name_at(const char *s) {
  size_t n = 0;
  if (isdigit((unsigned char)*s)) return 0;
  while (vs_words_goes_on(s[n])) n++;
  return n;
}

/* Finds a name at the line's end behind a value that is a number or stands in braces; *at is empty
 * where there is none. Of other values it is not known where they end. */
static vs_word word_behind(const char *value) {
  vs_word w[VS_WORDS_MOST], none = {value, 0};
  if (vs_words_split(value, w) != 2) return none;
  const char *digit = w[0].at + strspn(w[0].at, "+-.");
  if (!isdigit((unsigned char)*digit) && *w[0].at != '{') return none;
  if (w[0].at[w[0].n - 1] != '}' && !isalnum((unsigned char)w[0].at[w[0].n - 1])) return none;
  return name_at(w[1].at) == w[1].n ? w[1] : none;
}

vs_status vs_parameters_check(const vs_line *line, vs_error *err) {
  const char *at, *last = NULL;
  size_t n;
  if (tolower((unsigned char)*line->text) != 'x') return VS_OK;
  for (const char *s = line->text; (s = vs_parameters_next(line->text, s, &at, &n)); last = s) {
    const char *value = s + strspn(s, BLANKS);
    size_t next = name_at(value);
    if (n > 0 && (!*value || (next && vs_words_is_given(value + next))))
      return vs_fail_at(err, vs_line_place(line, at),
                        "%.*s has no value; write one behind its '=', or leave %.*s out", (int)n,
                        at, (int)n, at);
  }
  vs_word extra = last ? word_behind(last) : (vs_word){0};
  return extra.n ? vs_fail_at(err, vs_line_place(line, extra.at),
                              "ngspice leaves out '%.*s' behind the parameters; write NAME=VALUE, "
                              "or leave it out",
                              (int)extra.n, extra.at)
                 : VS_OK;
}

/* ---- names that are defined ---- */

static int compare_names(const void *a, const void *b) {
  return vs_words_compare(*(const vs_word *)a, *(const vs_word *)b);
}

static void add_name(vs_parameters *p, const char *at, size_t n) {
  p->name = vs_alloc_grow(p->name, p->count, sizeof *p->name);
  p->name[p->count++] = (vs_word){at, n};
}

void vs_parameters_add(vs_parameters *p, const char *name) {
  add_name(p, name, strlen(name));
}

void vs_parameters_find(vs_parameters *p, const vs_line *lines, size_t n_lines) {
  const char *at;
  size_t n;
  for (size_t k = 0; k < n_lines; k++) {
    const char *text = lines[k].text;
    if (!vs_words_begin(text, ".param") && !vs_words_begin(text, ".subckt")) continue;
    for (const char *s = text; (s = vs_parameters_next(text, s, &at, &n));) add_name(p, at, n);
  }
  if (p->count) qsort(p->name, p->count, sizeof *p->name, compare_names);
}

void vs_parameters_free(vs_parameters *p) {
  free(p->name);
  *p = (vs_parameters){0};
}

/* ---- gains ---- */

/* Finds the gain of "E1 a 0 b 0 gain" or "F1 a 0 Vx gain", alone or before "m=", where it is a
 * name; its length is 0 where it is none. */
static vs_word gain_of(const char *line) {
  static const char *const FORMS[] = {"poly", "value", "vol", "cur", "table", "laplace", "freq"};
  const vs_word none = {line, 0};
  const int letter = tolower((unsigned char)*line);
  if (!*line || !strchr("efgh", letter) || strpbrk(line, "{'\"[")) return none;
  const char *s = line;
  for (int before = letter == 'e' || letter == 'g' ? 5 : 4; before > 0; before--) {
    const vs_word word = vs_words_at(s);
    if (!word.n || memchr(s, '=', word.n)) return none;
    for (size_t k = 0; k < sizeof FORMS / sizeof *FORMS; k++)
      if (vs_words_is(word, FORMS[k])) return none;
    s = vs_words_next(s);
  }
  const vs_word gain = {s, name_at(s)};
  s += gain.n;
  s += strspn(s, " \t)");
  if (tolower((unsigned char)*s) == 'm' && vs_words_is_given(s + 1)) return gain;
  return *s ? none : gain;
}

vs_status vs_parameters_check_gain(const vs_parameters *p, const vs_line *line, vs_error *err) {
  const vs_word gain = gain_of(line->text);
  const int n = (int)gain.n;
  if (!n) return VS_OK;
  if (!p->count || !bsearch(&gain, p->name, p->count, sizeof *p->name, compare_names))
    return vs_fail_at(err, vs_line_place_of(line, gain),
                      "ngspice takes the gain %.*s for 0, as no .param defines it; write a number, "
                      "or a line '.param %.*s=...'",
                      n, gain.at, n, gain.at);
  const char *comma = strchr(line->text, ',');
  if (gain.at[-1] != '(' && (!comma || comma > gain.at)) return VS_OK;
  return vs_fail_at(err, vs_line_place_of(line, gain),
                    "ngspice takes the gain %.*s for 0 beside brackets and commas; write {%.*s}", n,
                    gain.at, n, gain.at);
}
