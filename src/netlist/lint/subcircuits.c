/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/subcircuits.h"

#include <ctype.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "base/text.h"
#include "lint/parameters.h"
#include "netlist/words.h"

enum { NAME = 64, MOST_NAMES = 64, MOST_OF_A_NAME = 8 };

/* ---- subcircuits ---- */

/* Where the name of the subcircuit begins in its line ".subckt NAME ...". */
static const char *name_in(const char *line) {
  line += strcspn(line, " \t");
  return line + strspn(line, " \t");
}

/* Compares the word at a with that at b. */
static int compare_words(const char *a, const char *b) {
  size_t n = strcspn(a, " \t"), m = strcspn(b, " \t");
  int order = strncasecmp(a, b, n < m ? n : m);
  return order ? order : (n > m) - (n < m);
}

typedef struct entry {
  const char *name;
  size_t line;
} entry;

static int compare_entries(const void *a, const void *b) {
  const entry *x = a, *y = b;
  int order = compare_words(x->name, y->name);
  return order ? order : (x->line > y->line) - (x->line < y->line);
}

void vs_subcircuits_find(vs_subcircuits *s, const vs_line *lines, size_t n_lines) {
  *s = (vs_subcircuits){.lines = lines, .n_lines = n_lines};
  for (size_t k = 0; k < n_lines; k++) s->count += vs_words_begin(lines[k].text, ".subckt");
  entry *list = vs_alloc(s->count + 1, sizeof *list);
  s->first = vs_alloc(s->count + 1, sizeof *s->first);
  for (size_t k = 0, n = 0; k < n_lines; k++)
    if (vs_words_begin(lines[k].text, ".subckt")) list[n++] = (entry){name_in(lines[k].text), k};
  qsort(list, s->count, sizeof *list, compare_entries);
  for (size_t k = 0; k < s->count; k++) s->first[k] = list[k].line;
  free(list);
}

void vs_subcircuits_free(vs_subcircuits *s) {
  free(s->first);
  *s = (vs_subcircuits){0};
}

/* The first of the subcircuits of that name; s->count: there is none. */
static size_t find_first(const vs_subcircuits *s, const char *name) {
  size_t low = 0, high = s->count;
  while (low < high) {
    size_t middle = (low + high) / 2;
    if (compare_words(name_in(s->lines[s->first[middle]].text), name) < 0)
      low = middle + 1;
    else
      high = middle;
  }
  return low < s->count && !compare_words(name_in(s->lines[s->first[low]].text), name) ? low
                                                                                       : s->count;
}

/* ---- parameters ---- */

/* Names that may stand in the place of one that is unknown. */
typedef struct candidates {
  char name[MOST_NAMES][NAME];
  size_t count;
} candidates;

/* True where the line gives that parameter a value; adds those that it has to `known`. */
static bool has_in_line(const char *line, const char *name, size_t n, candidates *known) {
  const char *at;
  size_t length;
  for (const char *s = line; (s = vs_parameters_next(line, s, &at, &length));) {
    if (length == n && !strncasecmp(at, name, n)) return true;
    if (length > 0 && length < NAME && known->count < MOST_NAMES)
      snprintf(known->name[known->count++], NAME, "%.*s", (int)length, at);
  }
  return false;
}

/* The same for a whole subcircuit. A .param below it is one of its parameters to ngspice. */
static bool subcircuit_has(const vs_subcircuits *s, size_t first, const char *name, size_t n,
                           candidates *known) {
  if (has_in_line(s->lines[first].text, name, n, known)) return true;
  size_t depth = 1;
  for (size_t k = first + 1; k < s->n_lines && depth; k++) {
    const char *text = s->lines[k].text;
    if (*text != '.') continue;
    depth += vs_words_begin(text, ".subckt");
    depth -= vs_words_begin(text, ".ends");
    if (vs_words_begin(text, ".param") && has_in_line(text, name, n, known)) return true;
  }
  return false;
}

static vs_status refuse_parameter(const vs_line *line, const char *at, size_t n,
                                  const char *subcircuit, const candidates *known, vs_error *err) {
  char name[NAME];
  const char *list[MOST_NAMES], *nearest;
  vs_text all = {0};
  snprintf(name, sizeof name, "%.*s", (int)n, at);
  for (size_t k = 0; k < known->count; k++) {
    list[k] = known->name[k];
    vs_text_add(&all, "%s%s", k ? ", " : "", list[k]);
  }
  nearest = vs_text_nearest(name, list, known->count);
  vs_fail_at(err, vs_line_place_of(line, (vs_word){at, n}),
             "subcircuit %s has no parameter %s%s%s%s", subcircuit, name,
             nearest        ? "; did you mean '"
             : known->count ? "; it has "
                            : "; it has none: leave it out",
             nearest    ? nearest
             : all.text ? all.text
                        : "",
             nearest ? "'?" : "");
  vs_text_free(&all);
  return VS_INPUT;
}

vs_status vs_subcircuits_check(const vs_subcircuits *s, const vs_line *line, const char *behind,
                               const char *subcircuit, vs_error *err) {
  const char *at;
  size_t n, first = find_first(s, subcircuit), last = first;
  while (last < s->count && last - first <= MOST_OF_A_NAME &&
         !compare_words(name_in(s->lines[s->first[last]].text), subcircuit))
    last++;
  /* Which of several is meant depends on where they stand: any of them will do. */
  if (first == last || last - first > MOST_OF_A_NAME) return VS_OK;
  for (const char *from = behind; (from = vs_parameters_next(line->text, from, &at, &n));) {
    candidates known = {.count = 0};
    bool found = n == 0 || (n == 1 && tolower((unsigned char)*at) == 'm');
    for (size_t k = first; k < last && !found; k++)
      found = subcircuit_has(s, s->first[k], at, n, &known);
    if (!found) return refuse_parameter(line, at, n, subcircuit, &known, err);
  }
  return VS_OK;
}
