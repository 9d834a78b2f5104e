/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/deck.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "library.h"
#include "netlist/cards.h"
#include "netlist/catalogue.h"
#include "netlist/reserved.h"
#include "netlist/words.h"

const vs_shelf vs_deck_shelf = {"deck", "", ".cir"},
               vs_deck_parts_shelf = {"part", "parts", ".inc"};

const vs_field vs_deck_key = {"deck",
                              VS_NAME,
                              "",
                              "halfwave_snubbed",
                              0,
                              0,
                              false,
                              offsetof(vs_circuit_values, deck),
                              "netlist: a file, or the name of one that comes with the program",
                              NULL,
                              NULL};

const char *const vs_deck_unsure_words[4] = {"", "assumed", "typical", "assumed, typical"},
                  *const vs_deck_unsure_notes[4] = {"", " (assumed)", " (typical)",
                                                    " (assumed, typical)"};

unsigned vs_deck_unsure(vs_cursor *c) {
  return vs_cursor_is(c, "assumed") ? VS_ASSUMED : vs_cursor_is(c, "typical") ? VS_TYPICAL : 0;
}

const char *const vs_deck_standard_names[] = {
    [VS_STANDARD_U_RMS] = "u_rms",       [VS_STANDARD_F_MAINS] = "f_mains",
    [VS_STANDARD_PHASE] = "phase",       [VS_STANDARD_R_SOURCE] = "r_source",
    [VS_STANDARD_L_SOURCE] = "l_source", [VS_STANDARD_EVA_RESISTANCE] = "eva_resistance",
    [VS_STANDARD_EVA_A] = "eva_a"};
_Static_assert(sizeof vs_deck_standard_names / sizeof *vs_deck_standard_names == VS_STANDARD,
               "a name for each parameter of the program's");

bool vs_deck_is_standard(const char *name) {
  return vs_words_among(vs_words_of(name), vs_deck_standard_names, VS_STANDARD);
}

bool vs_deck_has_port(const vs_deck *deck, bool (*is)(const vs_signal *signal)) {
  for (size_t k = 0; k < deck->n_ports; k++)
    if (is(&deck->ports[k].signal)) return true;
  return false;
}

/* The deck owns its fields; its section shows them as constant. */
static vs_field *own_fields(vs_deck *deck) {
  return (vs_field *)(size_t)deck->section.fields;
}

void vs_deck_begin(vs_deck *deck) {
  if (deck->begun) memset(deck, 0, sizeof *deck); /* a literal of its size may go over the stack */
  deck->begun = true;
  deck->cards = vs_alloc(1, sizeof *deck->cards);
  deck->library = vs_alloc(1, sizeof *deck->library);
  deck->section =
      (vs_section){"circuit", vs_alloc(1 + VS_DECK_MOST + VS_DECK_PARTS, sizeof(vs_field)), 1};
  own_fields(deck)[0] = vs_deck_key;
}

/* ---- filling it ---- */

void vs_deck_remark(vs_deck *deck, vs_where where, const char *format, ...) {
  char text[512];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  if (!deck->remarks) deck->remarks = vs_alloc(1, sizeof *deck->remarks);
  vs_error own = {.findings = deck->remarks, .elsewhere = true};
  if (vs_error_keep(&own, vs_fail_at(&own, where, "%s", text)))
    vs_fail(&deck->remarks->item[VS_MOST_FINDINGS - 1], VS_INPUT,
            "the netlist has more that is to be warned of than the %d shown", VS_MOST_FINDINGS - 1);
}

void vs_deck_add_line(vs_deck *deck, vs_line line) {
  deck->lines = vs_alloc_grow(deck->lines, deck->n_lines, sizeof *deck->lines);
  deck->lines[deck->n_lines++] = line;
  vs_deck_changed(deck);
}

void vs_deck_changed(vs_deck *deck) {
  if (deck->cards->card) vs_cards_free(deck->cards);
}

_Static_assert((int)VS_DECK_PARTS <= (int)VS_CARDS_CHOICES, "a choice for each part");

