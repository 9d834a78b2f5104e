/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/cards.h"

#include <ctype.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/cursor.h"
#include "netlist/numbers.h"

static const char BLANKS[] = " \t";

/* ---- words ---- */

/* Goes behind what is kept together at s: quotes and what is between them, braces, square brackets
 * and, with `round`, round ones. Another character is passed by alone. */
static const char *behind_one(const char *s, bool round) {
  int depth = 0;
  do {
    if (*s == '\'' || *s == '"') {
      const char *closing = strchr(s + 1, *s);
      s = closing ? closing : s + strlen(s) - 1;
    }
    depth += *s == '{' || *s == '[' || (round && *s == '(');
    depth -= *s == '}' || *s == ']' || (round && *s == ')');
    s++;
  } while (depth > 0 && *s);
  return s;
}

/* Goes behind the word at s, which ends at one of these characters. */
static const char *behind_word(const char *s, const char *ends, bool round) {
  while (*s && !strchr(ends, *s)) s = behind_one(s, round);
  return s;
}

/* True where a single '=' stands at s. */
static bool is_assignment(const char *line, const char *s) {
  return *s == '=' && s[1] != '=' && (s == line || !strchr("=<>!", s[-1]));
}

/* Where the value at s ends that goes up to the next NAME=, or to the line's end. */
static const char *behind_formula(const char *s) {
  const char *begin = s;
  for (; *s; s = behind_one(s, true)) {
    if (!is_assignment(begin, s)) continue;
    const char *end = s, *name;
    while (end > begin && strchr(BLANKS, end[-1])) end--;
    for (name = end; name > begin && vs_words_goes_on(name[-1]);) name--;
    if (name < end) return name;
  }
  return s;
}

static vs_word trimmed(const char *from, const char *to) {
  while (to > from && strchr(BLANKS, to[-1])) to--;
  return (vs_word){from, (size_t)(to - from)};
}

static const char *second_word(const char *line) {
  line += strcspn(line, BLANKS);
  return line + strspn(line, BLANKS);
}

/* ---- cards ---- */

/* Statements of which more is to be known than that they are there. */
static const struct statement {
  const char *word;
  int kind;
} STATEMENTS[] = {{".subckt", VS_CARDS_SUBCKT}, {".ends", VS_CARDS_ENDS},
                  {".model", VS_CARDS_MODEL},   {".param", VS_CARDS_PARAM},
                  {".func", VS_CARDS_FUNC},     {".global", VS_CARDS_GLOBAL},
                  {".params", VS_CARDS_PARAM},  {".parameters", VS_CARDS_PARAM},
                  {".if", VS_CARDS_IF},         {".endif", VS_CARDS_ENDIF}};

static int kind_of(const char *line) {
  if (*line != '.') return isalpha((unsigned char)*line) ? VS_CARDS_ELEMENT : VS_CARDS_OTHER;
  for (size_t k = 0; k < sizeof STATEMENTS / sizeof *STATEMENTS; k++) {
    const size_t n = strlen(STATEMENTS[k].word);
    if (!strncasecmp(line, STATEMENTS[k].word, n) && strchr(" \t(", line[n]))
      return STATEMENTS[k].kind;
  }
  return VS_CARDS_OTHER;
}

/* Reads what stands from s on. With `formulas` a value goes up to the next NAME=. */
static void read_arguments(vs_cards *c, vs_netlist_card *card, const char *s, bool formulas) {
  static const char ENDS[] = VS_WORDS_BETWEEN "=";
  for (const char *end; *(s += strspn(s, ENDS)); s = end) {
    end = behind_word(s, ENDS, false);
    const char *equals = end + strspn(end, BLANKS);
    vs_argument a = {{s, 0}, {s, (size_t)(end - s)}};
    if (is_assignment(s, equals)) {
      a.name = a.value;
      s = equals + 1 + strspn(equals + 1, formulas ? BLANKS : " \t,)");
      end = formulas ? behind_formula(s) : behind_word(s, " \t,)", true);
      a.value = trimmed(s, end);
    } else if (vs_words_is(a.value, "params:") || vs_words_is(a.value, "optional:"))
      continue;
    c->arguments = vs_alloc_grow(c->arguments, c->n_arguments, sizeof *c->arguments);
    c->arguments[c->n_arguments++] = a;
    card->words += !a.name.n && card->words == card->count;
    card->count++;
  }
}

