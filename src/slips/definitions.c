/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "slips/definitions.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"

static const char BLANKS[] = " \t";

/* ---- reading ---- */

static size_t length_of_name(const char *s) {
  size_t n = 0;
  if (!isalpha((unsigned char)*s) && *s != '_') return 0;
  while (vs_words_goes_on(s[n])) n++;
  return n;
}

static void add(vs_definitions *d, vs_definition definition) {
  d->list = vs_alloc_grow(d->list, d->count, sizeof *d->list);
  d->list[d->count++] = definition;
}

/* Reads "NAME(ARGUMENTS) BODY". False: it is none. */
static bool read_function(const char *s, vs_definition *f) {
  const char *end = s + strlen(s);
  f->function = true;
  f->name = (vs_word){s, length_of_name(s)};
  s += f->name.n;
  s += strspn(s, BLANKS);
  const char *closing = *s == '(' ? strchr(s, ')') : NULL;
  if (!f->name.n || !closing) return false;
  f->arguments = (vs_word){s + 1, (size_t)(closing - s - 1)};
  f->body = (vs_word){closing + 1, (size_t)(end - closing - 1)};
  return true;
}

/* Where the next "NAME =" begins at or behind s, outside of brackets and quotes; NULL: there is
 * none. */
static const char *next_assignment(const char *s, vs_word *name, const char **value) {
  int depth = 0;
  for (; *s; s++) {
    if (*s == '\'' || *s == '"') {
      s = strchr(s + 1, *s);
      if (!s) return NULL;
    }
    depth += (*s == '{' || *s == '(') - (*s == '}' || *s == ')');
    const size_t n = depth ? 0 : length_of_name(s);
    if (n && vs_words_is_given(s + n)) {
      *name = (vs_word){s, n};
      *value = s + n + strspn(s + n, BLANKS) + 1;
      return s;
    }
    if (!depth && vs_words_goes_on(*s))
      while (vs_words_goes_on(s[1])) s++;
  }
  return NULL;
}

static void read_parameters(vs_definitions *d, const vs_line *line, const char *s) {
  vs_definition p = {.line = line};
  const char *value = NULL, *next_value = NULL;
  vs_word name = {NULL, 0};
  for (s = next_assignment(s, &p.name, &value); s; p.name = name, value = next_value) {
    s = next_assignment(value, &name, &next_value);
    p.body = (vs_word){value, s ? (size_t)(s - value) : strlen(value)};
    add(d, p);
  }
}

/* Reads a line ".func ..." or ".param ...", which may define a function, too. */
static void read_line(vs_definitions *d, const vs_line *line, size_t scope) {
  const bool parameters = vs_words_begin(line->text, ".param");
  if (!parameters && !vs_words_begin(line->text, ".func")) return;
  const char *s = line->text + strcspn(line->text, BLANKS);
  s += strspn(s, BLANKS);
  vs_definition f = {.line = line, .scope = scope};
  if (read_function(s, &f))
    add(d, f);
  else if (parameters && scope == 0)
    read_parameters(d, line, s);
}

/* ---- finding ---- */

static int compare_words(vs_word a, vs_word b) {
  int order = strncasecmp(a.at, b.at, a.n < b.n ? a.n : b.n);
  return order ? order : (a.n > b.n) - (a.n < b.n);
}

static int compare(const vs_definition *a, const vs_definition *b) {
  int order = compare_words(a->name, b->name);
  if (!order) order = (a->function > b->function) - (a->function < b->function);
  return order ? order : (a->scope > b->scope) - (a->scope < b->scope);
}

static int compare_entries(const void *a, const void *b) {
  const vs_definition *x = *(const vs_definition *const *)a, *y = *(const vs_definition *const *)b;
  int order = compare(x, y);
  return order ? order : (x > y) - (x < y);
}

