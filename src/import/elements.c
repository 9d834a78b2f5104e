/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/elements.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/cursor.h"
#include "netlist/cards.h"

/* ---- words ---- */

static const char *text_of(const vs_elements *w, const vs_element *e) {
  return w->listing->cards[e->card].text;
}

/* Splits a line into words; a bracket and its contents belong to the word before them. */
static int split(const char *text, vs_elements_word words[VS_ELEMENTS_WORDS]) {
  int count = 0;
  for (const char *s = text; *(s += strspn(s, " \t,")) && count < VS_ELEMENTS_WORDS;) {
    const char *begin = s;
    int depth = 0;
    bool quoted = false;
    for (; *s && (depth > 0 || quoted || !strchr(" \t,", *s)); s++) {
      if (*s == '\'' || *s == '"') quoted = !quoted;
      depth += (*s == '{' || *s == '(') - (*s == '}' || *s == ')');
    }
    words[count++] = (vs_elements_word){(int)(begin - text), (int)(s - begin)};
  }
  return count;
}

char *vs_elements_word_of(const vs_elements *w, const vs_element *e, int n) {
  return n < e->n_words ? vs_alloc_part(text_of(w, e) + e->words[n].at, (size_t)e->words[n].size)
                        : vs_copy("");
}

char *vs_elements_rest_of(const vs_elements *w, const vs_element *e, int n) {
  return vs_copy(n < e->n_words ? text_of(w, e) + e->words[n].at : "");
}

char *vs_elements_option(const vs_elements *w, const vs_element *e, const char *name) {
  const vs_cards *c = &w->listing->netlist;
  const vs_word value = vs_cards_value(c, &c->card[e->card], name);
  return value.n ? vs_alloc_part(value.at, value.n) : NULL;
}

bool vs_elements_number(const vs_elements *w, const vs_values *v, const vs_element *e,
                        const char *name, double *value) {
  char *text = vs_elements_option(w, e, name);
  const bool known = text && vs_values_of(v, text, value);
  free(text);
  return known;
}

bool vs_elements_sets(const vs_elements *w, const vs_values *v, const vs_element *e,
                      const char *name) {
  double value = 1;
  char *text = vs_elements_option(w, e, name);
  const bool sets = text && !(vs_values_of(v, text, &value) && value == 0);
  free(text);
  return sets;
}

bool vs_elements_has_model(const vs_elements *w, const vs_element *e) {
  bool found = false;
  for (int n = e->n_nodes + 1; n < e->n_words && !found; n++) {
    char *word = vs_elements_word_of(w, e, n);
    found = isalpha((unsigned char)*word) && vs_elements_defined(w->listing, word) >= 0;
    free(word);
  }
  return found;
}

vs_where vs_elements_where(const vs_elements *w, const vs_element *e, int n) {
  const vs_card *card = &w->listing->cards[e->card];
  vs_where where = card->where;
  size_t first = strcspn(card->raw, "\n");
  size_t at = n < e->n_words ? (size_t)e->words[n].at : 0;
  if (at + (size_t)where.column <= first)
    where.column += vs_text_column(card->text, card->text + at) - 1;
  return where;
}

/* ---- models ---- */

int vs_elements_defined(const vs_listing *l, const char *model) {
  for (size_t k = 0; k < l->netlist.n_definitions; k++) {
    const vs_netlist_definition *d = &l->netlist.definition[k];
    if ((d->kind == VS_CARDS_MODEL || d->kind == VS_CARDS_SUBCKT) && vs_words_is(d->name, model))
      return (int)d->card;
  }
  return -1;
}

/* The index of the first word, from `from` on, that names a model or subcircuit; 0: there is none.
 */
static int word_of_model(const vs_elements *w, const vs_element *e, int from) {
  int found = 0;
  for (int k = from; k < e->n_words && !found; k++) {
    char *word = vs_elements_word_of(w, e, k);
    if (vs_elements_defined(w->listing, word) >= 0) found = k;
    free(word);
  }
  return found;
}

