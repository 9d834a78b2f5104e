/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macromodel/circuit_states.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "netlist/cards.h"
#include "netlist/expr.h"
#include "netlist/numbers.h"

/* Bounds of what is taken apart; a netlist beyond them has no list. 12 levels are more than makers
 * nest subcircuits; a path of 80 bytes leaves room for a node's name behind it in
 * VS_CIRCUIT_STATE_NAME. A formula of more than 1000 levels, as a sum of so many terms, counts as
 * not linear. */
enum { MOST_DEPTH = 12, MOST_PATH = 80, MOST_LEVELS = 1000 };

typedef struct search {
  const vs_deck *deck;
  const vs_cards *cards;
  const vs_instance *in; /* the instance that is taken apart */
  bool reading;          /* a function of the netlist's own reads a signal itself */
  vs_circuit_states *all;
} search;

/* ---- expressions ---- */

/* True for an operation or a call that branches, or is as steep as if it did. */
static bool is_branch(const vs_expr_node *n) {
  static const char *const BRANCHING[] = {
      "u",   "u2",  "uramp", "sgn",   "floor", "ceil",        "int",  "nint", "if",
      "min", "max", "limit", "table", "pwl",   "ternary_fcn", "tanh", "atan", "arctan"};
  if (n->kind == VS_EXPR_CHOICE) return true;
  if (n->kind == VS_EXPR_OPERATOR) return strchr("<>&|", *n->word.at);
  for (size_t k = 0; k < sizeof BRANCHING / sizeof *BRANCHING && n->kind == VS_EXPR_CALL; k++)
    if (vs_words_is(n->word, BRANCHING[k])) return true;
  return false;
}

static bool is_signal(const vs_expr_node *n) {
  return n->kind == VS_EXPR_CALL && (vs_words_is(n->word, "v") || vs_words_is(n->word, "i"));
}

/* Finds whether one of the netlist's own functions reads a signal. */
static void look_at_functions(search *s) {
  for (size_t k = 0; k < s->cards->n_definitions; k++) {
    const vs_netlist_definition *d = &s->cards->definition[k];
    vs_expr body;
    if (d->kind != VS_CARDS_FUNC) continue;
    vs_expr_read(&body, d->body);
    for (size_t n = 1; n < body.count; n++) s->reading = s->reading || is_signal(&body.node[n]);
    vs_expr_free(&body);
  }
}

/* ---- what is added ---- */

static bool add_state(const search *s, const vs_circuit_state *m) {
  vs_circuit_states *all = s->all;
  for (size_t k = 0; k < all->count; k++) {
    const vs_circuit_state *old = &all->item[k];
    if (strcmp(old->plus, m->plus) || strcmp(old->minus, m->minus)) continue;
    if (old->threshold == m->threshold && !memcmp(old->level, m->level, sizeof m->level))
      return true;
  }
  if (!strcmp(m->plus, m->minus)) return true;
  if (all->count == VS_CIRCUIT_STATES_MOST) return false;
  all->item[all->count++] = *m;
  return true;
}

/* Writes "v(NODE)" or "i(ELEMENT)", as ngspice calls it: "l1" of xa.xb is l.xa.xb.l1. */
static void write_signal(const search *s, char kind, vs_word name,
                         char out[VS_CIRCUIT_STATE_NAME]) {
  vs_text text = {0};
  if (kind == 'v')
    vs_cards_add_node(s->cards, s->in, name, &text);
  else {
    if (s->in->outer) vs_text_add(&text, "%c.", tolower((unsigned char)*name.at));
    vs_cards_add_name(s->in, name, &text);
  }
  snprintf(out, VS_CIRCUIT_STATE_NAME, "%c(%.150s)", kind, text.text);
  vs_text_free(&text);
}

/* Adds a voltage with the threshold that *m says, if it says one. */
static bool add_control(const search *s, vs_word plus, vs_word minus, vs_circuit_state *m) {
  write_signal(s, 'v', plus, m->plus);
  write_signal(s, 'v', minus, m->minus);
  return add_state(s, m);
}

static bool add_voltage(const search *s, vs_word plus, vs_word minus) {
  vs_circuit_state m = {.threshold = VS_THRESHOLD_NONE};
  return add_control(s, plus, minus, &m);
}