/* How many of an element's words are nodes, as its letter says. */
static size_t nodes_of(const vs_cards *c, const vs_netlist_card *card) {
  static const char LETTERS[] = "rclvidbfhwegstjqmzuo", COUNTS[] = "22222222224444334334";
  static const char *const FORMULAS[] = {"value", "poly", "table", "laplace", "vol", "cur", "freq"};
  const char *letter = strchr(LETTERS, card->letter);
  const vs_word third = vs_cards_word(c, card, 2);
  size_t nodes = letter ? (size_t)(COUNTS[letter - LETTERS] - '0') : 0;
  if (card->letter == 'x') nodes = card->words - (card->words > 0);
  if (strchr("eg", card->letter) && (card->words < 4 || *third.at == '{')) nodes = 2;
  for (size_t k = 0; k < sizeof FORMULAS / sizeof *FORMULAS && strchr("eg", card->letter); k++)
    if (third.n && !strncasecmp(third.at, FORMULAS[k], strlen(FORMULAS[k]))) nodes = 2;
  return nodes < card->words ? nodes : card->words;
}

/* Finds the nodes and the model of an element, once all models are known: those of a transistor
 * stand before its model, and may be more than its letter says. */
static void find_nodes(const vs_cards *c, vs_netlist_card *card) {
  card->nodes = nodes_of(c, card);
  for (size_t k = 3; k < 7 && k < card->words && strchr("qm", card->letter); k++)
    if (vs_cards_resolve(c, card->scope, VS_CARDS_MODEL, vs_cards_word(c, card, k))) {
      card->nodes = k;
      break;
    }
  if (strchr("xdqjmzuos", card->letter)) card->model = vs_cards_word(c, card, card->nodes);
  if (card->letter == 'w') card->model = vs_cards_word(c, card, 3);
  if (card->letter == 'a' && card->words) card->model = vs_cards_word(c, card, card->words - 1);
}

/* ---- definitions ---- */

/* What a definition is found by. */
static vs_text key_of(int kind, size_t scope, vs_word name) {
  vs_text key = {0};
  vs_text_add(&key, "%d %zu %.*s", kind, scope, (int)name.n, name.at);
  return key;
}

static void define(vs_cards *c, const vs_netlist_definition *d) {
  vs_text key = key_of(d->kind, d->scope, d->name);
  size_t first;
  if (vs_names_find(&c->numbers, key.text, key.length, &first))
    c->definition[first].twin = true;
  else
    vs_names_put(&c->numbers, key.text, c->n_definitions);
  vs_text_free(&key);
  c->definition = vs_alloc_grow(c->definition, c->n_definitions, sizeof *c->definition);
  c->definition[c->n_definitions++] = *d;
}

const vs_netlist_definition *vs_cards_find(const vs_cards *c, size_t scope, int kind,
                                           vs_word name) {
  size_t number;
  vs_text key = key_of(kind, scope, name);
  const bool found = vs_names_find(&c->numbers, key.text, key.length, &number);
  vs_text_free(&key);
  return found ? &c->definition[number] : NULL;
}

const vs_netlist_definition *vs_cards_resolve(const vs_cards *c, size_t scope, int kind,
                                              vs_word name) {
  for (size_t k = 0; k < c->n_choices && kind == VS_CARDS_SUBCKT; k++)
    if (vs_words_is(name, c->choice[k].name) && *c->choice[k].subcircuit) {
      name = vs_words_of(c->choice[k].subcircuit);
      break;
    }
  for (;; scope = c->scope[scope].outer) {
    const vs_netlist_definition *found = vs_cards_find(c, scope, kind, name);
    if (found || !scope) return found;
  }
}