const vs_cards *vs_deck_cards(const vs_deck *deck) {
  static vs_netlist_scope nothing;
  static const vs_cards NONE = {.scope = &nothing, .n_scopes = 1};
  vs_cards *c = deck->cards;
  if (!c) return &NONE; /* the deck was not begun */
  if (!c->card) vs_cards_read(c, deck->lines, deck->n_lines);
  c->n_choices = deck->n_parts;
  for (size_t p = 0; p < deck->n_parts; p++)
    c->choice[p] = (vs_cards_choice){deck->parts[p].name, deck->parts[p].subcircuit};
  return c;
}

vs_status vs_deck_add_field(vs_deck *deck, const vs_field *field, vs_where where, vs_error *err) {
  for (size_t k = 0; k < deck->section.count; k++)
    if (!strcmp(deck->section.fields[k].key, field->key))
      return vs_fail_at(err, where, "param %s stands here a second time%s", field->key,
                        k ? "" : ": that key is the program's");
  if (vs_deck_is_standard(field->key))
    return vs_fail_at(err, where, "param %s is the program's; give yours another name", field->key);
  if (vs_reserved_is_ours(field->key))
    return vs_fail_at(err, where, "param %s: the program makes such names; give yours another name",
                      field->key);
  vs_field *own = &own_fields(deck)[deck->section.count++];
  *own = *field;
  own->key = vs_copy(field->key);
  own->unit = vs_copy(field->unit);
  own->default_text = vs_copy(field->default_text);
  own->text = vs_copy(field->text);
  return VS_OK;
}

int vs_deck_add_term(vs_deck *deck, vs_where where, char quantity, const char *first,
                     const char *second) {
  vs_term term = {.where = where};
  snprintf(term.plus, sizeof term.plus, "%c(%s)", quantity, first);
  snprintf(term.minus, sizeof term.minus, "v(%s)", second);
  for (size_t k = 0; k < deck->n_terms; k++)
    if (!strcmp(deck->terms[k].plus, term.plus) && !strcmp(deck->terms[k].minus, term.minus))
      return (int)k;
  if (deck->n_terms >= VS_DECK_MOST) return -1;
  deck->terms[deck->n_terms++] = term;
  return (int)deck->n_terms - 1;
}

bool vs_deck_is_shipped(const char *file) {
  const vs_shelf parts = {"part", "parts", ""}, decks = {"deck", "", ""};
  char path[VS_PATH_SIZE], whole[VS_PATH_SIZE];
  vs_catalogue_file(file, whole);
  const char *slash = strrchr(whole, '/'), *name = slash ? slash + 1 : whole;
  return (vs_path_shipped(&parts, name, path) && !strcmp(path, whole)) ||
         (vs_path_shipped(&decks, name, path) && !strcmp(path, whole));
}

vs_where vs_deck_mendable(const vs_deck *deck, vs_where where, char *within, size_t size) {
  *within = '\0';
  for (size_t k = deck->n_files; k-- > 0;) { /* who includes a file stands before it */
    if (where.file != deck->files[k] || !deck->included[k].file) continue;
    const char *slash = strrchr(where.file, '/');
    if (!*within)
      snprintf(within, size, " (%.*s:%d:%d)",
               (int)vs_error_file_size(slash ? slash + 1 : where.file),
               slash ? slash + 1 : where.file, where.line, where.column);
    where = deck->included[k];
  }
  return where;
}

/* ---- formulas ---- */

/* The deck and the line that a formula is read for. */
typedef struct formula_scope {
  vs_deck *deck;
  const vs_cursor *line;
} formula_scope;

static vs_where place_in_formula(const formula_scope *scope, const char *at) {
  vs_cursor c = *scope->line;
  c.at = at;
  return vs_cursor_here(&c);
}

static int formula_term(void *ctx, const char *at, const vs_formula_term *term) {
  const formula_scope *scope = ctx;
  return vs_deck_add_term(scope->deck, place_in_formula(scope, at), term->quantity, term->first,
                          term->second);
}

