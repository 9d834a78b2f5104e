/* SPDX-License-Identifier: GPL-3.0-or-later
 * A netlist's lines as they are taken apart, each line of the text one of the netlist: its cards,
 * scopes and definitions, the circuit unfolded, and its expressions. What is written from the cards
 * has the same cards. */
#include <stdlib.h>
#include <string.h>

#include "netlist/cards.h"
#include "netlist/expr.h"
#include "targets.h"

enum { MOST = 5000, DEEPEST = 8 };

/* Every part of the netlist lies in it. */
static void hold_to_bounds(const vs_cards *c) {
  for (size_t k = 0; k < c->count; k++) {
    const vs_netlist_card *card = &c->card[k];
    const char *text = c->lines[k].text, *end = text + strlen(text);
    FUZZ_HOLDS(card->scope < c->n_scopes && card->opens < c->n_scopes);
    FUZZ_HOLDS(card->words <= card->count && card->nodes <= card->words);
    FUZZ_HOLDS(card->first + card->count <= c->n_arguments && vs_cards_next(c, k) > k);
    FUZZ_HOLDS(!card->model.n || (card->model.at >= text && card->model.at + card->model.n <= end));
    for (size_t a = card->first; a < card->first + card->count; a++) {
      const vs_word value = c->arguments[a].value;
      FUZZ_HOLDS(value.at >= text && value.at + value.n <= end);
    }
  }
  for (size_t k = 1; k < c->n_scopes; k++) {
    FUZZ_HOLDS(c->scope[k].outer < k && c->scope[k].first <= c->scope[k].last);
    FUZZ_HOLDS(c->scope[k].last <= c->count);
  }
  for (size_t k = 0; k < c->n_definitions; k++) {
    const vs_netlist_definition *d = &c->definition[k],
                                *first = vs_cards_find(c, d->scope, d->kind, d->name);
    FUZZ_HOLDS(first && first <= d && (first == d || first->twin));
  }
}

/* Visits what is not too deep, and no more than so many elements. */
static int visit(void *ctx, const vs_instance *in, size_t number) {
  const vs_cards *c = ((const vs_cards *const *)ctx)[0];
  size_t *left = ((size_t *const *)ctx)[1];
  vs_text node = {0};
  if (!*left) return VS_CARDS_STOP;
  --*left;
  for (size_t k = 0; k < c->card[number].nodes; k++)
    vs_cards_add_node(c, in, vs_cards_word(c, &c->card[number], k), &node);
  vs_text_free(&node);
  return in->depth < DEEPEST && vs_cards_called(c, &c->card[number]) ? VS_CARDS_ENTER
                                                                     : VS_CARDS_PASS;
}

/* A tree is written as a text that has the same tree. */
static void hold_expressions(const vs_cards *c) {
  for (size_t k = 0; k < c->n_arguments; k++) {
    vs_expr e, again;
    vs_text once = {0}, twice = {0};
    vs_expr_read(&e, c->arguments[k].value);
    if (e.whole) {
      vs_expr_write(&e, 0, &once);
      vs_expr_read(&again, vs_words_of(once.text));
      vs_expr_write(&again, 0, &twice);
      FUZZ_HOLDS(again.whole && again.count == e.count && !strcmp(once.text, twice.text));
      vs_expr_free(&again);
    }
    vs_expr_free(&e);
    vs_text_free(&once);
    vs_text_free(&twice);
  }
}

static bool is_same(vs_word a, vs_word b) {
  return a.n == b.n && !memcmp(a.at, b.at, a.n);
}

/* What is written from the cards has the same cards. */
static void hold_round_trip(const vs_cards *c, vs_line *written) {
  vs_cards again;
  for (size_t k = 0; k < c->count; k++) {
    vs_text text = {0};
    vs_cards_write(c, k, &text);
    written[k] = (vs_line){0};
    vs_line_join(&written[k], text.text, (vs_where){"w.cir", (int)k + 1, 1});
    vs_text_free(&text);
  }
  vs_cards_read(&again, written, c->count);
  FUZZ_HOLDS(again.n_scopes == c->n_scopes && again.n_definitions == c->n_definitions);
  for (size_t k = 0; k < c->count; k++) {
    const vs_netlist_card *a = &c->card[k], *b = &again.card[k];
    FUZZ_HOLDS(a->kind == b->kind && a->letter == b->letter && a->scope == b->scope);
    FUZZ_HOLDS(a->count == b->count && a->words == b->words && a->nodes == b->nodes);
    FUZZ_HOLDS(is_same(a->name, b->name) && is_same(a->model, b->model));
    for (size_t n = 0; n < a->count; n++) {
      const vs_argument *x = &c->arguments[a->first + n], *y = &again.arguments[b->first + n];
      FUZZ_HOLDS(is_same(x->name, y->name) && is_same(x->value, y->value));
    }
    vs_line_free(&written[k]);
  }
  vs_cards_free(&again);
}

static void take(const char *text, size_t size) {
  static vs_line lines[MOST], written[MOST];
  char *copy = vs_alloc_part(text, size), *rest = copy;
  size_t count = 0, left = 20000;
  vs_cards c;
  for (char *line; (line = strsep(&rest, "\n")) && count < MOST;) {
    if (!*line) continue;
    lines[count] = (vs_line){0};
    vs_line_join(&lines[count], line, (vs_where){"t.cir", (int)count + 1, 1});
    count++;
  }
  vs_cards_read(&c, lines, count);
  hold_to_bounds(&c);
  const void *const ctx[] = {&c, &left};
  vs_cards_expand(&c, visit, (void *)(size_t)ctx);
  hold_expressions(&c);
  hold_round_trip(&c, written);
  vs_cards_free(&c);
  for (size_t k = 0; k < count; k++) vs_line_free(&lines[k]);
  free(copy);
}

const fuzz_target fuzz_cards = {"cards", take, &fuzz_grammar_deck, NULL};
