/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macromodel/circuit_states.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/formula.h"
#include "base/names.h"
#include "base/text.h"
#include "netlist/numbers.h"
#include "netlist/words.h"

/* Bounds of what is taken apart; a netlist beyond them has no list. 48 words are more than any
 * device of ngspice has nodes; 12 levels are more than makers nest subcircuits; a path of 80 bytes
 * leaves room for a node's name behind it in VS_CIRCUIT_STATE_NAME. */
enum { MOST_WORDS = 48, MOST_DEPTH = 12, MOST_PATH = 80 };

/* The words of a line before its parameters (NAME = ..., params:), in lower case. */
typedef struct words {
  char text[1024];
  const char *word[MOST_WORDS];
  size_t count;
  bool cut; /* there were more than there is room for */
} words;

static void split_into_words(const char *line, words *w) {
  w->count = 0;
  w->cut = strlen(line) >= sizeof w->text;
  size_t used = 0;
  for (const char *s = line + strspn(line, VS_WORDS_BETWEEN); *s;) {
    size_t n = vs_words_at(s).n;
    const char *after = vs_words_next(s);
    if (memchr(s, '=', n) || *after == '=' || !strncasecmp(s, "params:", 7)) break;
    if (w->count == MOST_WORDS || used + n + 1 > sizeof w->text) {
      w->cut = true;
      break;
    }
    char *word = w->text + used;
    memcpy(word, s, n);
    word[n] = '\0';
    vs_cursor_lower(word);
    w->word[w->count++] = word;
    used += n + 1;
    s = after;
  }
}

/* A level of the netlist: the deck, or an instance of a subcircuit. Its lines are first to last -
 * 1, without those of subcircuits that are defined there. */
typedef struct level {
  const struct level *home; /* the level of its definition, whose subcircuits it may use */
  size_t first, last;
  char path[VS_CIRCUIT_STATE_NAME]; /* "" or "xa.xb." */
  words inner; /* the words of its .subckt line; its nodes are those from 2 on */
  char names[MOST_WORDS][VS_CIRCUIT_STATE_NAME]; /* names in the whole circuit of the nodes that the
                                             instance is connected to */
  size_t n_nodes;
  int depth;
} level;

typedef struct search {
  const vs_deck *deck;
  vs_names globals;            /* the nodes of its lines .global */
  vs_names definitions, twins; /* lines .subckt that stand in no other; the names that two have */
  vs_names functions;          /* that the netlist defines itself */
  bool branching, reading;     /* the formula of one of these has branches; reads a signal itself */
  vs_circuit_states *all;
} search;

/* True for a statement, which begins with a dot as the word does. */
static bool starts(const vs_line *line, const char *word) {
  if (*line->text != '.') return false;
  size_t n = strlen(word);
  return !strncasecmp(line->text, word, n) && !isalnum((unsigned char)line->text[n]);
}

/* Returns the line behind the .ends that closes the .subckt at line k. */
static size_t line_behind_subcircuit(const vs_deck *deck, size_t k) {
  int depth = 0;
  for (; k < deck->n_lines; k++) {
    depth += starts(&deck->lines[k], ".subckt");
    depth -= starts(&deck->lines[k], ".ends");
    if (depth == 0) return k + 1;
  }
  return k;
}

static bool has_name(const vs_names *names, const char *name) {
  return vs_names_find(names, name, strlen(name), NULL);
}

/* True for a line whose formula has branches, or what is as steep as one. */
static bool has_branches(const char *line) {
  static const char *const BRANCHING[] = {
      "u",   "u2",  "uramp", "sgn",   "floor", "ceil",        "int",  "nint", "if",
      "min", "max", "limit", "table", "pwl",   "ternary_fcn", "tanh", "atan", "arctan"};
  if (strpbrk(line, "?<>&|")) return true;
  for (size_t k = 0; k < sizeof BRANCHING / sizeof *BRANCHING; k++)
    if (vs_words_find(line, line, BRANCHING[k], strlen(BRANCHING[k]))) return true;
  return false;
}