static int formula_name(void *ctx, const char *at, const char *name) {
  const formula_scope *scope = ctx;
  vs_deck *deck = scope->deck;
  for (size_t k = 0; k < deck->n_names; k++)
    if (!strcmp(deck->names[k].name, name)) return (int)k;
  if (deck->n_names >= VS_DECK_MOST) return -1;
  vs_named *named = &deck->names[deck->n_names++];
  snprintf(named->name, sizeof named->name, "%s", name);
  named->where = place_in_formula(scope, at);
  return (int)deck->n_names - 1;
}

vs_status vs_deck_add_formula(vs_deck *deck, vs_cursor *c, const char *follow, vs_formula *formula,
                              vs_error *err) {
  char why[200] = "an operator or the end of the line is wanted here";
  const char *bad = NULL;
  vs_cursor_skip(c);
  size_t n_terms = deck->n_terms, n_names = deck->n_names;
  formula_scope own = {deck, c};
  const vs_formula_scope scope = {.ctx = &own, .term = formula_term, .name = formula_name};
  const char *end = vs_formula_read(c->at, &scope, formula, &bad, why, sizeof why);
  c->at = end ? end : bad;
  vs_cursor_skip(c);
  if (end && (!*c->at || strchr(follow, *c->at))) return VS_OK;
  vs_formula_free(formula);
  deck->n_terms = n_terms; /* what a broken formula seems to name need not be there */
  deck->n_names = n_names;
  return vs_fail_at(err, vs_cursor_here(c), "%s", why);
}

/* Calls each(formula, values) for all formulas of the deck. */
static void each_formula(vs_deck *deck, void (*each)(vs_formula *, const double *),
                         const double *values) {
  for (size_t k = 0; k < deck->losses.count; k++) each(&deck->losses.item[k].formula, values);
  for (size_t k = 0; k < deck->stores.count; k++) each(&deck->stores.item[k].formula, values);
  for (size_t k = 0; k < deck->n_requirements; k++) {
    each(&deck->requirements[k].left, values);
    each(&deck->requirements[k].right, values);
  }
  for (size_t k = 0; k < deck->n_devices; k++) {
    each(&deck->devices[k].voltage, values);
    each(&deck->devices[k].current, values);
    each(&deck->devices[k].flux, values);
  }
}

/* The value of a parameter that formulas name. Error: nobody declared it; the value is NaN then. */
static vs_status find_value(const vs_deck *deck, const vs_named *named,
                            const vs_circuit_values *values, const vs_deck_value *standard,
                            size_t n_standard, double *value, vs_error *err) {
  const char *known[2 * VS_DECK_MOST];
  size_t count = 0;
  *value = NAN;
  for (size_t k = 1; k < deck->section.count; k++) {
    const vs_field *field = &deck->section.fields[k];
    if (field->kind != VS_REAL) continue;
    known[count++] = field->key;
    if (!strcasecmp(field->key, named->name))
      *value = *(const double *)(const void *)((const char *)values + field->offset);
  }
  for (size_t k = 0; k < n_standard; k++) {
    known[count++] = standard[k].name;
    if (!strcmp(standard[k].name, named->name)) *value = standard[k].value;
  }
  if (isnan(*value)) *value = vs_reserved_constant(named->name);
  if (!isnan(*value)) return VS_OK;
  char within[VS_PATH_SIZE];
  const vs_where where = vs_deck_mendable(deck, named->where, within, sizeof within);
  return vs_fail_at(
      err, where, "no parameter '%s' is declared%s%s", named->name, within,
      vs_text_hint(named->name, known, count, "; '*$ param NAME = ...' declares one").text);
}

/* ---- parameters that no source vouches for ---- */

static bool formula_names(const vs_deck *deck, const vs_formula *f, const char *key) {
  for (size_t k = 0; k < f->count; k++) {
    const int name = vs_formula_name_of(&f->ops[k]);
    if (name >= 0 && !strcasecmp(deck->names[name].name, key)) return true;
  }
  return false;
}

/* True where the text names the parameter, or one of .param that is made of it. */
static bool text_names(const vs_cards *c, const char *text, const char *key, int depth) {
  enum { DEEPEST = 8 };
  if (vs_words_find(text, text, key, strlen(key))) return true;
  for (size_t k = 0; k < c->n_definitions && depth < DEEPEST; k++) {
    const vs_netlist_definition *d = &c->definition[k];
    if (d->kind != VS_CARDS_PARAM || d->scope || !vs_words_find(text, text, d->name.at, d->name.n))
      continue;
    char *body = vs_alloc_part(d->body.at, d->body.n);
    const bool names = text_names(c, body, key, depth + 1);
    free(body);
    if (names) return true;
  }
  return false;
}