/* Defines the parameters that a card gives values, in a scope. */
static void define_parameters(vs_cards *c, size_t card, size_t scope) {
  const vs_netlist_card *of = &c->card[card];
  for (size_t k = of->first; k < of->first + of->count; k++)
    if (c->arguments[k].name.n)
      define(c, &(vs_netlist_definition){.kind = VS_CARDS_PARAM,
                                         .scope = scope,
                                         .card = card,
                                         .name = c->arguments[k].name,
                                         .body = c->arguments[k].value});
}

/* Defines the function of a line ".func NAME(ARGUMENTS) BODY", or of a .param of that form. */
static bool define_function(vs_cards *c, size_t card) {
  const char *s = second_word(c->lines[card].text), *end = s;
  while (vs_words_goes_on(*end)) end++;
  const char *open = end + strspn(end, BLANKS), *close = *open == '(' ? strchr(open, ')') : NULL;
  if (end == s || !close) return false;
  vs_netlist_definition d = {.kind = VS_CARDS_FUNC,
                             .scope = c->card[card].scope,
                             .card = card,
                             .name = {s, (size_t)(end - s)},
                             .arguments = {open + 1, (size_t)(close - open - 1)},
                             .body = {close + 1, strlen(close + 1)}};
  c->card[card].name = d.name;
  define(c, &d);
  return true;
}

/* Reads what stands behind the statement's word, or behind the element's name. */
static void read_card(vs_cards *c, size_t number) {
  const char *line = c->lines[number].text, *s = second_word(line);
  vs_netlist_card *card = &c->card[number];
  const bool element = card->kind == VS_CARDS_ELEMENT;
  if (element || card->kind == VS_CARDS_SUBCKT || card->kind == VS_CARDS_MODEL) {
    card->name = vs_words_at(element ? line : s + strspn(s, VS_WORDS_BETWEEN));
    s = vs_words_next(card->name.at);
  }
  read_arguments(c, card, s,
                 element ? strchr("xb", card->letter) != NULL : card->kind != VS_CARDS_MODEL);
  for (size_t k = 0; k < card->words && card->kind == VS_CARDS_GLOBAL; k++) {
    char *node = vs_alloc_part(vs_cards_word(c, card, k).at, vs_cards_word(c, card, k).n);
    vs_names_put(&c->globals, node, number);
    free(node);
  }
  if (card->kind == VS_CARDS_MODEL) card->model = vs_cards_word(c, card, 0);
  if (card->kind == VS_CARDS_SUBCKT) card->nodes = card->words;
  if (card->kind != VS_CARDS_MODEL && card->kind != VS_CARDS_SUBCKT) return;
  define(c, &(vs_netlist_definition){
                .kind = card->kind, .scope = card->scope, .card = number, .name = card->name});
}

static size_t open_scope(vs_cards *c, size_t number, size_t outer) {
  c->scope = vs_alloc_grow(c->scope, c->n_scopes, sizeof *c->scope);
  c->scope[c->n_scopes] = (vs_netlist_scope){
      .name = c->card[number].name, .outer = outer, .first = number + 1, .last = c->count};
  define_parameters(c, number, c->n_scopes);
  return c->card[number].opens = c->n_scopes++;
}