/* Takes in a line ".func NAME(...) ..." or ".param NAME(...)=...". */
static void list_function(search *s, const vs_line *line) {
  if (!starts(line, ".func") && !starts(line, ".param")) return;
  const char *at = line->text + strcspn(line->text, " \t");
  char name[VS_CIRCUIT_STATE_NAME];
  size_t n = 0;
  at += strspn(at, " \t");
  while (vs_words_goes_on(at[n])) n++;
  const char *open = at + n + strspn(at + n, " \t");
  if (*open != '(' || n >= sizeof name) return;
  snprintf(name, sizeof name, "%.*s", (int)n, at);
  vs_names_put(&s->functions, name, 0);
  s->branching = s->branching || has_branches(open);
  s->reading = s->reading || vs_words_find(open, open, "v", 1) || vs_words_find(open, open, "i", 1);
}

/* Lists what is looked for by name in all of the deck. */
static void list_names(search *s) {
  const vs_line *lines = s->deck->lines;
  words w;
  for (size_t k = 0; k < s->deck->n_lines; k++) list_function(s, &lines[k]);
  for (size_t k = 0; k < s->deck->n_lines; k++) {
    if (!starts(&lines[k], ".global")) continue;
    split_into_words(lines[k].text, &w);
    for (size_t n = 1; n < w.count; n++) vs_names_put(&s->globals, w.word[n], k);
  }
  for (size_t k = 0; k < s->deck->n_lines; k++) {
    if (!starts(&lines[k], ".subckt")) continue;
    split_into_words(lines[k].text, &w);
    if (w.count > 1 && has_name(&s->definitions, w.word[1])) vs_names_put(&s->twins, w.word[1], k);
    if (w.count > 1) vs_names_put(&s->definitions, w.word[1], k);
    k = line_behind_subcircuit(s->deck, k) - 1;
  }
}

/* Gives the name that a level's node has in the whole circuit. */
static void full_name(const search *s, const level *l, const char *node,
                      char out[VS_CIRCUIT_STATE_NAME]) {
  for (size_t k = 0; k < l->n_nodes; k++)
    if (!strcmp(l->inner.word[k + 2], node)) {
      snprintf(out, VS_CIRCUIT_STATE_NAME, "%s", l->names[k]);
      return;
    }
  if (vs_words_is_ground(vs_words_of(node)))
    snprintf(out, VS_CIRCUIT_STATE_NAME, "0");
  else
    snprintf(out, VS_CIRCUIT_STATE_NAME, "%.80s%.70s", has_name(&s->globals, node) ? "" : l->path,
             node);
}

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

/* Adds a voltage with the threshold that *m says, if it says one. */
static bool add_control(const search *s, const level *l, const char *plus, const char *minus,
                        vs_circuit_state *m) {
  char p[VS_CIRCUIT_STATE_NAME], n[VS_CIRCUIT_STATE_NAME];
  full_name(s, l, plus, p);
  full_name(s, l, minus, n);
  snprintf(m->plus, sizeof m->plus, "v(%.150s)", p);
  snprintf(m->minus, sizeof m->minus, "v(%.150s)", n);
  return add_state(s, m);
}

static bool add_voltage(const search *s, const level *l, const char *plus, const char *minus) {
  vs_circuit_state m = {.threshold = VS_THRESHOLD_NONE};
  return add_control(s, l, plus, minus, &m);
}

/* Adds the current of an inductor or a voltage source, likewise; ngspice calls "l1" of xa.xb
 * l.xa.xb.l1. */
static bool add_current(const search *s, const level *l, const char *element, vs_circuit_state *m) {
  if (*l->path)
    snprintf(m->plus, sizeof m->plus, "i(%c.%.80s%.64s)", *element, l->path, element);
  else
    snprintf(m->plus, sizeof m->plus, "i(%.64s)", element);
  snprintf(m->minus, sizeof m->minus, "v(0)");
  return add_state(s, m);
}

