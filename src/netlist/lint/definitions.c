/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/definitions.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "lint/parameters.h"

static const char BLANKS[] = " \t";

/* ---- reading ---- */

static size_t length_of_name(const char *s) {
  size_t n = 0;
  if (!isalpha((unsigned char)*s) && *s != '_') return 0;
  while (vs_words_goes_on(s[n])) n++;
  return n;
}

static void add_definition(vs_definitions *d, vs_definition definition) {
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

static void read_parameters(vs_definitions *d, const vs_line *line, const char *s) {
  vs_word name, next = {0};
  const char *value = vs_parameters_next(line->text, s, &name.at, &name.n), *behind;
  for (; value; name = next, value = behind) {
    behind = vs_parameters_next(line->text, value, &next.at, &next.n);
    const vs_word body = {value, behind ? (size_t)(next.at - value) : strlen(value)};
    if (name.n && length_of_name(name.at) == name.n)
      add_definition(d, (vs_definition){.line = line, .name = name, .body = body});
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
    add_definition(d, f);
  else if (parameters && scope == 0)
    read_parameters(d, line, s);
}

/* ---- finding ---- */

static int compare_definitions(const vs_definition *a, const vs_definition *b) {
  int order = vs_words_compare(a->name, b->name);
  if (!order) order = (a->function > b->function) - (a->function < b->function);
  return order ? order : (a->scope > b->scope) - (a->scope < b->scope);
}

static int compare_entries(const void *a, const void *b) {
  const vs_definition *x = *(const vs_definition *const *)a, *y = *(const vs_definition *const *)b;
  int order = compare_definitions(x, y);
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
    if (compare_definitions(d->sorted[middle], wanted) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  for (; low + n < d->count && n < 2 && !compare_definitions(d->sorted[low + n], wanted); n++)
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
    if (!vs_words_compare(argument, name)) return k;
  return -1;
}

size_t vs_definitions_arguments(const vs_definition *function) {
  const char *s = function->arguments.at;
  size_t count = 0;
  while (next_argument(function, &s).n) count++;
  return count;
}