void vs_cards_read(vs_cards *c, const vs_line *lines, size_t count) {
  size_t scope = 0, conditions = 0;
  *c = (vs_cards){.lines = lines, .card = vs_alloc(count, sizeof *c->card), .count = count};
  c->scope = vs_alloc_grow(NULL, 0, sizeof *c->scope);
  c->scope[c->n_scopes++] = (vs_netlist_scope){.last = count};
  for (size_t k = 0; k < count; k++) {
    const int kind = kind_of(lines[k].text);
    conditions -= kind == VS_CARDS_ENDIF && conditions;
    c->card[k] = (vs_netlist_card){.kind = kind,
                                   .letter = (char)tolower((unsigned char)*lines[k].text),
                                   .conditional = conditions > 0,
                                   .scope = scope,
                                   .name = {lines[k].text, 0},
                                   .model = {lines[k].text, 0},
                                   .first = c->n_arguments};
    conditions += kind == VS_CARDS_IF;
    if (kind == VS_CARDS_FUNC || kind == VS_CARDS_PARAM)
      if (define_function(c, k) || kind == VS_CARDS_FUNC) continue;
    if (kind < VS_CARDS_IF) read_card(c, k);
    if (kind == VS_CARDS_PARAM) define_parameters(c, k, scope);
    if (kind == VS_CARDS_SUBCKT) scope = open_scope(c, k, scope);
    if (kind != VS_CARDS_ENDS || !scope) continue;
    c->scope[scope].last = k;
    scope = c->scope[scope].outer;
  }
  for (size_t k = 0; k < count; k++)
    if (c->card[k].kind == VS_CARDS_ELEMENT) find_nodes(c, &c->card[k]);
}

void vs_cards_free(vs_cards *c) {
  free(c->card);
  free(c->arguments);
  free(c->scope);
  free(c->definition);
  vs_names_free(&c->globals);
  vs_names_free(&c->numbers);
  *c = (vs_cards){0};
}

vs_word vs_cards_word(const vs_cards *c, const vs_netlist_card *card, size_t n) {
  return n < card->words ? c->arguments[card->first + n].value : (vs_word){"", 0};
}

void vs_cards_write(const vs_cards *c, size_t k, vs_text *out) {
  const vs_netlist_card *card = &c->card[k];
  const char *line = c->lines[k].text;
  const bool element = card->kind == VS_CARDS_ELEMENT;
  if (card->kind == VS_CARDS_FUNC || card->kind >= VS_CARDS_IF ||
      (card->kind == VS_CARDS_PARAM && card->name.n)) {
    vs_text_add(out, "%s", line);
    return;
  }
  if (!element) vs_text_add(out, "%.*s ", (int)strcspn(line, BLANKS), line);
  vs_text_add(out, "%.*s", (int)card->name.n, card->name.at);
  for (size_t n = card->first; n < card->first + card->count; n++) {
    const vs_argument *a = &c->arguments[n];
    const bool given = a->name.n;
    /* no sign of a name or value makes "==" or "<=" of the '=' between them */
    const char *before = given && strchr("=<>!", a->name.at[a->name.n - 1]) ? " " : "";
    const char *behind = given && a->value.n && *a->value.at == '=' ? " " : "";
    vs_text_add(out, " %.*s%s%s%s%.*s", (int)a->name.n, a->name.at, before, given ? "=" : "",
                behind, (int)a->value.n, a->value.at);
  }
}

vs_word vs_cards_value(const vs_cards *c, const vs_netlist_card *card, const char *name) {
  for (size_t k = card->first; k < card->first + card->count; k++)
    if (vs_words_is(c->arguments[k].name, name)) return c->arguments[k].value;
  return (vs_word){"", 0};
}

bool vs_cards_is_external(const vs_cards *c, const vs_netlist_card *card) {
  return (card->letter == 'v' || card->letter == 'i') &&
         vs_words_is(vs_cards_word(c, card, 2), "external");
}

bool vs_cards_has_node(const vs_cards *c, const vs_netlist_card *card, vs_word node) {
  bool has = false;
  for (size_t k = 0; k < card->nodes && !has; k++)
    has = !vs_words_compare(vs_cards_word(c, card, k), node);
  if (card->letter != 'a') return has;
  for (size_t k = 0; k < card->words && !has; k++) {
    const vs_word w = vs_cards_word(c, card, k);
    const char *at = vs_words_find(w.at, w.at, node.at, node.n);
    has = at && at < w.at + w.n;
  }
  return has;
}

