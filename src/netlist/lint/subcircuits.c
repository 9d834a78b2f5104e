/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/subcircuits.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "lint/circle.h"

/* ---- circles ---- */

/* Goes to the next subcircuit that this one has an instance of. */
static size_t next_instance(const void *ctx, vs_circle_step *at) {
  const vs_cards *c = ctx;
  const vs_netlist_scope *of = &c->scope[at->thing];
  size_t k = at->name.n ? at->line + 1 : of->first;
  for (; at->thing && k < of->last; k = vs_cards_next(c, k)) {
    const size_t to = vs_cards_called(c, &c->card[k]);
    if (!to) continue;
    at->line = k;
    at->name = c->card[k].model;
    return to;
  }
  return c->n_scopes;
}

static const char *verb(const void *ctx, size_t thing, vs_word *name) {
  *name = ((const vs_cards *)ctx)->scope[thing].name;
  return "calls";
}

vs_status vs_subcircuits_circles(const vs_cards *c, vs_error *err) {
  vs_circle_step *path = vs_alloc(c->n_scopes + 1, sizeof *path);
  const size_t length = vs_circle_find(c->n_scopes, next_instance, c, path, NULL);
  if (length) {
    const vs_word name = c->scope[path[0].thing].name;
    vs_text text = {0};
    vs_circle_tell(path, length, verb, c, &text);
    vs_fail_at(err, c->lines[path[0].line].where,
               "subcircuit %.*s%s; an instance of another one is wanted here", (int)name.n, name.at,
               text.text);
    vs_text_free(&text);
  }
  free(path);
  return length ? VS_INPUT : VS_OK;
}

/* ---- parameters of instances ---- */

/* Refuses a parameter, and tells of those that the subcircuit has. */
static vs_status refuse_parameter(const vs_cards *c, size_t instance, vs_word given, size_t scope,
                                  vs_error *err) {
  const char **known = vs_alloc(c->n_definitions + 1, sizeof *known);
  size_t count = 0;
  vs_text all = {0};
  for (size_t k = 0; k < c->n_definitions; k++) {
    const vs_netlist_definition *d = &c->definition[k];
    if (d->scope != scope || d->kind != VS_CARDS_PARAM) continue;
    vs_text_add(&all, "%s%.*s", count ? ", " : "; it has ", (int)d->name.n, d->name.at);
    known[count++] = vs_alloc_part(d->name.at, d->name.n);
  }
  char *name = vs_alloc_part(given.at, given.n);
  const char *others = count ? all.text : "; it has none: leave it out";
  const vs_word called = c->card[instance].model, own = c->scope[scope].name;
  const vs_word subcircuit = vs_words_compare(called, own) ? own : called;
  vs_fail_at(err, vs_line_place_of(&c->lines[instance], given),
             "subcircuit %.*s has no parameter %s%s", (int)subcircuit.n, subcircuit.at, name,
             vs_text_hint(name, known, count, others).text);
  for (size_t k = 0; k < count; k++) free((char *)(size_t)known[k]);
  free(known);
  free(name);
  vs_text_free(&all);
  return VS_INPUT;
}

/* Of a subcircuit that is defined twice nothing is said but that: vs_subcircuits_doubles. */
static vs_status check_instance(const vs_cards *c, size_t number, vs_error *err) {
  const vs_netlist_card *card = &c->card[number];
  const size_t scope = card->words < card->count ? vs_cards_called(c, card) : 0;
  const vs_netlist_scope *of = &c->scope[scope];
  if (!scope || vs_cards_find(c, of->outer, VS_CARDS_SUBCKT, of->name)->twin) return VS_OK;
  for (size_t k = card->first; k < card->first + card->count; k++) {
    const vs_word name = c->arguments[k].name;
    if (name.n && !vs_words_is(name, "m") && !vs_cards_find(c, scope, VS_CARDS_PARAM, name))
      return refuse_parameter(c, number, name, scope, err);
  }
  return VS_OK;
}

vs_status vs_subcircuits_parameters(const vs_cards *c, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->count && !status; k++)
    status = vs_error_keep(err, check_instance(c, k, err));
  return status;
}

/* ---- doubles ---- */

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
static bool say_the_same(const vs_cards *c, size_t a, size_t b) {
  const size_t n = vs_cards_next(c, a) - a;
  bool same = vs_cards_next(c, b) - b == n;
  for (size_t k = 0; k < n && same && b + k < c->count; k++)
    same = is_alike(c->lines[a + k].text, c->lines[b + k].text);
  return same;
}

static void tell_second(const vs_cards *c, const vs_netlist_definition *first,
                        const vs_netlist_definition *second, vs_subcircuits_tell *tell, void *ctx) {
  char text[400];
  const vs_where at = c->lines[first->card].where, where = c->lines[second->card].where;
  const bool other = at.file != where.file, apart = other && !first->scope;
  const char *file = other ? at.file : "", *comma = other ? ", " : "";
  const char *what = second->kind == VS_CARDS_MODEL ? ".model" : ".subckt";
  const int n = second->name.n < 64 ? (int)second->name.n : 64;
  snprintf(text, sizeof text,
           apart ? "a second %s %.*s, which says other things than the first, of %.200s%sline %d: "
                   "ngspice would take the first for both; give one another name"
                 : "a second %s %.*s: ngspice takes the first, of %.200s%sline %d; leave one out, "
                   "or give it another name",
           what, n, second->name.at, file, comma, at.line);
  tell(ctx, where, apart, text);
}

/* The second word of a line as the file has it: the program may have changed the name of a
 * subcircuit. */
static vs_word name_in_file(const vs_line *line) {
  vs_word w[VS_WORDS_MOST];
  return vs_words_split(line->written ? line->written : line->text, w) > 1 ? w[1]
                                                                           : (vs_word){"", 0};
}

/* Tells of an .ends that has a name of its own. */
static void check_end(const vs_cards *c, const vs_netlist_scope *scope, vs_subcircuits_tell *tell,
                      void *ctx) {
  const vs_line *subcircuit = &c->lines[scope->first - 1], *end = &c->lines[scope->last];
  const vs_word name = name_in_file(subcircuit), said = name_in_file(end);
  char text[256];
  if (!said.n || !vs_words_compare(said, name)) return;
  snprintf(text, sizeof text,
           "this .ends closes subcircuit %.*s of line %d, and not %.*s; is an .ends missing before "
           "it, or the name another?",
           name.n < 64 ? (int)name.n : 64, name.at, subcircuit->where.line,
           said.n < 64 ? (int)said.n : 64, said.at);
  tell(ctx, vs_line_place(end, said.at), false, text);
}

void vs_subcircuits_doubles(const vs_cards *c, vs_subcircuits_tell *tell, void *ctx) {
  for (size_t k = 0; k < c->count; k++)
    if (c->card[k].kind == VS_CARDS_ENDS && c->card[k].scope)
      check_end(c, &c->scope[c->card[k].scope], tell, ctx);
  for (size_t k = 0; k < c->n_definitions; k++) {
    const vs_netlist_definition *d = &c->definition[k], *first;
    if ((d->kind != VS_CARDS_MODEL && d->kind != VS_CARDS_SUBCKT) || d->twin) continue;
    first = vs_cards_find(c, d->scope, d->kind, d->name);
    if (first == d || c->card[d->card].conditional || c->card[first->card].conditional) continue;
    if (!say_the_same(c, first->card, d->card)) tell_second(c, first, d, tell, ctx);
  }
}