/* Adds the current of an inductor or a voltage source, likewise. */
static bool add_current(const search *s, vs_word element, vs_circuit_state *m) {
  write_signal(s, 'i', element, m->plus);
  snprintf(m->minus, sizeof m->minus, "v(0)");
  return add_state(s, m);
}

/* The line of an element's model; NULL: there is none. *twice: there are two of that name, which
 * are not told apart. */
static const vs_netlist_card *model_of(const search *s, const vs_netlist_card *card, bool *twice) {
  const vs_netlist_definition *d =
      vs_cards_resolve(s->cards, card->scope, VS_CARDS_MODEL, card->model);
  *twice = d && d->twin;
  return d ? &s->cards->card[d->card] : NULL;
}

/* True where the element's model gives its junctions a charge. */
static bool holds_charge(const search *s, const vs_netlist_card *card) {
  static const char *const CHARGES[] = {"cjo", "cj0", "cj", "cjp", "cjsw", "tt", "cje",
                                        "cjc", "cjs", "tf", "tr",  "cgs",  "cgd"};
  bool twice, holds = false;
  const vs_netlist_card *model = model_of(s, card, &twice);
  for (size_t k = 0; model && k < sizeof CHARGES / sizeof *CHARGES && !holds; k++)
    holds = vs_cards_value(s->cards, model, CHARGES[k]).n;
  return holds || twice;
}

/* True for a code model whose output is a sum of its inputs times constants: no product, no
 * limiter, no table, which may be as steep as a comparator, and nothing digital, which has levels
 * and delays. */
static bool forgets(const search *s, const vs_netlist_card *card) {
  static const char *const STEADY[] = {"gain", "summer"};
  bool twice;
  const vs_netlist_card *model = model_of(s, card, &twice);
  for (size_t n = 0; model && !twice && n < sizeof STEADY / sizeof *STEADY; n++)
    if (vs_words_is(model->model, STEADY[n])) return true;
  return false;
}

/* Adds what a transistor remembers, and what turns it on: one that conducts above a voltage is a
 * comparator, too. */
static bool add_transistor(const search *s, const vs_netlist_card *card) {
  vs_word n[3];
  vs_circuit_state m = {.threshold = VS_THRESHOLD_UNKNOWN};
  for (size_t k = 0; k < 3; k++) n[k] = vs_cards_word(s->cards, card, k);
  if (card->words < 4 || !add_control(s, n[1], n[2], &m)) return false;
  if (strchr("qj", card->letter) && !holds_charge(s, card)) return true;
  bool good = add_voltage(s, n[1], n[0]) && add_voltage(s, n[1], n[2]);
  return good && (card->letter == 'q' || add_voltage(s, n[0], n[2]));
}

/* Letters of elements that remember nothing of their own. k couples inductors, whose currents are
 * listed. */
static const char FORGETFUL[] = "bfhikrv";

/* Adds an inductor's current. Returns false for one that is given by a formula: ngspice makes other
 * elements of it, and its current has no such name. */
static bool add_inductor(const search *s, const vs_netlist_card *card) {
  vs_circuit_state m = {.threshold = VS_THRESHOLD_NONE};
  return !strcasestr(card->name.at, "v(") && !strcasestr(card->name.at, "i(") &&
         add_current(s, card->name, &m);
}

/* ---- thresholds ---- */

/* Reads the number of a parameter of a model, 0 where the model does not give it. False: it is a
 * formula. */
static bool is_plain_number_of_model(const search *s, const vs_netlist_card *model,
                                     const char *name, double *value) {
  const vs_word given = vs_cards_value(s->cards, model, name);
  *value = 0;
  return !given.n || vs_numbers_read(given, value);
}

/* Fills the threshold of a switch's control from its .model line: it turns on above vt + |vh| and
 * off below vt - |vh| (ngspice manual, "Switches"). It is unknown where two models have that name,
 * and where it is of another kind, as PSpice's vswitch. */
static void threshold_of(const search *s, const vs_netlist_card *card, vs_circuit_state *m) {
  const bool by_voltage = card->letter == 's';
  bool twice;
  double at, half;
  const vs_netlist_card *model = model_of(s, card, &twice);
  m->threshold = VS_THRESHOLD_UNKNOWN;
  if (!model || twice || !vs_words_is(model->model, by_voltage ? "sw" : "csw")) return;
  if (!is_plain_number_of_model(s, model, by_voltage ? "vt" : "it", &at) ||
      !is_plain_number_of_model(s, model, by_voltage ? "vh" : "ih", &half))
    return;
  m->threshold = VS_THRESHOLD_KNOWN;
  m->level[0] = at + fabs(half);
  m->level[1] = at - fabs(half);
}