char *vs_elements_model(const vs_elements *w, const vs_element *e) {
  const vs_word called = w->listing->netlist.card[e->card].model;
  char *name = NULL;
  if (e->letter == 'x' && called.n) name = vs_alloc_part(called.at, called.n);
  if (strchr("dqmjsw", e->letter))
    name = vs_elements_word_of(w, e, e->n_nodes + (e->letter == 'w' ? 2 : 1));
  if (name) vs_cursor_lower(name);
  return name;
}

/* ---- nodes ---- */

/* The number of an element's nodes, by its letter. */
static int count_nodes(const vs_elements *w, const vs_element *e) {
  static const char *const TWO[] = {"value", "poly", "table", "laplace", "vol", "cur", "{", "freq"};
  static const char LETTERS[] = "rclvidbfhwegstjqmzu", COUNTS[] = "2222222222444433433";
  const char *letter = strchr(LETTERS, e->letter);
  const vs_word called = w->listing->netlist.card[e->card].model;
  if (e->letter == 'x') { /* brackets may belong to a node's name, and not to a card's word */
    int k = 1;
    while (called.n && k < e->n_words && text_of(w, e) + e->words[k].at < called.at) k++;
    return called.n ? k - 1 : 0;
  }
  if (e->letter == 'a') return w->listing->origin == VS_ORIGIN_LTSPICE ? 8 : 0;
  if (!letter) return 0;
  int count = COUNTS[letter - LETTERS] - '0';
  if (strchr("eg", e->letter)) {
    char *third = vs_elements_word_of(w, e, 3);
    for (size_t k = 0; k < sizeof TWO / sizeof *TWO; k++)
      if (!strncasecmp(third, TWO[k], strlen(TWO[k]))) count = 2;
    free(third);
  }
  int model = strchr("qmj", e->letter) ? word_of_model(w, e, 4) : 0;
  return model ? model - 1 : count;
}

/* Writes `said` as a name that ngspice and the contract allow: other characters become '_', a '+'
 * or '-' at the end 'p' or 'n'. */
static void clean(const char *said, char name[VS_ELEMENTS_NAME]) {
  size_t n = 0, end = strlen(said);
  for (size_t k = 0; k < end && n + 2 < VS_ELEMENTS_NAME; k++) {
    char c = (char)tolower((unsigned char)said[k]);
    if (isalnum((unsigned char)c) && !((unsigned char)c & 0x80))
      name[n++] = c;
    else if (k + 1 == end && k > 0 && (c == '+' || c == '-'))
      name[n++] = c == '+' ? 'p' : 'n';
    else if (n > 0 && name[n - 1] != '_')
      name[n++] = '_';
  }
  while (n > 0 && name[n - 1] == '_') n--;
  name[n] = '\0';
  if (!strcmp(name, "ac") || !strcmp(name, "dc")) strcat(name, "_net"); /* words of a source */
}

/* True for a name that a program made up for a net without one. */
static bool is_made_up(const char *said) {
  const char *s = said;
  if (!strcmp(said, "n") || !strcmp(said, "net")) return false;
  if (strstr(said, "net-") == said || strstr(said, "unconnected-")) return true;
  if (*s == 'n') s++;
  if (!strncmp(s, "et", 2)) s += 2;
  return strspn(s, "0123456789_") == strlen(s);
}

/* True for a name that ngspice would misread in a source's line or in an output. */
static bool is_word_of_ngspice(const char *name) {
  return !strcmp(name, "ac") || !strcmp(name, "value") || !strcmp(name, "time");
}

static bool has(const vs_names *names, const char *name) {
  return vs_names_find(names, name, strlen(name), NULL);
}

/* Of several with the same name the first counts. */
static void put(vs_names *names, const char *name, size_t number) {
  if (!has(names, name)) vs_names_put(names, name, number);
}

static int find_node(const vs_elements *w, const char *said) {
  size_t number;
  return vs_names_find(&w->said, said, strlen(said), &number) ? (int)number : -1;
}