/* Returns the next .model line of that name from *k on, and puts *k behind it; NULL: there is none.
 * Its words are in *w. Models may be local to a subcircuit; all of that name are told. */
static const char *next_model(const vs_deck *deck, const char *model, size_t *k, words *w) {
  while (*k < deck->n_lines) {
    const vs_line *line = &deck->lines[(*k)++];
    if (!starts(line, ".model")) continue;
    split_into_words(line->text, w);
    if (w->count > 1 && !strcmp(w->word[1], model)) return line->text;
  }
  return NULL;
}

/* True where some .model line of that name says one of the words. */
static bool model_says(const vs_deck *deck, const char *model, const char *const *said,
                       size_t count) {
  size_t k = 0;
  words w;
  for (const char *text; (text = next_model(deck, model, &k, &w));)
    for (const char *s = text + 6; *s;) {
      size_t n = 0;
      while (isalnum((unsigned char)s[n]) || s[n] == '_') n++;
      for (size_t c = 0; c < count; c++)
        if (n == strlen(said[c]) && !strncasecmp(s, said[c], n)) return true;
      s += n ? n : 1;
    }
  return false;
}
#define MODEL_SAYS(deck, model, list) model_says(deck, model, list, sizeof list / sizeof *list)

/* True where a model of the element, among its words from `from` on, gives its junctions a charge.
 */
static bool holds_charge(const search *s, const words *w, size_t from) {
  static const char *const CHARGES[] = {"cjo", "cj0", "cj", "cjp", "cjsw", "tt", "cje",
                                        "cjc", "cjs", "tf", "tr",  "cgs",  "cgd"};
  for (size_t k = from; k < w->count; k++)
    if (MODEL_SAYS(s->deck, w->word[k], CHARGES)) return true;
  return false;
}

/* True for a code model whose output is a sum of its inputs times constants: no product, no
 * limiter, no table, which may be as steep as a comparator, and nothing digital, which has levels
 * and delays. */
static bool forgets(const search *s, const words *w) {
  static const char *const STEADY[] = {"gain", "summer"};
  bool steady = false;
  size_t k = 0;
  words model;
  while (next_model(s->deck, w->word[w->count - 1], &k, &model)) {
    steady = false;
    for (size_t n = 0; model.count > 2 && n < sizeof STEADY / sizeof *STEADY; n++)
      steady = steady || !strcmp(model.word[2], STEADY[n]);
    if (!steady) return false;
  }
  return steady;
}

/* Adds what a transistor remembers, and what turns it on: one that conducts above a voltage is a
 * comparator, too. */
static bool add_transistor(const search *s, const level *l, const words *w) {
  const char *const *n = w->word + 1;
  vs_circuit_state m = {.threshold = VS_THRESHOLD_UNKNOWN};
  if (w->count < 5 || !add_control(s, l, n[1], n[2], &m)) return false;
  if (strchr("qj", **w->word) && !holds_charge(s, w, 4)) return true;
  bool good = add_voltage(s, l, n[1], n[0]) && add_voltage(s, l, n[1], n[2]);
  return good && (**w->word == 'q' || add_voltage(s, l, n[0], n[2]));
}

static bool add_states_of_subcircuit(const search *s, const level *l, const words *w);

/* Letters of elements that remember nothing of their own. k couples inductors, whose currents are
 * listed. */
static const char FORGETFUL[] = "bfhikrv";

/* Adds an inductor's current. Returns false for one that is given by a formula: ngspice makes other
 * elements of it, and its current has no such name. */
static bool add_inductor(const search *s, const level *l, const char *line, const words *w) {
  vs_circuit_state m = {.threshold = VS_THRESHOLD_NONE};
  return !strcasestr(line, "v(") && !strcasestr(line, "i(") && add_current(s, l, w->word[0], &m);
}

/* ---- thresholds ---- */

/* Reads the number of a parameter of a model, 0 where the model does not give it. The bracket about
 * the parameters may end right behind it. False: it is a formula. */
