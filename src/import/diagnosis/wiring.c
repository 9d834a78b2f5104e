/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnosis/wiring.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/rules.h"
#include "netlist/words.h"

/* Limits beyond which the rest of a deck is not examined. */
enum { MOST_WIRES = 20000, MOST_DEPTH = 16 };

/* The subcircuit instance that is being opened: the inner names of its pins, and the nodes they are
 * connected to. */
typedef struct scope {
  vs_wiring *wiring;
  char path[VS_WIRING_NAME]; /* "xa.xb."; empty at the top */
  vs_word formal[VS_WIRING_PINS];
  int actual[VS_WIRING_PINS];
  int n_formal, depth;
} scope;

static void open_lines(const scope *s, size_t from, size_t to);

/* ---- words and nodes ---- */

static char *copy_word(vs_word w) {
  char *copy = vs_alloc_part(w.at, w.n);
  vs_cursor_lower(copy);
  return copy;
}

/* Lists the first line of each model and subcircuit. */
static void list_statements(vs_wiring *wiring) {
  static const char *const LISTED[] = {".model", ".subckt"};
  const vs_deck *deck = wiring->deck;
  vs_word w[VS_WORDS_MOST];
  for (size_t k = 0; k < deck->n_lines; k++)
    for (size_t i = 0; i < sizeof LISTED / sizeof *LISTED; i++) {
      if (!vs_words_begin(deck->lines[k].text, LISTED[i]) ||
          vs_words_split(deck->lines[k].text, w) < 2 || (w[1].n = strcspn(w[1].at, " \t(")) == 0)
        continue;
      vs_text key = {0};
      vs_text_add(&key, "%s %.*s", LISTED[i], (int)w[1].n, w[1].at);
      if (!vs_names_find(&wiring->statements, key.text, key.length, NULL))
        vs_names_put(&wiring->statements, key.text, k);
      vs_text_free(&key);
    }
}

const vs_line *vs_wiring_statement(const vs_wiring *wiring, const char *statement,
                                   const char *name) {
  vs_text key = {0};
  size_t k;
  vs_text_add(&key, "%s %s", statement, name);
  bool found = vs_names_find(&wiring->statements, key.text, key.length, &k);
  vs_text_free(&key);
  return found ? &wiring->deck->lines[k] : NULL;
}

/* Lists the nodes of lines .global. */
static void list_globals(vs_wiring *wiring) {
  const vs_deck *deck = wiring->deck;
  vs_word w[VS_WORDS_MOST];
  for (size_t k = 0; k < deck->n_lines; k++) {
    if (!vs_words_begin(deck->lines[k].text, ".global")) continue;
    const size_t n = vs_words_split(deck->lines[k].text, w);
    for (size_t i = 1; i < n; i++) {
      char *name = copy_word(w[i]);
      vs_names_put(&wiring->globals, name, k);
      free(name);
    }
  }
}

static int take_node(vs_wiring *w, const char *name) {
  size_t known;
  if (vs_names_find(&w->numbers, name, strlen(name), &known)) return (int)known;
  w->nodes = vs_alloc_grow(w->nodes, w->n_nodes, sizeof *w->nodes);
  snprintf(w->nodes[w->n_nodes], sizeof *w->nodes, "%s", name);
  vs_names_put(&w->numbers, name, w->n_nodes);
  return (int)w->n_nodes++;
}

/* The node that a word stands for inside the subcircuit. */
static int node_of(const scope *s, vs_word word) {
  char name[VS_WIRING_NAME];
  if (vs_words_is_ground(word)) return 0;
  for (int k = 0; k < s->n_formal; k++)
    if (s->formal[k].n == word.n && !strncasecmp(s->formal[k].at, word.at, word.n))
      return s->actual[k];
  bool global = s->depth > 0 && vs_names_find(&s->wiring->globals, word.at, word.n, NULL);
  snprintf(name, sizeof name, "%.80s%.*s", global ? "" : s->path, word.n < 40 ? (int)word.n : 40,
           word.at);
  vs_cursor_lower(name);
  return take_node(s->wiring, name);
}

static void add_look(vs_wire *wire, int node) {
  if (wire->n_looks < VS_WIRING_LOOKS) wire->looks[wire->n_looks++] = node;
}

/* ---- laws ---- */

/* Adds "v(n,m)" with the solver's names; `text` begins after "v(". Returns the text after the ')'.
 */
static const char *add_voltage(const scope *s, vs_wire *wire, const char *text, vs_text *law) {
  vs_text_add(law, "v(");
  for (int k = 0;; k++) {
    text += strspn(text, " \t,");
    size_t n = strcspn(text, " \t,)");
    if (n == 0) break;
    int node = node_of(s, (vs_word){text, n});
    add_look(wire, node);
    vs_text_add(law, "%s%s", k ? "," : "", s->wiring->nodes[node]);
    text += n;
  }
  vs_text_add(law, ")");
  return text + (*text == ')');
}

