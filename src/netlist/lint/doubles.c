/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/doubles.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "netlist/words.h"

enum { MOST_OPEN = 64 /* deeper ones are left alone */ };

typedef struct definition {
  size_t scope; /* 0: outside of all subcircuits; else 1 + the line of the subcircuit it is in */
  size_t line;
  vs_word name;
  bool model;
} definition;

static vs_word second_word(const char *text) {
  vs_word w[VS_WORDS_MOST];
  return vs_words_split(text, w) > 1 ? w[1] : (vs_word){text, 0};
}

static int compare_doubles(const void *a, const void *b) {
  const definition *x = a, *y = b;
  if (x->model != y->model) return x->model - y->model;
  if (x->scope != y->scope) return x->scope < y->scope ? -1 : 1;
  int order = vs_words_compare(x->name, y->name);
  return order ? order : (x->line > y->line) - (x->line < y->line);
}

static bool is_same_definition(const definition *a, const definition *b) {
  return a->model == b->model && a->scope == b->scope && !vs_words_compare(a->name, b->name);
}

/* True where both lines say the same, but for capitals and for what ngspice takes for blanks. The
 * name behind an .ends says nothing. */
static bool is_alike(const char *a, const char *b) {
  static const char BLANKS[] = " \t,=()";
  if (vs_words_begin(a, ".ends") && vs_words_begin(b, ".ends")) return true;
  for (;; a++, b++) {
    const size_t blanks = strspn(a, BLANKS), others = strspn(b, BLANKS);
    if ((blanks > 0) != (others > 0)) return !a[blanks] && !b[others]; /* at the end of one */
    a += blanks;
    b += others;
    if (tolower((unsigned char)*a) != tolower((unsigned char)*b)) return false;
    if (!*a) return true;
  }
}

/* True where both definitions say the same: a model one line, a subcircuit all up to its .ends. */
static bool say_the_same(const vs_line *lines, size_t count, const definition *a,
                         const definition *b) {
  int depth = 0;
  for (size_t k = 0; b->line + k < count; k++) {
    const char *text = lines[a->line + k].text;
    if (!is_alike(text, lines[b->line + k].text)) return false;
    depth += vs_words_begin(text, ".subckt") - vs_words_begin(text, ".ends");
    if (depth <= 0) break;
  }
  return true;
}

static void tell_second(const vs_line *lines, const definition *first, const definition *second,
                        vs_doubles_tell *tell, void *ctx) {
  char text[400];
  const vs_where at = lines[first->line].where;
  const bool other = at.file != lines[second->line].where.file, apart = other && !first->scope;
  const char *file = other ? at.file : "", *comma = other ? ", " : "";
  const char *what = second->model ? ".model" : ".subckt";
  const int n = second->name.n < 64 ? (int)second->name.n : 64;
  snprintf(text, sizeof text,
           apart ? "a second %s %.*s, which says other things than the first, of %.200s%sline %d: "
                   "ngspice would take the first for both; give one another name"
                 : "a second %s %.*s: ngspice takes the first, of %.200s%sline %d; leave one out, "
                   "or give it another name",
           what, n, second->name.at, file, comma, at.line);
  tell(ctx, lines[second->line].where, apart, text);
}

/* Tells of an .ends that has a name of its own. The names are those of the files, as the program
 * may have changed that of the subcircuit. */
static void check_end(const vs_line *subcircuit, const vs_line *end, vs_doubles_tell *tell,
                      void *ctx) {
  const char *opens = subcircuit->written ? subcircuit->written : subcircuit->text;
  const char *closes = end->written ? end->written : end->text;
  const vs_word name = second_word(opens), said = second_word(closes);
  char text[256];
  if (!said.n || (said.n == name.n && !strncasecmp(said.at, name.at, name.n))) return;
  snprintf(text, sizeof text,
           "this .ends closes subcircuit %.*s of line %d, and not %.*s; is an .ends missing before "
           "it, or the name another?",
           name.n < 64 ? (int)name.n : 64, name.at, subcircuit->where.line,
           said.n < 64 ? (int)said.n : 64, said.at);
  tell(ctx, vs_line_place(end, said.at), false, text);
}

void vs_doubles_look(const vs_line *lines, size_t count, vs_doubles_tell *tell, void *ctx) {
  definition *list = NULL;
  size_t n = 0, depth = 0, conditions = 0, open[MOST_OPEN];
  for (size_t k = 0; k < count; k++) {
    const char *text = lines[k].text;
    if (*text != '.') continue;
    conditions += vs_words_begin(text, ".if");
    conditions -= conditions > 0 && vs_words_begin(text, ".endif");
    const bool model = vs_words_begin(text, ".model"), begins = vs_words_begin(text, ".subckt");
    if (vs_words_begin(text, ".ends") && depth > 0 && --depth < MOST_OPEN)
      check_end(&lines[open[depth]], &lines[k], tell, ctx);
    if ((model || begins) && !conditions && depth < MOST_OPEN) {
      list = vs_alloc_grow(list, n, sizeof *list);
      list[n++] = (definition){depth ? 1 + open[depth - 1] : 0, k, second_word(text), model};
    }
    if (begins && depth++ < MOST_OPEN) open[depth - 1] = k;
  }
  if (n) qsort(list, n, sizeof *list, compare_doubles);
  for (size_t k = 1, first = 0; k < n; k++)
    if (!is_same_definition(&list[first], &list[k]))
      first = k;
    else if (!say_the_same(lines, count, &list[first], &list[k]))
      tell_second(lines, &list[first], &list[k], tell, ctx);
  free(list);
}
