/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnosis/wiring.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/expr.h"
#include "netlist/words.h"

/* Limits beyond which the rest of a deck is not examined. */
enum { MOST_WIRES = 20000, MOST_DEPTH = 16 };

/* An instance while it is opened. */
typedef struct scope {
  vs_wiring *wiring;
  const vs_instance *in;
} scope;

/* ---- nodes ---- */

static int take_node(vs_wiring *w, const char *name) {
  size_t known;
  if (vs_names_find(&w->numbers, name, strlen(name), &known)) return (int)known;
  w->nodes = vs_alloc_grow(w->nodes, w->n_nodes, sizeof *w->nodes);
  snprintf(w->nodes[w->n_nodes], sizeof *w->nodes, "%s", name);
  vs_names_put(&w->numbers, name, strlen(name), w->n_nodes);
  return (int)w->n_nodes++;
}

/* The node that a word stands for inside the instance. */
static int node_of(const scope *s, vs_word word) {
  vs_text name = {0};
  vs_cards_add_node(s->wiring->cards, s->in, word, &name);
  const int node = take_node(s->wiring, name.text);
  vs_text_free(&name);
  return node;
}

static void add_look(vs_wire *wire, int node) {
  if (wire->n_looks < VS_WIRING_LOOKS) wire->looks[wire->n_looks++] = node;
}

/* ---- laws ---- */

/* The solver's name of a source inside the instance: "vs", "v.xa.vs". */
static void add_current(const scope *s, vs_word name, vs_text *law) {
  vs_text_add(law, "i(");
  if (s->in->depth) vs_text_add(law, "%c.", tolower((unsigned char)*name.at));
  vs_cards_add_name(s->in, name, law);
  vs_text_add(law, ")");
}

/* Copies an expression with the solver's names of nodes and sources. */
static void add_expression(const scope *s, vs_wire *wire, const char *text, vs_text *law) {
  const char *from = text;
  vs_expr e;
  vs_expr_read(&e, vs_words_of(text));
  for (size_t k = 1; k < e.count; k++) {
    const vs_expr_node *call = &e.node[k];
    const bool voltage = vs_words_is(call->word, "v"), current = vs_words_is(call->word, "i");
    if (call->kind != VS_EXPR_CALL || (!voltage && !current)) continue;
    vs_text_add(law, "%.*s%s", (int)(call->whole.at - from), from, voltage ? "v(" : "");
    from = call->whole.at + call->whole.n;
    if (current) add_current(s, e.node[call->child].word, law);
    for (size_t n = call->child; n && voltage; n = e.node[n].next) {
      const int node = node_of(s, e.node[n].word);
      add_look(wire, node);
      vs_text_add(law, "%s%s", n == call->child ? "" : ",", s->wiring->nodes[node]);
    }
    if (voltage) vs_text_add(law, ")");
  }
  vs_text_add(law, "%s", from);
  vs_expr_free(&e);
}

/* The controlling nodes of "POLY(n) a b c d ...", at `poly`. They may stand in brackets, "(a,b)
 * (c,d)". */
static void add_poly(const scope *s, vs_wire *wire, const char *poly) {
  const char *at = poly + strlen("poly");
  at += strspn(at, VS_WORDS_BETWEEN);
  size_t nodes = 2 * strtoul(at, NULL, 10);
  for (; nodes > 0; nodes--) {
    at = vs_words_next(at);
    const vs_word node = vs_words_at(at);
    if (!node.n) return;
    add_look(wire, node_of(s, node));
  }
}

/* Finds what controls the element's value: it stands behind the two pins. */
static void take_law(const scope *s, vs_wire *wire, const vs_netlist_card *card) {
  const vs_cards *c = s->wiring->cards;
  const vs_word control = vs_cards_word(c, card, 2);
  vs_text law = {0};
  if (card->count < 3) return;
  const bool poly = control.n && !strncasecmp(control.at, "poly", 4);
  if (strchr("fhw", wire->letter) && !poly)
    add_current(s, control, &law);
  else if (strchr("eg", wire->letter) && poly)
    add_poly(s, wire, control.at);
  else if (strchr("egs", wire->letter) && card->nodes == 4) {
    int plus = node_of(s, control), minus = node_of(s, vs_cards_word(c, card, 3));
    add_look(wire, plus);
    add_look(wire, minus);
    vs_text_add(&law, "v(%s,%s)", s->wiring->nodes[plus], s->wiring->nodes[minus]);
  } else if (strchr("begrclfh", wire->letter)) {
    const vs_argument *third = &c->arguments[card->first + 2];
    add_expression(s, wire, third->name.n ? third->name.at : third->value.at, &law);
  }
  wire->law = law.text;
}