static bool is_plain_number_of_model(const char *model, const char *name, double *value) {
  vs_word whole, given;
  *value = 0;
  if (!vs_words_parameter(model, name, &whole, &given)) return true;
  while (given.n && given.at[given.n - 1] == ')') given.n--;
  return vs_numbers_read(given, value);
}

/* Fills the threshold of a switch's control from its .model line: it turns on above vt + |vh| and
 * off below vt - |vh| (ngspice manual, "Switches"). It is unknown where two models have that name,
 * and where it is of another kind, as PSpice's vswitch. */
static void threshold_of(const vs_deck *deck, const char *model, bool by_voltage,
                         vs_circuit_state *m) {
  size_t k = 0, other = 0;
  words w, more;
  double at, half;
  const char *text = next_model(deck, model, &k, &w);
  m->threshold = VS_THRESHOLD_UNKNOWN;
  other = k;
  if (!text || next_model(deck, model, &other, &more)) return;
  if (w.count < 3 || strcmp(w.word[2], by_voltage ? "sw" : "csw")) return;
  text += strcspn(text, "(");
  text += *text == '(';
  if (!is_plain_number_of_model(text, by_voltage ? "vt" : "it", &at) ||
      !is_plain_number_of_model(text, by_voltage ? "vh" : "ih", &half))
    return;
  m->threshold = VS_THRESHOLD_KNOWN;
  m->level[0] = at + fabs(half);
  m->level[1] = at - fabs(half);
}

/* Adds what a switch reads. */
static bool add_control_of_switch(const search *s, const level *l, const words *w) {
  bool by_voltage = *w->word[0] == 's';
  size_t model = by_voltage ? 5 : 4;
  vs_circuit_state m = {.threshold = VS_THRESHOLD_NONE};
  if (w->count <= model) return false;
  threshold_of(s->deck, w->word[model], by_voltage, &m);
  return by_voltage ? add_control(s, l, w->word[3], w->word[4], &m)
                    : add_current(s, l, w->word[3], &m);
}

/* Adds what v(...) or i(...) reads, whose bracket opens there. */
static bool add_read(const search *s, const level *l, char kind, const char *open) {
  vs_word all[VS_WORDS_MOST];
  const char *end;
  char name[2][VS_CIRCUIT_STATE_NAME] = {"0", "0"};
  vs_circuit_state m = {.threshold = VS_THRESHOLD_UNKNOWN};
  size_t count = vs_words_arguments(open, all, &end);
  if (count < 1 || count > 2) return false;
  for (size_t k = 0; k < count; k++) {
    if (all[k].n >= MOST_PATH) return false;
    memcpy(name[k], all[k].at, all[k].n);
    name[k][all[k].n] = '\0';
    vs_cursor_lower(name[k]);
  }
  return kind == 'v' ? add_control(s, l, name[0], name[1], &m) : add_current(s, l, name[0], &m);
}

/* The scope of a formula of which nothing but its form is asked. */
static int any_term(void *ctx, const char *at, const vs_formula_term *term) {
  (void)ctx, (void)at, (void)term;
  return 0;
}

static int any_name(void *ctx, const char *at, const char *name) {
  (void)ctx, (void)at, (void)name;
  return 0;
}

/* The degree in its signals of f of values of degrees a and b: 0 for a constant, 1 for signals
 * times constants, 2 for all else. */
static int degree_of(int f, int a, int b) {
  if (a == 0 && b == 0) return 0;
  if (f == VS_ADD || f == VS_SUBTRACT || f == VS_NEGATE) return a > b ? a : b;
  if (f == VS_MULTIPLY || (f == VS_DIVIDE && b == 0)) return a + b < 2 ? a + b : 2;
  return 2;
}

/* True for a formula that is a sum of signals times constants, behind which nothing follows but
 * parameters as m=2. False for one that cannot be read, too. */