size_t vs_cards_next(const vs_cards *c, size_t k) {
  const size_t opens = c->card[k].opens;
  return 1 + (opens ? c->scope[opens].last : k);
}

vs_word vs_cards_instance_of(const char *line) {
  const vs_line alone = {.text = (char *)(size_t)line};
  vs_cards c;
  vs_cards_read(&c, &alone, 1);
  const vs_word name = c.card[0].letter == 'x' ? c.card[0].model : (vs_word){line, 0};
  vs_cards_free(&c);
  return name;
}

size_t vs_cards_called(const vs_cards *c, const vs_netlist_card *card) {
  if (card->kind != VS_CARDS_ELEMENT || card->letter != 'x' || !card->model.n) return 0;
  const vs_netlist_definition *d = vs_cards_resolve(c, card->scope, VS_CARDS_SUBCKT, card->model);
  return d ? c->card[d->card].opens : 0;
}

/* ---- what a subcircuit of three pins is ---- */

/* Two nodes that a resistor or a junction connects, with a resistance that orders them: of a
 * junction and of a value that is a formula, those of one in operation. */
enum { LATCH_PINS = 3, MOST_TIES = 512, MOST_CALLS = 64, LATCH_DEPTH = 8 };
static const double JUNCTION_OHM = 10, FORMULA_OHM = 100, AT_A_PIN_OHM = 5;

typedef struct tie {
  size_t a, b;
  double ohm;
  bool junction;
} tie;

typedef struct latch_search {
  const vs_cards *cards;
  vs_names nodes; /* by "path.node"; the pins are 0, 1 and 2 */
  tie ties[MOST_TIES];
  size_t n_ties, n_nodes;
  struct {
    size_t node;
    char type; /* of the transistor, n or p */
  } emitter[MOST_TIES];
  size_t n_emitters;
  size_t calls; /* subcircuits that were gone through */
} latch_search;

static size_t node_number(latch_search *s, const char *path, vs_word node, const vs_word *outer,
                          const size_t *numbers, size_t n_outer) {
  size_t number = s->n_nodes;
  for (size_t k = 0; k < n_outer; k++)
    if (!vs_words_compare(outer[k], node)) return numbers[k];
  vs_text name = {0};
  vs_text_add(&name, "%s.%.*s", vs_words_is_ground(node) ? "" : path, (int)node.n, node.at);
  if (!vs_names_find(&s->nodes, name.text, name.length, &number)) {
    vs_names_put(&s->nodes, name.text, number);
    s->n_nodes++;
  }
  vs_text_free(&name);
  return number;
}

static void add_tie(latch_search *s, size_t a, size_t b, double ohm, bool junction) {
  if (s->n_ties < MOST_TIES) s->ties[s->n_ties++] = (tie){a, b, ohm, junction};
}

/* Takes one element, whose first nodes are numbered: c b e of a transistor. */
static void take_tie(latch_search *s, const vs_netlist_card *card, const size_t *node) {
  double ohm = FORMULA_OHM;
  const vs_netlist_definition *model;
  switch (card->letter) {
  case 'r':
    vs_numbers_read(vs_cards_word(s->cards, card, 2), &ohm);
    add_tie(s, node[0], node[1], ohm, false);
    break;
  case 'v':
  case 'l':
    add_tie(s, node[0], node[1], 0, false);
    break;
  case 'd':
    add_tie(s, node[0], node[1], JUNCTION_OHM, true);
    break;
  case 'q':
    add_tie(s, node[1], node[2], JUNCTION_OHM, true);
    model = vs_cards_resolve(s->cards, card->scope, VS_CARDS_MODEL, card->model);
    if (model && s->n_emitters < MOST_TIES) {
      const vs_word type = s->cards->card[model->card].model;
      s->emitter[s->n_emitters].node = node[2];
      s->emitter[s->n_emitters++].type = (char)tolower((unsigned char)*type.at);
    }
    break;
  default:
    break;
  }
}