void vs_definitions_find(vs_definitions *d, const vs_line *lines, size_t count) {
  size_t scope = 0;
  *d = (vs_definitions){.scopes = 1, .outer = vs_alloc(1, sizeof *d->outer)};
  for (size_t k = 0; k < count; k++) {
    const char *text = lines[k].text;
    if (*text != '.') continue;
    if (vs_words_begin(text, ".subckt")) {
      d->outer = vs_alloc_grow(d->outer, d->scopes, sizeof *d->outer);
      d->outer[d->scopes] = scope;
      scope = d->scopes++;
    } else if (vs_words_begin(text, ".ends"))
      scope = d->outer[scope];
    else
      read_line(d, &lines[k], scope);
  }
  d->sorted = vs_alloc(d->count + 1, sizeof *d->sorted);
  for (size_t k = 0; k < d->count; k++) d->sorted[k] = &d->list[k];
  qsort(d->sorted, d->count, sizeof *d->sorted, compare_entries);
}

void vs_definitions_free(vs_definitions *d) {
  free(d->list);
  free(d->sorted);
  free(d->outer);
  *d = (vs_definitions){0};
}

/* How many definitions are like `wanted`, of which *first is one. */
static size_t find_like(const vs_definitions *d, const vs_definition *wanted,
                        const vs_definition **first) {
  size_t low = 0, high = d->count, n = 0;
  while (low < high) {
    const size_t middle = (low + high) / 2;
    if (compare(d->sorted[middle], wanted) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  for (; low + n < d->count && n < 2 && !compare(d->sorted[low + n], wanted); n++)
    *first = d->sorted[low];
  return n;
}

const vs_definition *vs_definitions_get(const vs_definitions *d, vs_mention mention, size_t scope) {
  vs_definition wanted = {.name = mention.name, .function = mention.call};
  const vs_definition *found = NULL;
  for (wanted.scope = mention.call ? scope : 0;; wanted.scope = d->outer[wanted.scope]) {
    const size_t n = find_like(d, &wanted, &found);
    if (n) return n == 1 ? found : NULL;
    if (wanted.scope == 0) return NULL;
  }
}

bool vs_definitions_mention(const char *from, const char *end, vs_mention *found) {
  for (const char *s = from; s < end; s++) {
    size_t n = length_of_name(s);
    if (n) {
      const char *after = s + n + strspn(s + n, BLANKS);
      *found = (vs_mention){{s, n}, *after == '('};
      return true;
    }
    if (*s == '"') { /* a text */
      const char *closing = strchr(s + 1, '"');
      if (!closing || closing >= end) return false;
      s = closing;
    }
    if (isdigit((unsigned char)*s)) /* a number, whose unit is no name */
      while (vs_words_goes_on(s[1])) s++;
  }
  return false;
}

/* The name of the next argument at or behind s, which moves behind it; no bytes: none is left. */
static vs_word next_argument(const vs_definition *function, const char **s) {
  const char *end = function->arguments.at + function->arguments.n;
  for (; *s < end; ++*s) {
    const vs_word name = {*s, length_of_name(*s)};
    *s += name.n;
    if (name.n) return name;
  }
  return (vs_word){end, 0};
}

int vs_definitions_argument(const vs_definition *function, vs_word name) {
  const char *s = function->arguments.at;
  vs_word argument;
  for (int k = 0; (argument = next_argument(function, &s)).n; k++)
    if (!compare_words(argument, name)) return k;
  return -1;
}

size_t vs_definitions_arguments(const vs_definition *function) {
  const char *s = function->arguments.at;
  size_t count = 0;
  while (next_argument(function, &s).n) count++;
  return count;
}

vs_where vs_definitions_place(const vs_line *line, vs_word name) {
  if (!line->written) return vs_line_place(line, name.at);
  const char *s = line->written + strcspn(line->written, BLANKS), *at = NULL;
  /* the one that is as many of its name into the line */
  for (const char *in = line->text + strcspn(line->text, BLANKS); in && in <= name.at;
       in += name.n) {
    in = vs_words_find(line->text, in, name.at, name.n);
    if (!in || in > name.at) break;
    const char *next = vs_words_find(line->written, at ? at + name.n : s, name.at, name.n);
    if (next) at = next;
  }
  return at ? vs_line_place(line, at) : line->where;
}