static bool is_linear(const char *text) {
  static const vs_formula_scope SCOPE = {.term = any_term, .name = any_name};
  int degree[VS_FORMULA_DEPTH + 1] = {0}, depth = 0;
  vs_formula f = {0};
  char why[160];
  const char *bad, *end = vs_formula_read(text, &SCOPE, &f, &bad, why, sizeof why);
  for (size_t k = 0; end && k < f.count; k++) {
    int kind = f.ops[k].kind, of = kind - VS_OP_FUNCTION;
    if (kind < VS_OP_FUNCTION)
      degree[depth++] = kind == VS_OP_TERM;
    else if (vs_formula_functions[of].of)
      degree[depth - 1] = degree_of(of, degree[depth - 1], 0);
    else
      depth--, degree[depth - 1] = degree_of(of, degree[depth - 1], degree[depth]);
  }
  vs_formula_free(&f);
  if (!end || degree[0] > 1) return false;
  const char *name = end + strspn(end, " \t}'"), *behind = name;
  while (vs_words_goes_on(*behind)) behind++;
  return !*name || (behind > name && vs_words_is_given(behind));
}

/* True for a line that calls a function of the netlist's own. */
static bool calls_function(const search *s, const char *line) {
  for (const char *at = line; s->functions.count && (at = strchr(at, '(')); at++) {
    const char *end = at;
    while (end > line && strchr(" \t", end[-1])) end--;
    const char *begin = end;
    while (begin > line && vs_words_goes_on(begin[-1])) begin--;
    if (vs_names_find(&s->functions, begin, (size_t)(end - begin), NULL)) return true;
  }
  return false;
}

/* The first v(...) or i(...) from `at` on, *open its bracket; NULL: there is none. */
static const char *next_read(const char *line, const char *at, const char **open) {
  for (; (at = strpbrk(at, "vViI")); at++) {
    *open = at + 1 + strspn(at + 1, " \t");
    if (at > line && !vs_words_goes_on(at[-1]) && **open == '(') return at;
  }
  return NULL;
}

/* Adds every signal that a formula reads which is not linear in them: what they drift by it may
 * make much larger. So may a resistance or capacitance that any formula gives. Returns false where
 * no signal of the line's own shows what is read. */
static bool add_reads(const search *s, const level *l, const char *line) {
  const bool called = (s->branching || s->reading) && calls_function(s, line);
  const char *open, *at = next_read(line, line, &open), *formula = line;
  if (called && s->reading) return false;
  for (const char *c = line; at && c < at; c++)
    if (*c == '=') formula = c + 1 + strspn(c + 1, " \t'");
  if (strchr("beg", *line | 0x20) && !called && !has_branches(line) && is_linear(formula))
    return true;
  for (; at; at = next_read(line, at + 1, &open))
    if (!add_read(s, l, (char)tolower((unsigned char)*at), open)) return false;
  return true;
}

/* Adds what one element remembers. Returns false where no signal shows it. */
static bool add_states_of_element(const search *s, const level *l, const char *line) {
  words w;
  split_into_words(line, &w);
  if (w.cut || w.count < 2) return false;
  const char *const *n = w.word + 1;
  if (strchr("bcegr", **w.word) && !add_reads(s, l, line)) return false;
  if (strchr("efgh", **w.word) && strcasestr(line, "poly")) return false; /* may be a product */
  if (strchr(FORGETFUL, **w.word)) return true;
  switch (**w.word) {
  case 's':
  case 'w':
    return add_control_of_switch(s, l, &w);
  case 'e':
  case 'g':
    return !strcasestr(line, "laplace") && !strcasestr(line, "freq");
  case 'c':
    return w.count > 2 && add_voltage(s, l, n[0], n[1]);
  case 'l':
    return add_inductor(s, l, line, &w);
  case 'd':
    return w.count > 2 && (!holds_charge(s, &w, 3) || add_voltage(s, l, n[0], n[1]));
  case 'q':
  case 'j':
  case 'z':
  case 'm':
    return !strcasestr(line, "thermal") && add_transistor(s, l, &w);
  case 'a':
    return forgets(s, &w);
  case 'x':
    return add_states_of_subcircuit(s, l, &w);
  default:
    return false;
  }
}