/* The solver's name of a source inside the subcircuit: "vs", "v.xa.vs". */
static void add_current(const scope *s, vs_word name, vs_text *law) {
  char *low = copy_word(name);
  if (s->depth)
    vs_text_add(law, "i(%c.%s%s)", *low, s->path, low);
  else
    vs_text_add(law, "i(%s)", low);
  free(low);
}

/* Copies an expression with the solver's names of nodes and sources. */
static void add_expression(const scope *s, vs_wire *wire, const char *text, vs_text *law) {
  for (const char *c = text; *c;) {
    bool word = c > text && vs_words_goes_on(c[-1]);
    size_t blank = strspn(c + 1, " \t");
    bool call = !word && c[1 + (*c ? blank : 0)] == '(';
    if (call && (*c == 'v' || *c == 'V')) {
      c = add_voltage(s, wire, c + 2 + blank, law);
    } else if (call && (*c == 'i' || *c == 'I')) {
      const char *name = c + 2 + blank + strspn(c + 2 + blank, " \t");
      size_t n = strcspn(name, " \t)");
      add_current(s, (vs_word){name, n}, law);
      c = name + n + strspn(name + n, " \t");
      c += *c == ')';
    } else
      vs_text_add(law, "%c", *c++);
  }
}

/* True for a word after the pins of E and G that begins an expression. */
static bool begins_expression(vs_word w) {
  static const char *const WORDS[] = {"value", "table", "laplace", "vol", "cur", "{", "freq"};
  for (size_t k = 0; k < sizeof WORDS / sizeof *WORDS; k++)
    if (!strncasecmp(w.at, WORDS[k], strlen(WORDS[k]))) return true;
  return false;
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

/* Finds what controls the element's value. */
static void take_law(const scope *s, vs_wire *wire, const vs_word *w, size_t count) {
  vs_text law = {0};
  bool source = strchr("eg", wire->letter), poly = count > 3 && !strncasecmp(w[3].at, "poly", 4);
  if (count < 4) return;
  if (strchr("fhw", wire->letter) && !poly)
    add_current(s, w[3], &law);
  else if (source && poly)
    add_poly(s, wire, w[3].at);
  else if (wire->letter == 's' || (source && !begins_expression(w[3]))) {
    vs_word pair[] = {w[3], w[count > 4 ? 4 : 3]};
    int plus = node_of(s, pair[0]), minus = node_of(s, pair[1]);
    add_look(wire, plus);
    add_look(wire, minus);
    vs_text_add(&law, "v(%s,%s)", s->wiring->nodes[plus], s->wiring->nodes[minus]);
  } else if (strchr("begrclfh", wire->letter))
    add_expression(s, wire, w[3].at, &law);
  wire->law = law.text;
}

/* ---- elements ---- */

static int count_pins(const vs_wiring *wiring, char letter, const vs_word *w, size_t count) {
  static const char LETTERS[] = "rclvidbfhwegstjqmzuo", COUNTS[] = "22222222222224334334";
  const char *at = strchr(LETTERS, letter);
  if (!at) return 0;
  int pins = COUNTS[at - LETTERS] - '0';
  if (letter != 'q' && letter != 'm') return pins;
  for (size_t k = 4; k < count && k < 8; k++) { /* a substrate, a bulk and more may follow */
    char *name = copy_word(w[k]);
    bool model = vs_wiring_statement(wiring, ".model", name);
    free(name);
    if (model) return (int)k - 1;
  }
  return pins;
}

static vs_wire *add_wire(vs_wiring *w) {
  w->wires = vs_alloc_grow(w->wires, w->count, sizeof *w->wires);
  w->wires[w->count] = (vs_wire){0};
  return &w->wires[w->count++];
}

static vs_wire *begin_wire(const scope *s, const vs_line *line, vs_word name) {
  vs_wire *wire = add_wire(s->wiring);
  wire->line = line;
  wire->letter = (char)tolower((unsigned char)*line->text);
  snprintf(wire->name, sizeof wire->name, "%.80s%.*s", s->path, name.n < 40 ? (int)name.n : 40,
           name.at);
  vs_cursor_lower(wire->name);
  return wire;
}

static void open_element(const scope *s, const vs_line *line) {
  vs_word w[VS_WORDS_MOST];
  size_t count = vs_words_split(line->text, w);
  int pins = count ? count_pins(s->wiring, (char)tolower((unsigned char)*line->text), w, count) : 0;
  if (pins == 0 || (size_t)pins >= count) return;
  vs_wire *wire = begin_wire(s, line, w[0]);
  for (int k = 0; k < pins; k++) wire->pins[wire->n_pins++] = node_of(s, w[k + 1]);
  take_law(s, wire, w, count);
  size_t model = strchr("sw", wire->letter)     ? (wire->letter == 's' ? 5 : 4)
                 : strchr("djqm", wire->letter) ? (size_t)pins + 1
                                                : count;
  if (model < count) wire->model = copy_word(w[model]);
  wire->voltage =
      strchr("veh", wire->letter) || (wire->letter == 'b' && count > 3 && strchr("vV", *w[3].at));
}

/* ---- instances ---- */

/* The name of the subcircuit that the line is an instance of. A parameter that selects a part
 * stands for the part's subcircuit. */
static char *subcircuit_of(const vs_deck *deck, const vs_line *line, const char **name) {
  size_t n = 0;
  *name = vs_rules_instance_of(line->text, &n);
  char *kind = copy_word((vs_word){*name ? *name : "", n});
  for (size_t p = 0; p < deck->n_parts; p++)
    if (!strcasecmp(deck->parts[p].name, kind)) {
      free(kind);
      return copy_word(vs_words_of(deck->parts[p].subcircuit));
    }
  return kind;
}

/* The index of the .ends line that closes the .subckt of line `from`. */
static size_t end_of(const vs_deck *deck, size_t from) {
  int depth = 0;
  for (size_t k = from; k < deck->n_lines; k++) {
    depth += vs_words_begin(deck->lines[k].text, ".subckt");
    if (vs_words_begin(deck->lines[k].text, ".ends") && --depth == 0) return k;
  }
  return deck->n_lines;
}

static void read_formals(const vs_line *head, scope *inner) {
  vs_word w[VS_WORDS_MOST];
  size_t n = vs_words_split(head->text, w);
  for (size_t k = 2; k < n && inner->n_formal < VS_WIRING_PINS; k++) {
    bool more = k + 1 < n && *w[k + 1].at == '=';
    if (memchr(w[k].at, '=', w[k].n) || more || !strncasecmp(w[k].at, "params:", 7) ||
        !strncasecmp(w[k].at, "optional:", 9))
      break;
    inner->formal[inner->n_formal++] = w[k];
  }
}

static void open_instance(const scope *s, const vs_line *line) {
  const vs_deck *deck = s->wiring->deck;
  const char *name = NULL;
  vs_word w[VS_WORDS_MOST];
  size_t count = vs_words_split(line->text, w), pins = 0;
  char *kind = subcircuit_of(deck, line, &name);
  const vs_line *head = vs_wiring_statement(s->wiring, ".subckt", kind);
  while (name && pins + 1 < count && w[pins + 1].at < name) pins++;
  free(kind);
  if (head && s->depth < MOST_DEPTH) {
    scope inner = {.wiring = s->wiring, .depth = s->depth + 1};
    snprintf(inner.path, sizeof inner.path, "%.80s%.*s.", s->path, w[0].n < 40 ? (int)w[0].n : 40,
             w[0].at);
    vs_cursor_lower(inner.path);
    read_formals(head, &inner);
    for (size_t k = 0; k < (size_t)inner.n_formal; k++)
      inner.actual[k] = k < pins ? node_of(s, w[k + 1]) : 0;
    size_t from = (size_t)(head - deck->lines);
    open_lines(&inner, from + 1, end_of(deck, from));
    return;
  }
  if (head) s->wiring->whole = false;
  vs_wire *wire = begin_wire(s, line, w[0]);
  for (size_t k = 0; k < pins && k < VS_WIRING_PINS; k++)
    wire->pins[wire->n_pins++] = node_of(s, w[k + 1]);
}

/* A code model's nodes, with or without brackets: all of them are connected. */
static void open_code_model(const scope *s, const vs_line *line) {
  vs_word w[VS_WORDS_MOST];
  size_t count = vs_words_split(line->text, w);
  vs_wire *wire = begin_wire(s, line, w[0]);
  wire->letter = 'x';
  for (size_t k = 1; k + 1 < count; k++)
    for (const char *c = w[k].at; c < w[k].at + w[k].n;) {
      size_t skip = strspn(c, "[]() \t,~"), n = strcspn(c + skip, "[]() \t,~");
      if (n && c[skip] != '%' && wire->n_pins < VS_WIRING_PINS)
        wire->pins[wire->n_pins++] = node_of(s, (vs_word){c + skip, n});
      c += skip + n;
    }
}

static void open_lines(const scope *s, size_t from, size_t to) {
  const vs_deck *deck = s->wiring->deck;
  for (size_t k = from; k < to; k++) {
    const vs_line *line = &deck->lines[k];
    if (s->wiring->count >= MOST_WIRES) s->wiring->whole = false;
    if (!s->wiring->whole) return;
    if (vs_words_begin(line->text, ".subckt"))
      k = end_of(deck, k);
    else if (strchr("xX", *line->text))
      open_instance(s, line);
    else if (strchr("aA", *line->text))
      open_code_model(s, line);
    else if (isalpha((unsigned char)*line->text))
      open_element(s, line);
  }
}

void vs_wiring_open(vs_wiring *w, const vs_deck *deck) {
  *w = (vs_wiring){.deck = deck, .whole = true};
  const scope top = {.wiring = w};
  list_statements(w);
  list_globals(w);
  take_node(w, "0");
  open_lines(&top, 0, deck->n_lines);
}

void vs_wiring_free(vs_wiring *w) {
  for (size_t k = 0; k < w->count; k++) {
    free(w->wires[k].law);
    free(w->wires[k].model);
  }
  free(w->wires);
  free(w->nodes);
  vs_names_free(&w->numbers);
  vs_names_free(&w->globals);
  vs_names_free(&w->statements);
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