/* Adds what a switch reads. */
static bool add_control_of_switch(const search *s, const vs_netlist_card *card) {
  const vs_word control = vs_cards_word(s->cards, card, 2);
  vs_circuit_state m = {.threshold = VS_THRESHOLD_NONE};
  if (!card->model.n) return false;
  threshold_of(s, card, &m);
  return card->letter == 's' ? add_control(s, control, vs_cards_word(s->cards, card, 3), &m)
                             : add_current(s, control, &m);
}

/* Adds what a call of v or i reads. */
static bool add_read(const search *s, const vs_expr *e, const vs_expr_node *call) {
  vs_circuit_state m = {.threshold = VS_THRESHOLD_UNKNOWN};
  const vs_expr_node *first = &e->node[call->child], *second = &e->node[first->next];
  const vs_word other = first->next ? second->word : vs_words_of("0");
  if (!call->child || (first->next && second->next)) return false;
  if (first->word.n >= MOST_PATH || other.n >= MOST_PATH) return false;
  return vs_words_is(call->word, "v") ? add_control(s, first->word, other, &m)
                                      : add_current(s, first->word, &m);
}

/* True for a call of a function of the netlist's own. */
static bool calls_function(const search *s, size_t scope, const vs_expr_node *n) {
  return n->kind == VS_EXPR_CALL && vs_cards_resolve(s->cards, scope, VS_CARDS_FUNC, n->word);
}

/* The degree in its signals of node n: 0 for a constant, 1 for signals times constants, 2 for all
 * else, for what branches or is a function of the netlist's own, and below MOST_LEVELS of the tree.
 */
static int degree_of(const search *s, size_t scope, const vs_expr *e, size_t n, int levels) {
  const vs_expr_node *of = &e->node[n];
  int last = 0, most = 0, sum = 0;
  if (is_signal(of)) return 1;
  if (levels == MOST_LEVELS || is_branch(of) || calls_function(s, scope, of)) return 2;
  for (size_t k = of->child; k; k = e->node[k].next) {
    last = degree_of(s, scope, e, k, levels + 1);
    most = last > most ? last : most;
    sum += last;
  }
  if (of->word.n == 1 && strchr("+-({'", *of->word.at)) return most;
  if (of->word.n == 1 && *of->word.at == '*') return sum < 2 ? sum : 2;
  if (*of->word.at == '/' && last == 0) return most;
  return most ? 2 : 0;
}

/* True for an element whose formula is a sum of signals times constants: nothing but its two nodes
 * stands before it, and nothing but parameters as m=2 behind. False for one that cannot be read,
 * too. */
static bool is_linear(const search *s, const vs_netlist_card *card) {
  bool linear = card->words == 2;
  for (size_t k = card->first + 2; k < card->first + card->count && linear; k++) {
    const vs_argument *a = &s->cards->arguments[k];
    vs_expr e;
    vs_expr_read(&e, a->value);
    linear = a->name.n && e.whole && degree_of(s, card->scope, &e, e.node[0].child, 0) < 2;
    vs_expr_free(&e);
  }
  return linear;
}

/* Adds every signal that a formula reads which is not linear in them: what they drift by it may
 * make much larger. So may a resistance or capacitance that any formula gives. Returns false where
 * no signal of the formula's own shows what is read. */
static bool add_reads(const search *s, const vs_netlist_card *card) {
  bool good = true;
  vs_expr e;
  if (card->count < 3) return true;
  const vs_argument *third = &s->cards->arguments[card->first + 2];
  const bool all = !strchr("beg", card->letter) || !is_linear(s, card);
  vs_expr_read(&e, vs_words_of(third->name.n ? third->name.at : third->value.at));
  for (size_t k = 1; k < e.count && good; k++)
    if (s->reading && calls_function(s, card->scope, &e.node[k]))
      good = false;
    else if (all && is_signal(&e.node[k]))
      good = add_read(s, &e, &e.node[k]);
  vs_expr_free(&e);
  return good;
}

/* ---- elements ---- */