/* What stands behind the nodes of the element; NULL: there is none of that name. */
static const char *behind_nodes(const vs_cards *c, const char *element) {
  for (size_t k = 0; k < c->count; k = vs_cards_next(c, k)) {
    const vs_netlist_card *card = &c->card[k];
    if (card->kind == VS_CARDS_ELEMENT && vs_words_is(card->name, element) &&
        card->count > card->nodes) {
      const vs_argument *a = &c->arguments[card->first + card->nodes];
      return a->name.n ? a->name.at : a->value.at;
    }
  }
  return NULL;
}

const char *vs_deck_lacking(const vs_deck *deck, unsigned lack, const vs_device *d,
                            const char *element, size_t *k) {
  const vs_cards *c = vs_deck_cards(deck);
  const char *text = element ? behind_nodes(c, element) : NULL;
  size_t param = 0;
  for (size_t n = 1; n < deck->section.count; n++) {
    const char *key = deck->section.fields[n].key;
    if (deck->section.fields[n].kind != VS_REAL || param++ < *k ||
        !(deck->unsure[param - 1][1] & lack))
      continue;
    if ((d && (formula_names(deck, &d->voltage, key) || formula_names(deck, &d->current, key))) ||
        (text && text_names(c, text, key, 0))) {
      *k = param;
      return key;
    }
  }
  return NULL;
}

/* ---- the mains behind a device ---- */

/* True for a line of the deck itself and of what it includes of the user's, not of a part. */
static bool is_own_line(const vs_deck *deck, const vs_line *line) {
  const char *file = line->where.file;
  bool own = false;
  for (size_t k = 0; file && k < deck->n_files; k++) own = own || !strcmp(file, deck->files[k]);
  for (size_t k = 0; own && k < deck->n_part_files; k++)
    own = strcmp(file, deck->part_files[k].where.file) != 0;
  return own && (!strcmp(file, deck->files[0]) || !vs_deck_is_shipped(file));
}

/* True for a source that is neither a port's nor one of 0, which measures a current or joins two
 * nodes. */
static bool is_own_source(const vs_deck *deck, const vs_netlist_card *card) {
  const vs_cards *c = vs_deck_cards(deck);
  const size_t value = card->words > 3 && vs_words_is(vs_cards_word(c, card, 2), "dc") ? 3 : 2;
  for (size_t k = 0; k < deck->n_ports; k++)
    if (vs_words_is(card->name, deck->ports[k].source)) return false;
  return card->count > 2 &&
         !(card->count == value + 1 && vs_words_is(vs_cards_word(c, card, value), "0"));
}

/* True for ground, and for a node of a source that a port for a gate drives. */
static bool is_at_gate_port(const vs_deck *deck, vs_word node) {
  const vs_cards *c = vs_deck_cards(deck);
  bool at = vs_words_is_ground(node);
  for (size_t k = 0; k < deck->n_ports && !at; k++)
    for (size_t n = 0; n < c->count && !at && vs_port_is_gated(&deck->ports[k].signal); n++)
      at = c->card[n].count > 1 && vs_words_is(c->card[n].name, deck->ports[k].source) &&
           (!vs_words_compare(node, vs_cards_word(c, &c->card[n], 0)) ||
            !vs_words_compare(node, vs_cards_word(c, &c->card[n], 1)));
  return at;
}

/* True for an element that couples two circuits, or that drives one: transformers are made of K, E
 * and F. An E that makes a gate's drive of a port's pulses is none. */
static bool is_other_drive(const vs_deck *deck, const vs_netlist_card *card) {
  const vs_cards *c = vs_deck_cards(deck);
  if (card->kind != VS_CARDS_ELEMENT) return false;
  if (strchr("vi", card->letter)) return is_own_source(deck, card);
  if (card->letter == 'e' && card->count > 3 && is_at_gate_port(deck, vs_cards_word(c, card, 2)) &&
      is_at_gate_port(deck, vs_cards_word(c, card, 3)))
    return false;
  return strchr("efghk", card->letter);
}

