/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/definitions.h"

#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "lint/circle.h"
#include "netlist/expr.h"

/* What a definition comes to when it is written out: characters of its own, and how many copies of
 * each argument. */
typedef struct form {
  vs_expr body;     /* empty: it is none that is looked at */
  size_t arguments; /* how many it has */
  double own, *copies;
} form;

/* All definitions, each with its form; those of ctx->of are after ctx->cards->definition. */
typedef struct definitions {
  const vs_cards *cards;
  form *of;
} definitions;

/* ---- names ---- */

/* The number of the function's argument of that name, from 0; `count` gets how many it has. */
static size_t argument_of(const vs_netlist_definition *f, vs_word name, size_t *count) {
  const char *end = f->arguments.at + f->arguments.n;
  size_t found = SIZE_MAX;
  *count = 0;
  for (const char *s = f->arguments.at; s < end;) {
    size_t n = 0;
    while (s + n < end && vs_words_goes_on(s[n])) n++;
    if (n && !vs_words_compare((vs_word){s, n}, name) && found == SIZE_MAX) found = *count;
    *count += n > 0;
    s += n ? n : 1;
  }
  return found;
}

/* What a name of an expression means within a scope: a function, or a parameter outside of all
 * subcircuits. NULL: it is not defined, or more than once where it is found. */
static const vs_netlist_definition *meant_by(const definitions *d, const vs_expr_node *n,
                                             size_t scope) {
  const bool call = n->kind == VS_EXPR_CALL;
  const vs_netlist_definition *to =
      vs_cards_resolve(d->cards, call ? scope : 0, call ? VS_CARDS_FUNC : VS_CARDS_PARAM, n->word);
  return to && !vs_cards_find(d->cards, to->scope, to->kind, to->name)->twin ? to : NULL;
}

static size_t number_of(const definitions *d, const vs_netlist_definition *to) {
  return (size_t)(to - d->cards->definition);
}

/* ---- circles, depth ---- */

/* Goes to the next definition that this one names; the step's line is a node of its tree. */
static size_t next_named(const void *ctx, vs_circle_step *at) {
  const definitions *d = ctx;
  const vs_netlist_definition *of = &d->cards->definition[at->thing], *to;
  const vs_expr *body = &d->of[at->thing].body;
  size_t count;
  while (++at->line < body->count) {
    const vs_expr_node *n = &body->node[at->line];
    if (n->kind != VS_EXPR_NAME && n->kind != VS_EXPR_CALL) continue;
    if (of->kind == VS_CARDS_FUNC && argument_of(of, n->word, &count) < SIZE_MAX) continue;
    if (!(to = meant_by(d, n, of->scope))) continue;
    at->name = n->word;
    return number_of(d, to);
  }
  return d->cards->n_definitions;
}

static const char *verb(const void *ctx, size_t thing, vs_word *name) {
  const vs_netlist_definition *to = &((const definitions *)ctx)->cards->definition[thing];
  *name = to->name;
  return to->kind == VS_CARDS_FUNC ? "calls" : "needs";
}

static vs_status refuse_circle(const definitions *d, const vs_circle_step *path, size_t length,
                               vs_error *err) {
  const vs_netlist_definition *first = &d->cards->definition[path[0].thing];
  const bool function = first->kind == VS_CARDS_FUNC;
  vs_text text = {0};
  vs_circle_tell(path, length, verb, d, &text);
  vs_status status =
      vs_fail_at(err, vs_line_place_of(&d->cards->lines[first->card], path[0].name),
                 "%s %.*s%s; a %s is wanted that does without", function ? "function" : "parameter",
                 (int)first->name.n, first->name.at, text.text, function ? "formula" : "value");
  vs_text_free(&text);
  return status;
}

/* Error: the first definition that is too deep. `order` has all of them, each behind those that it
 * names. */
static vs_status check_depth(const definitions *d, const size_t *order, vs_error *err) {
  const vs_cards *c = d->cards;
  size_t *depth = vs_alloc(c->n_definitions, sizeof *depth);
  vs_status status = VS_OK;
  for (size_t k = 0; k < c->n_definitions && !status; k++) {
    const vs_netlist_definition *of = &c->definition[order[k]];
    const bool function = of->kind == VS_CARDS_FUNC;
    const size_t most = function ? VS_DEFINITIONS_FUNCTIONS : VS_DEFINITIONS_PARAMETERS;
    vs_circle_step at = {.thing = order[k]};
    size_t deepest = 0; /* of those of its kind that it names */
    for (size_t to; (to = next_named(d, &at)) < c->n_definitions;)
      if (c->definition[to].kind == of->kind && depth[to] > deepest) deepest = depth[to];
    depth[order[k]] = deepest + 1;
    if (deepest >= most)
      status = vs_fail_at(
          err, vs_line_place_of(&c->lines[of->card], of->name),
          function ? "function %.*s calls others, which call others, and so on more than "
                     "%zu deep; a formula with fewer calls within each other is wanted"
                   : "parameter %.*s needs others, which need others, and so on more "
                     "than %zu deep; a value that needs fewer is wanted",
          (int)of->name.n, of->name.at, most);
  }
  free(depth);
  return status;
}