/* Adds what one element remembers. Returns false where no signal shows it. */
static bool add_states_of_element(const search *s, const vs_netlist_card *card) {
  const vs_word plus = vs_cards_word(s->cards, card, 0), minus = vs_cards_word(s->cards, card, 1);
  const char *line = card->name.at;
  if (strchr("bcegr", card->letter) && !add_reads(s, card)) return false;
  if (strchr("efgh", card->letter) && strcasestr(line, "poly")) return false; /* may be a product */
  if (strchr(FORGETFUL, card->letter)) return true;
  switch (card->letter) {
  case 's':
  case 'w':
    return add_control_of_switch(s, card);
  case 'e':
  case 'g':
    return !strcasestr(line, "laplace") && !strcasestr(line, "freq");
  case 'c':
    return card->words > 1 && add_voltage(s, plus, minus);
  case 'l':
    return add_inductor(s, card);
  case 'd':
    return card->words > 1 && (!holds_charge(s, card) || add_voltage(s, plus, minus));
  case 'q':
  case 'j':
  case 'z':
  case 'm':
    return !strcasestr(line, "thermal") && add_transistor(s, card);
  case 'a':
    return forgets(s, card);
  default:
    return false;
  }
}

/* True where the subcircuit of an instance can be taken apart for certain: its name is defined
 * once, its nodes are as many as the instance's, and there is room for its path. */
static bool may_enter(const search *s, const vs_netlist_card *card) {
  const vs_netlist_scope *scope = &s->cards->scope[vs_cards_called(s->cards, card)];
  vs_text path = {0};
  if (scope->first == 0 || s->in->depth == MOST_DEPTH) return false;
  if (vs_cards_find(s->cards, scope->outer, VS_CARDS_SUBCKT, scope->name)->twin) return false;
  vs_cards_add_name(s->in, card->name, &path);
  const bool fits = path.length + 1 < MOST_PATH;
  vs_text_free(&path);
  return fits && s->cards->card[scope->first - 1].nodes == card->nodes;
}

static int take_element(void *ctx, const vs_instance *in, size_t number) {
  search *s = ctx;
  const vs_netlist_card *card = &s->cards->card[number];
  s->in = in;
  if (card->letter != 'x') return add_states_of_element(s, card) ? VS_CARDS_PASS : VS_CARDS_STOP;
  if (!in->outer && vs_words_is(card->name, s->deck->eva)) return VS_CARDS_PASS;
  return may_enter(s, card) ? VS_CARDS_ENTER : VS_CARDS_STOP;
}

bool vs_circuit_states_list(const vs_deck *deck, vs_circuit_states *all) {
  search s = {.deck = deck, .cards = vs_deck_cards(deck), .all = all};
  look_at_functions(&s);
  return vs_cards_expand(s.cards, take_element, &s);
}

/* ---- what nobody sees ---- */

static bool has_term_at(const vs_deck *deck, const char *node) {
  char signal[VS_DECK_NAME + 4];
  snprintf(signal, sizeof signal, "v(%s)", node);
  for (size_t k = 0; k < deck->n_terms; k++)
    if (!strcasecmp(deck->terms[k].plus, signal) || !strcasecmp(deck->terms[k].minus, signal))
      return strcmp(node, "0") != 0;
  return false;
}

/* True where a store names a parameter that the line names, too. */
static bool has_store_of(const vs_deck *deck, const char *line) {
  for (size_t k = 0; k < deck->stores.count; k++) {
    const vs_formula *f = &deck->stores.item[k].formula;
    for (size_t n = 0; n < f->count; n++) {
      int name = vs_formula_name_of(&f->ops[n]);
      char braced[VS_DECK_NAME + 3];
      if (name < 0) continue;
      snprintf(braced, sizeof braced, "{%s}", deck->names[name].name);
      if (strcasestr(line, braced)) return true;
    }
  }
  return false;
}

bool vs_circuit_states_are_hidden(const vs_deck *deck) {
  for (size_t k = 0; k < deck->n_lines; k++) {
    const vs_line *line = &deck->lines[k];
    char name[VS_DECK_NAME], plus[VS_DECK_NAME], minus[VS_DECK_NAME];
    if (line->where.file != deck->files[0] || !strchr("cClL", *line->text)) continue;
    if (sscanf(line->text, "%63s %63s %63s", name, plus, minus) != 3) continue;
    if (!has_term_at(deck, plus) && !has_term_at(deck, minus) && !has_store_of(deck, line->text))
      return true;
  }
  return false;
}