/* True where the device has a terminal at the node that the deck's line `*$ line` names. */
static bool is_at_line(const vs_deck *deck, const vs_device *d) {
  char voltage[VS_DECK_NAME + 4];
  bool at = false;
  snprintf(voltage, sizeof voltage, "v(%s)", deck->line[0]);
  for (size_t k = 0; k < deck->n_terms; k++)
    if (!strcmp(deck->terms[k].plus, voltage) || !strcmp(deck->terms[k].minus, voltage))
      at = at || vs_formula_uses(&d->voltage, (int)k);
  return at;
}

/* True where something besides the mains drives the deck's own circuit, which no value of a key
 * changes. */
static bool has_other_drive(const vs_deck *deck) {
  for (size_t k = 0; k < deck->n_part_files; k++)
    if (!strcmp(deck->part_files[k].kind, "transformer")) return true;
  const vs_cards *c = vs_deck_cards(deck);
  for (size_t k = 0; k < c->count; k++)
    if (is_other_drive(deck, &c->card[k]) && is_own_line(deck, &deck->lines[k])) return true;
  return false;
}

/* Between the line and the mains at the converter a deck with a parameter line_voltage has a
 * transformer. */
static void find_mains(vs_deck *deck, const vs_circuit_values *values, double u_rms) {
  const double *line_v = NULL;
  for (size_t k = 1; k < deck->section.count; k++)
    if (!strcmp(deck->section.fields[k].key, "line_voltage"))
      line_v =
          (const double *)(const void *)((const char *)values + deck->section.fields[k].offset);
  if (!deck->drive_known) deck->other_drive = has_other_drive(deck);
  deck->drive_known = true;
  for (size_t k = 0; k < deck->n_devices; k++) {
    vs_device *d = &deck->devices[k];
    d->mains_v = deck->other_drive ? NAN : u_rms;
    if (line_v) d->mains_v = is_at_line(deck, d) ? *line_v : u_rms;
  }
}

vs_status vs_deck_bind(vs_deck *deck, const vs_circuit_values *values,
                       const vs_deck_value *standard, size_t n_standard, vs_error *err) {
  if (deck->lost & VS_LOST_PARAM) return VS_OK;
  vs_status status = VS_OK;
  double of_name[VS_DECK_MOST];
  for (size_t n = 0; n < deck->n_names && !status; n++)
    status = vs_error_keep(
        err, find_value(deck, &deck->names[n], values, standard, n_standard, &of_name[n], err));
  each_formula(deck, vs_formula_bind, of_name);
  double u_rms = NAN;
  for (size_t k = 0; k < n_standard; k++)
    if (!strcmp(standard[k].name, vs_deck_standard_names[VS_STANDARD_U_RMS]))
      u_rms = standard[k].value;
  find_mains(deck, values, u_rms);
  return status;
}

static void free_formula(vs_formula *formula, const double *values) {
  (void)values;
  vs_formula_free(formula);
}

void vs_deck_free(vs_deck *deck) {
  if (deck->freed) return;
  deck->freed = true;
  for (size_t k = 1; k < deck->section.count; k++) {
    free((char *)(size_t)deck->section.fields[k].key);
    free((char *)(size_t)deck->section.fields[k].unit);
    free((char *)(size_t)deck->section.fields[k].default_text);
    free((char *)(size_t)deck->section.fields[k].text);
  }
  free(own_fields(deck));
  for (size_t k = 0; k < deck->n_lines; k++) vs_line_free(&deck->lines[k]);
  free(deck->lines);
  if (deck->cards) vs_cards_free(deck->cards);
  free(deck->cards);
  if (deck->library) vs_library_free(deck->library);
  free(deck->library);
  each_formula(deck, free_formula, NULL);
  for (size_t k = 0; k < deck->n_files; k++) free(deck->files[k]);
  vs_statements_free(&deck->skipped);
  free(deck->remarks);
  vs_text_free(&deck->eva_current);
  vs_text_free(&deck->eva_lines);
}