static int take_node(vs_elements *w, char *said) {
  vs_cursor_lower(said);
  int found = find_node(w, said);
  if (found >= 0) return found;
  vs_elements_node node = {.named = !is_made_up(said)};
  char name[VS_ELEMENTS_NAME];
  snprintf(node.said, sizeof node.said, "%s", said);
  clean(said, name);
  bool ground = vs_words_is_ground(vs_words_of(said));
  if (!*name || !strcmp(name, "gnd") || (!ground && !strcmp(name, "0"))) strcpy(name, "net");
  if (is_word_of_ngspice(name)) strcat(name, "_net");
  snprintf(node.name, sizeof node.name, "%s", ground ? "0" : name);
  for (int k = 2; !ground && has(&w->names, node.name); k++)
    snprintf(node.name, sizeof node.name, "%.50s_%d", name, k);
  w->nodes = vs_alloc_grow(w->nodes, w->n_nodes, sizeof *w->nodes);
  w->nodes[w->n_nodes] = node;
  put(&w->said, node.said, w->n_nodes);
  put(&w->names, node.name, w->n_nodes);
  return (int)w->n_nodes++;
}

const char *vs_elements_node_of(const vs_elements *w, const vs_element *e, int n) {
  return w->nodes[e->nodes[n]].name;
}

/* ---- elements ---- */

/* Names the element. Characters that ngspice or the contract does not allow in a name become '_'.
 */
static void name_element(const vs_elements *w, vs_element *e) {
  char *said = vs_elements_word_of(w, e, 0), name[VS_ELEMENTS_NAME] = "";
  size_t n = 0;
  for (const char *s = said; *s && n + 8 < sizeof name; s++)
    if (isalnum((unsigned char)*s) && !((unsigned char)*s & 0x80))
      name[n++] = *s;
    else if (n > 0 && name[n - 1] != '_')
      name[n++] = '_';
  name[n] = '\0';
  snprintf(e->name, sizeof e->name, "%s", name);
  for (int k = 2; has(&w->by_name, e->name); k++)
    snprintf(e->name, sizeof e->name, "%.50s_%d", name, k);
  snprintf(e->key, sizeof e->key, "%s", e->name);
  vs_cursor_lower(e->key);
  if (e->key[1] == '_' && isalpha((unsigned char)e->key[2]) && !has(&w->by_key, e->key + 2))
    memmove(e->key, e->key + 2, strlen(e->key + 2) + 1);
  snprintf(name, sizeof name, "%s", e->key);
  for (int k = 2; has(&w->by_key, e->key); k++) /* R1 behind R_R1 */
    snprintf(e->key, sizeof e->key, "%.50s_%d", name, k);
  free(said);
}

static vs_status add_element(vs_elements *w, size_t card, vs_error *err) {
  const vs_card *c = &w->listing->cards[card];
  w->elements = vs_alloc_grow(w->elements, w->count, sizeof *w->elements);
  vs_element *e = &w->elements[w->count];
  *e = (vs_element){.card = card, .letter = (char)tolower((unsigned char)*c->text)};
  e->n_words = split(c->text, e->words);
  if (!isalpha((unsigned char)*c->text) || e->n_words < 3)
    return vs_fail_at(err, c->where,
                      "an element is wanted here: 'NAME node node ...', or a statement, or a "
                      "comment");
  name_element(w, e);
  e->n_nodes = count_nodes(w, e);
  if (e->n_nodes >= e->n_words || e->n_nodes > VS_ELEMENTS_NODES)
    return vs_fail_at(err, c->where, "%s wants %d nodes and something behind them", e->name,
                      e->n_nodes);
  for (int k = 0; k < e->n_nodes; k++) {
    char *said = vs_elements_word_of(w, e, k + 1);
    e->nodes[k] = take_node(w, said);
    vs_elements_node *node = &w->nodes[e->nodes[k]];
    node->at[node->ends++ > 0] = w->count;
    free(said);
  }
  char *said = vs_elements_word_of(w, e, 0);
  put(&w->by_said, said, w->count);
  put(&w->by_name, e->name, w->count);
  put(&w->by_key, e->key, w->count);
  free(said);
  w->count++;
  return VS_OK;
}

void vs_elements_source_of(const vs_listing *l, size_t card, vs_element *e) {
  const char *text = l->cards[card].text;
  *e = (vs_element){.card = card, .letter = (char)tolower((unsigned char)*text), .n_nodes = 2};
  e->n_words = split(text, e->words);
  snprintf(e->name, sizeof e->name, "%.*s", (int)strcspn(text, " \t"), text);
}