static bool take_apart(const search *s, const level *l) {
  for (size_t k = l->first; k < l->last; k++) {
    const vs_line *line = &s->deck->lines[k];
    if (starts(line, ".subckt"))
      k = line_behind_subcircuit(s->deck, k) - 1;
    else if (*line->text != '.' && !add_states_of_element(s, l, line->text))
      return false;
  }
  return true;
}

/* Finds the definition of that name at a level; n_lines: there is none. *twice is set where there
 * are two, which cannot be told apart. */
static size_t definition(const search *s, const level *at, const char *name, bool *twice) {
  const vs_deck *deck = s->deck;
  size_t found = deck->n_lines;
  if (!at->home) { /* the deck, which may have many thousands */
    vs_names_find(&s->definitions, name, strlen(name), &found);
    *twice = *twice || has_name(&s->twins, name);
    return found;
  }
  for (size_t k = at->first; k < at->last; k++) {
    words w;
    if (!starts(&deck->lines[k], ".subckt")) continue;
    split_into_words(deck->lines[k].text, &w);
    if (w.count > 1 && !strcmp(w.word[1], name)) {
      *twice = *twice || found < deck->n_lines;
      found = k;
    }
    k = line_behind_subcircuit(deck, k) - 1;
  }
  return found;
}

/* The subcircuit that an instance names, directly or by a parameter that is a part. */
static const char *name_of(const vs_deck *deck, const char *name) {
  for (size_t p = 0; p < deck->n_parts; p++)
    if (!strcasecmp(name, deck->parts[p].name)) return deck->parts[p].subcircuit;
  return name;
}

/* Finds the definition that holds at a level: its own, or that of the nearest level about it, which
 * becomes *home. Returns n_lines where there is none, or where two are not to be told apart. */
static size_t definition_for(const search *s, const char *name, const level **home) {
  bool twice = false;
  size_t none = s->deck->n_lines, at = definition(s, *home, name, &twice);
  while (at == none && (*home)->home) {
    *home = (*home)->home;
    at = definition(s, *home, name, &twice);
  }
  return twice ? none : at;
}

/* Fills the level of an instance w at level l, whose definition begins at that line. Returns false
 * where its nodes are not as many as the definition's, or its path is longer than there is room. */
static bool enter_subcircuit(const search *s, const level *l, const words *w, size_t at,
                             level *in) {
  split_into_words(s->deck->lines[at].text, &in->inner);
  in->first = at + 1;
  in->last = line_behind_subcircuit(s->deck, at) - 1;
  in->depth = l->depth + 1;
  if (in->inner.cut || w->count != in->inner.count) return false;
  if (strlen(l->path) + strlen(w->word[0]) + 2 >= MOST_PATH) return false;
  in->n_nodes = in->inner.count - 2;
  snprintf(in->path, sizeof in->path, "%.80s%.60s.", l->path, w->word[0]);
  for (size_t k = 0; k < in->n_nodes; k++) full_name(s, l, w->word[k + 1], in->names[k]);
  return true;
}

static bool add_states_of_subcircuit(const search *s, const level *l, const words *w) {
  const level *home = l;
  if (!*l->path && !strcmp(w->word[0], s->deck->eva)) return true;
  if (l->depth == MOST_DEPTH) return false;
  size_t at = definition_for(s, name_of(s->deck, w->word[w->count - 1]), &home);
  if (at == s->deck->n_lines) return false;
  level *in = vs_alloc(1, sizeof *in);
  in->home = home;
  bool good = enter_subcircuit(s, l, w, at, in) && take_apart(s, in);
  free(in);
  return good;
}

bool vs_circuit_states_list(const vs_deck *deck, vs_circuit_states *all) {
  level *top = vs_alloc(1, sizeof *top);
  top->last = deck->n_lines;
  search s = {.deck = deck, .all = all};
  list_names(&s);
  bool good = take_apart(&s, top);
  vs_names_free(&s.globals);
  vs_names_free(&s.definitions);
  vs_names_free(&s.twins);
  vs_names_free(&s.functions);
  free(top);
  return good;
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