/* ---- elements ---- */

static vs_wire *begin_wire(const scope *s, size_t number) {
  vs_wiring *w = s->wiring;
  vs_text name = {0};
  w->wires = vs_alloc_grow(w->wires, w->count, sizeof *w->wires);
  vs_wire *wire = &w->wires[w->count++];
  *wire = (vs_wire){.line = &w->cards->lines[number], .letter = w->cards->card[number].letter};
  vs_cards_add_name(s->in, w->cards->card[number].name, &name);
  snprintf(wire->name, sizeof wire->name, "%s", name.text);
  vs_text_free(&name);
  return wire;
}

/* Connects so many of the card's nodes. */
static void take_pins(const scope *s, vs_wire *wire, const vs_netlist_card *card, size_t pins) {
  for (size_t k = 0; k < pins && k < VS_WIRING_PINS; k++)
    wire->pins[wire->n_pins++] = node_of(s, vs_cards_word(s->wiring->cards, card, k));
}

static void open_element(const scope *s, size_t number) {
  const vs_cards *c = s->wiring->cards;
  const vs_netlist_card *card = &c->card[number];
  const size_t pins = strchr("egs", card->letter) && card->nodes == 4 ? 2 : card->nodes;
  if (pins == 0 || pins >= card->count) return;
  vs_wire *wire = begin_wire(s, number);
  take_pins(s, wire, card, pins);
  take_law(s, wire, card);
  const vs_netlist_definition *model =
      card->model.n ? vs_cards_resolve(c, card->scope, VS_CARDS_MODEL, card->model) : NULL;
  if (model) wire->model = &c->card[model->card];
  const vs_argument *third = &c->arguments[card->first + 2];
  wire->voltage = strchr("veh", wire->letter) ||
                  (wire->letter == 'b' && card->count > 2 && vs_words_is(third->name, "v"));
}

/* A code model's nodes, with or without brackets: all of them are connected. */
static void open_code_model(const scope *s, size_t number) {
  const vs_netlist_card *card = &s->wiring->cards->card[number];
  vs_wire *wire = begin_wire(s, number);
  wire->letter = 'x';
  for (size_t k = 0; k + 1 < card->words; k++) {
    const vs_word w = vs_cards_word(s->wiring->cards, card, k);
    for (const char *c = w.at; c < w.at + w.n;) {
      size_t skip = strspn(c, "[]() \t,~"), n = strcspn(c + skip, "[]() \t,~");
      if (n && c[skip] != '%' && wire->n_pins < VS_WIRING_PINS)
        wire->pins[wire->n_pins++] = node_of(s, (vs_word){c + skip, n});
      c += skip + n;
    }
  }
}

static int open_card(void *ctx, const vs_instance *in, size_t number) {
  vs_wiring *w = ctx;
  const scope s = {w, in};
  const vs_netlist_card *card = &w->cards->card[number];
  const bool opens = vs_cards_called(w->cards, card);
  w->whole = w->whole && w->count < MOST_WIRES;
  if (!w->whole) return VS_CARDS_STOP;
  if (opens && in->depth < MOST_DEPTH) {
    for (size_t k = 0; k < card->nodes; k++) node_of(&s, vs_cards_word(w->cards, card, k));
    return VS_CARDS_ENTER;
  }
  w->whole = !opens;
  if (card->letter == 'x')
    take_pins(&s, begin_wire(&s, number), card, card->nodes);
  else if (card->letter == 'a')
    open_code_model(&s, number);
  else
    open_element(&s, number);
  return VS_CARDS_PASS;
}

void vs_wiring_open(vs_wiring *w, const vs_deck *deck) {
  *w = (vs_wiring){.deck = deck, .cards = vs_deck_cards(deck), .whole = true};
  take_node(w, "0");
  vs_cards_expand(w->cards, open_card, w);
}

void vs_wiring_free(vs_wiring *w) {
  for (size_t k = 0; k < w->count; k++) free(w->wires[k].law);
  free(w->wires);
  free(w->nodes);
  vs_names_free(&w->numbers);
  *w = (vs_wiring){0};
}

bool vs_wiring_senses(const vs_wire *wire, const vs_wire *source) {
  char current[VS_WIRING_NAME + 8];
  bool deep = strchr(source->name, '.');
  snprintf(current, sizeof current, deep ? "i(v.%s)" : "i(%s)", source->name);
  return source->letter == 'v' && wire->law && strstr(wire->law, current);
}

vs_where vs_wiring_where(const vs_wire *wire) {
  return wire->line->where;
}