/* ---- growth ---- */

/* An expression that is written out. */
typedef struct growing {
  const definitions *d;
  const vs_expr *e;
  const vs_netlist_definition *within; /* the function whose formula it is; NULL: of none */
  size_t scope;
  form *sum;
} growing;

/* Adds `times` the text of a node. */
static void add_growth(const growing *g, size_t node, double times) {
  const vs_expr_node *n = &g->e->node[node];
  size_t count = 0, k = SIZE_MAX;
  const bool name = n->kind == VS_EXPR_NAME, call = n->kind == VS_EXPR_CALL;
  if (g->within && name) k = argument_of(g->within, n->word, &count);
  if (k < SIZE_MAX) {
    g->sum->copies[k] += times;
    return;
  }
  const vs_netlist_definition *to = call ? meant_by(g->d, n, g->scope) : NULL;
  const form *f = to ? &g->d->of[number_of(g->d, to)] : NULL;
  double own = f ? f->own : (double)n->whole.n;
  size_t j = 0;
  for (size_t child = n->child; child; child = g->e->node[child].next, j++) {
    if (!f) own -= (double)g->e->node[child].whole.n;
    if (!f || j < f->arguments) add_growth(g, child, f ? times * f->copies[j] : times);
  }
  g->sum->own += times * own;
}

static vs_status refuse_growth(vs_where where, double characters, vs_error *err) {
  return vs_fail_at(err, where,
                    "with its functions written out, as ngspice needs it, this line has %.3g "
                    "characters, and at most %d are taken; give inner functions sources of their "
                    "own: B1 x 0 V=..., and then v(x)",
                    characters, VS_DEFINITIONS_LONGEST);
}

/* Sizes all functions, each behind those that it calls. */
static vs_status size_functions(const definitions *d, const size_t *order, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; k < d->cards->n_definitions && !status; k++) {
    const vs_netlist_definition *f = &d->cards->definition[order[k]];
    form *sum = &d->of[order[k]];
    if (f->kind != VS_CARDS_FUNC) continue;
    argument_of(f, f->name, &sum->arguments);
    sum->copies = vs_alloc(sum->arguments, sizeof *sum->copies);
    const growing g = {d, &sum->body, f, f->scope, sum};
    add_growth(&g, 0, 1);
    double all = sum->own;
    for (size_t j = 0; j < sum->arguments; j++) all += sum->copies[j];
    if (all > VS_DEFINITIONS_LONGEST)
      status = refuse_growth(d->cards->lines[f->card].where, all, err);
  }
  return status;
}

/* What a text that stands in a scope comes to beyond what it is. */
static double growth_of(const definitions *d, vs_word text, size_t scope) {
  form sum = {0};
  if (!memchr(text.at, '(', text.n)) return 0;
  vs_expr_read(&sum.body, text);
  const growing g = {d, &sum.body, NULL, scope, &sum};
  add_growth(&g, 0, 1);
  vs_expr_free(&sum.body);
  return sum.own - (double)text.n;
}

static vs_status check_lines(const definitions *d, vs_error *err) {
  const vs_cards *c = d->cards;
  for (size_t k = 0; k < c->count; k++) {
    const vs_netlist_card *card = &c->card[k];
    const vs_word text = vs_words_of(c->lines[k].text);
    double more = 0;
    if (card->kind == VS_CARDS_FUNC || (card->kind == VS_CARDS_PARAM && card->name.n)) continue;
    if (card->kind == VS_CARDS_IF || card->kind == VS_CARDS_OTHER)
      more = growth_of(d, text, card->scope);
    for (size_t a = card->first; a < card->first + card->count; a++)
      more += growth_of(d, c->arguments[a].value, card->scope);
    if (more > 0 && more + (double)text.n > VS_DEFINITIONS_LONGEST)
      return refuse_growth(c->lines[k].where, more + (double)text.n, err);
  }
  return VS_OK;
}

/* ---- all ---- */

vs_status vs_definitions_check(const vs_cards *c, vs_error *err) {
  const size_t n = c->n_definitions;
  const definitions d = {c, vs_alloc(n, sizeof *d.of)};
  vs_circle_step *path = vs_alloc(n + 1, sizeof *path);
  size_t *order = vs_alloc(n + 1, sizeof *order);
  bool functions = false;
  for (size_t k = 0; k < n; k++) {
    const vs_netlist_definition *of = &c->definition[k];
    if (of->kind == VS_CARDS_FUNC || (of->kind == VS_CARDS_PARAM && !of->scope))
      vs_expr_read(&d.of[k].body, of->body);
    functions = functions || of->kind == VS_CARDS_FUNC;
  }
  const size_t length = vs_circle_find(n, next_named, &d, path, order);
  vs_status status = length ? refuse_circle(&d, path, length, err) : check_depth(&d, order, err);
  if (!status && functions) status = size_functions(&d, order, err);
  if (!status && functions) status = check_lines(&d, err);
  for (size_t k = 0; k < n; k++) {
    vs_expr_free(&d.of[k].body);
    free(d.of[k].copies);
  }
  free(d.of);
  free(path);
  free(order);
  return status;
}