/* Takes what is in a scope, whose own nodes `outer` have numbers already. */
static void take_scope(latch_search *s, size_t scope, const char *path, const vs_word *outer,
                       const size_t *numbers, size_t n_outer, int depth) {
  enum { MOST = 8 };
  const vs_cards *c = s->cards;
  const vs_netlist_scope *of = &c->scope[scope];
  for (size_t k = of->first; k < of->last; k = vs_cards_next(c, k)) {
    const vs_netlist_card *card = &c->card[k];
    if (card->kind != VS_CARDS_ELEMENT) continue;
    size_t node[MOST], n = card->nodes < MOST ? card->nodes : MOST;
    vs_word inner[MOST];
    for (size_t m = 0; m < n; m++)
      node[m] = node_number(s, path, vs_cards_word(c, card, m), outer, numbers, n_outer);
    if (card->letter != 'x') {
      if (n >= (card->letter == 'q' ? 3 : 2)) take_tie(s, card, node);
      continue;
    }
    size_t called = vs_cards_called(c, card);
    const vs_netlist_card *head = called ? &c->card[c->scope[called].first - 1] : NULL;
    if (!head || head->nodes != n || depth == LATCH_DEPTH || s->calls++ >= MOST_CALLS) continue;
    for (size_t m = 0; m < n; m++) inner[m] = vs_cards_word(c, head, m);
    vs_text within = {0};
    vs_text_add(&within, "%s.%.*s", path, (int)card->name.n, card->name.at);
    take_scope(s, called, within.text, inner, node, n, depth + 1);
    vs_text_free(&within);
  }
}

/* The resistances from a pin to each node, of ways that pass by no other pin, with junctions or by
 * resistors alone. free() them. */
static double *resistances(const latch_search *s, size_t pin, bool junctions) {
  double *ohm = vs_alloc(s->n_nodes, sizeof *ohm);
  for (size_t k = 0; k < s->n_nodes; k++) ohm[k] = k == pin ? 0 : INFINITY;
  for (bool changed = true; changed;) {
    changed = false;
    for (size_t k = 0; k < 2 * s->n_ties; k++) {
      const tie *t = &s->ties[k / 2];
      size_t from = k % 2 ? t->b : t->a, to = k % 2 ? t->a : t->b;
      if ((from < LATCH_PINS && from != pin) || !(ohm[from] + t->ohm < ohm[to])) continue;
      if (t->junction && !junctions) continue;
      ohm[to] = ohm[from] + t->ohm;
      changed = true;
    }
  }
  return ohm;
}

/* The pin to which the gate has at most half of the way that it has to the other one; -1: neither.
 */
static int nearer(const double *ohm, size_t gate) {
  int a = gate == 0, b = 3 - a - (int)gate;
  if (2 * ohm[a] <= ohm[b] && isfinite(ohm[a])) return a;
  if (2 * ohm[b] <= ohm[a] && isfinite(ohm[b])) return b;
  return -1;
}

/* By resistors, else by junctions. A large resistor that says another pin than a junction much
 * nearer may be a leakage as well: then it is not told. */
static int gate_stands_on(const latch_search *s, size_t gate) {
  static const double MUCH = 10;
  double *by_resistors = resistances(s, gate, false), *by_all = resistances(s, gate, true);
  int pin = nearer(by_resistors, gate), other = nearer(by_all, gate);
  if (pin < 0)
    pin = other;
  else if (other >= 0 && other != pin && MUCH * by_all[other] < by_resistors[pin])
    pin = -1;
  free(by_resistors);
  free(by_all);
  return pin;
}