/* Marks the inductors that K elements couple. */
static void mark_coupled(vs_elements *w) {
  for (size_t k = 0; k < w->count; k++) {
    const vs_element *e = &w->elements[k];
    for (int n = 1; e->letter == 'k' && n < e->n_words; n++) {
      char *word = vs_elements_word_of(w, e, n);
      const vs_element *named = vs_elements_find(w, word);
      if (named) w->elements[named - w->elements].coupled = true;
      free(word);
    }
  }
}

vs_status vs_elements_read(vs_elements *w, const vs_listing *l, vs_error *err) {
  vs_status status = VS_OK;
  w->listing = l;
  for (size_t k = 0; k < l->count && !status; k++)
    if (l->cards[k].kind == VS_CARD_ELEMENT && l->cards[k].depth == 0 && !l->cards[k].included)
      status = vs_error_keep(err, add_element(w, k, err));
  mark_coupled(w);
  return status;
}

void vs_elements_free(vs_elements *w) {
  free(w->elements);
  free(w->nodes);
  vs_names_free(&w->said);
  vs_names_free(&w->names);
  vs_names_free(&w->by_said);
  vs_names_free(&w->by_name);
  vs_names_free(&w->by_key);
  *w = (vs_elements){0};
}

const vs_element *vs_elements_find(const vs_elements *w, const char *name) {
  size_t size = strlen(name), found = w->count, other;
  vs_names_find(&w->by_said, name, size, &found);
  if (vs_names_find(&w->by_name, name, size, &other) && other < found) found = other;
  if (found == w->count) vs_names_find(&w->by_key, name, size, &found);
  return found < w->count ? &w->elements[found] : NULL;
}

const vs_element *vs_elements_next(const vs_elements *w, const vs_element *e, int node) {
  const vs_elements_node *n = &w->nodes[node];
  if (n->ends != 2 || !strcmp(n->name, "0")) return NULL;
  const vs_element *first = &w->elements[n->at[0]], *last = &w->elements[n->at[1]];
  return last != e ? last : first != e ? first : NULL;
}

bool vs_elements_is_taken(const vs_elements *w, const char *name) {
  return has(&w->names, name) || has(&w->by_name, name);
}

/* ---- renaming ---- */

/* Adds a word, which may be a node's name. */
static void add_word(const vs_elements *w, const char *word, int size, vs_text *out) {
  char *said = vs_alloc_part(word, (size_t)size);
  vs_cursor_lower(said);
  int node = find_node(w, said);
  bool other = node >= 0 && strcmp(w->nodes[node].name, said) != 0;
  vs_text_add(out, "%.*s", other ? 0 : size, word);
  if (other) vs_text_add(out, "%s", w->nodes[node].name);
  free(said);
}

/* Adds the nodes in the brackets of v( ), which begin at `s`. Returns where they end. */
static const char *add_nodes(const vs_elements *w, const char *s, vs_text *out) {
  while (*s && *s != ')') {
    size_t n = strcspn(s, " \t,)");
    if (n) add_word(w, s, (int)n, out);
    s += n;
    if (*s && *s != ')') vs_text_add(out, "%c", *s++);
  }
  return s;
}

void vs_elements_rename(const vs_elements *w, const char *text, vs_text *out) {
  int depth = 0;
  vs_text_add(out, "%s", "");
  for (const char *s = text; *s;) {
    bool parted = s == text || !(isalnum((unsigned char)s[-1]) || s[-1] == '_');
    size_t n = strcspn(s, " \t,(){}'\"=");
    if (parted && tolower((unsigned char)*s) == 'v' && s[1] == '(') {
      vs_text_add(out, "%.2s", s);
      s = add_nodes(w, s + 2, out);
    } else if (n > 0 && depth == 0 && (s == text || strchr(" \t,", s[-1])) && s[n] != '(' &&
               s[n] != '=') {
      if (s == text)
        vs_text_add(out, "%.*s", (int)n, s);
      else
        add_word(w, s, (int)n, out);
      s += n;
    } else {
      depth += (*s == '{' || *s == '(') - (*s == '}' || *s == ')');
      vs_text_add(out, "%c", *s++);
    }
  }
}