vs_cards_latch vs_cards_see_latch(const vs_cards *cards, size_t scope, int gate) {
  vs_cards_latch latch = {.gate = gate, .near = -1};
  const vs_netlist_card *head = &cards->card[cards->scope[scope].first - 1];
  latch_search *s = vs_alloc(1, sizeof *s);
  *s = (latch_search){.cards = cards, .n_nodes = LATCH_PINS};
  static const size_t PINS[LATCH_PINS] = {0, 1, 2};
  vs_word outer[LATCH_PINS];
  bool type[LATCH_PINS][2] = {{false}};
  for (size_t k = 0; k < LATCH_PINS; k++) outer[k] = vs_cards_word(cards, head, k);
  if (head->nodes == LATCH_PINS) take_scope(s, scope, "", outer, PINS, LATCH_PINS, 0);
  int without = 0;
  for (size_t pin = 0; pin < LATCH_PINS && s->n_ties; pin++) {
    double *ohm = resistances(s, pin, false);
    for (size_t k = 0; k < s->n_emitters; k++)
      if (ohm[s->emitter[k].node] <= AT_A_PIN_OHM) type[pin][s->emitter[k].type == 'p'] = true;
    free(ohm);
    if (type[pin][0] || type[pin][1]) continue;
    without++;
    if (gate < 0) latch.gate = (int)pin;
  }
  if (gate < 0 && (without != 1 || !s->n_emitters)) latch.gate = -1;
  for (int t = 0; t < 2; t++)
    latch.two_ways = latch.two_ways || type[0][t] + type[1][t] + type[2][t] > 1;
  bool whole = s->n_ties < MOST_TIES && s->calls < MOST_CALLS;
  if (whole && latch.gate >= 0) latch.near = gate_stands_on(s, (size_t)latch.gate);
  vs_names_free(&s->nodes);
  free(s);
  return latch;
}

/* ---- unfolded ---- */

static bool expand_instance(const vs_cards *c, const vs_instance *in, vs_cards_visit *visit,
                            void *ctx) {
  const vs_netlist_scope *of = &c->scope[in->scope];
  for (size_t k = of->first; k < of->last; k = vs_cards_next(c, k)) {
    if (c->card[k].kind != VS_CARDS_ELEMENT) continue;
    const int next = visit(ctx, in, k);
    if (next == VS_CARDS_STOP) return false;
    if (next != VS_CARDS_ENTER) continue;
    const vs_instance inner = {in, &c->card[k], vs_cards_called(c, &c->card[k]), in->depth + 1};
    if (!expand_instance(c, &inner, visit, ctx)) return false;
  }
  return true;
}

bool vs_cards_expand(const vs_cards *c, vs_cards_visit *visit, void *ctx) {
  return expand_instance(c, &(vs_instance){0}, visit, ctx);
}

void vs_cards_add_name(const vs_instance *in, vs_word name, vs_text *out) {
  const size_t begin = out->length;
  if (in->outer) vs_cards_add_name(in->outer, in->card->name, out);
  vs_text_add(out, "%s%.*s", in->outer ? "." : "", (int)name.n, name.at);
  vs_cursor_lower(out->text + begin);
}

void vs_cards_add_node(const vs_cards *c, const vs_instance *in, vs_word node, vs_text *out) {
  for (; in->outer && !vs_words_is_ground(node); in = in->outer) {
    const vs_netlist_card *head = &c->card[c->scope[in->scope].first - 1];
    size_t k = 0;
    while (k < head->nodes && vs_words_compare(vs_cards_word(c, head, k), node)) k++;
    if (k == head->nodes) break;
    node = k < in->card->nodes ? vs_cards_word(c, in->card, k) : vs_words_of("0");
  }
  static const vs_instance CIRCUIT = {0};
  const bool ground = vs_words_is_ground(node);
  const bool outside = ground || vs_names_find(&c->globals, node.at, node.n, NULL);
  vs_cards_add_name(outside ? &CIRCUIT : in, ground ? vs_words_of("0") : node, out);
}
