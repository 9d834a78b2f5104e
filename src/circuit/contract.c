/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "circuit/contract.h"

#include <ctype.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "circuit/rules.h"

void vs_lower(char *s) {
  for (; *s; s++) *s = (char)tolower((unsigned char)*s);
}

typedef struct cursor {
  const char *start, *at;
  vs_where line;
} cursor;

static vs_where here(const cursor *c) {
  vs_where w = c->line;
  w.column = vs_column(c->start, c->at);
  return w;
}

static void skip_blanks(cursor *c) {
  c->at += strspn(c->at, " \t");
}

static bool take(cursor *c, char symbol) {
  skip_blanks(c);
  if (*c->at != symbol) return false;
  c->at++;
  return true;
}

/* letters, digits, '_' and what else `also` names */
static bool take_word(cursor *c, const char *also, char *word, size_t size) {
  skip_blanks(c);
  size_t n = 0;
  while (isalnum((unsigned char)c->at[n]) || c->at[n] == '_' ||
         (c->at[n] && strchr(also, c->at[n])))
    n++;
  if (n == 0 || n >= size) return false;
  memcpy(word, c->at, n);
  word[n] = '\0';
  c->at += n;
  return true;
}

/* "TEXT" at the end of the line, or nothing */
static vs_status take_text(cursor *c, char *text, size_t size, vs_error *err) {
  *text = '\0';
  skip_blanks(c);
  if (!*c->at) return VS_OK;
  size_t n = *c->at == '"' ? strcspn(c->at + 1, "\"") : 0;
  if (*c->at != '"' || c->at[n + 1] != '"' || n >= size)
    return vs_fail_at(err, here(c),
                      "a description in \"quotes\" (shorter than %zu bytes) is wanted here", size);
  memcpy(text, c->at + 1, n);
  text[n] = '\0';
  c->at += n + 2;
  skip_blanks(c);
  return *c->at ? vs_fail_at(err, here(c), "nothing may follow the description") : VS_OK;
}

static vs_status take_name(cursor *c, char *name, vs_error *err) {
  skip_blanks(c);
  vs_where where = here(c);
  if (!take_word(c, "", name, VS_DECK_NAME) || !take(c, '='))
    return vs_fail_at(err, where, "'NAME = ...' is wanted here");
  return VS_OK;
}

/* ---- the lines of the contract ---- */

/* up to the next blank */
static void take_token(cursor *c, char *token, size_t size) {
  skip_blanks(c);
  size_t n = strcspn(c->at, " \t");
  snprintf(token, size, "%.*s", (int)n, c->at);
  c->at += n;
}

static bool read_range(char *token, double *min, double *max) {
  char *dots = strstr(token, ".."), *end_min, *end_max;
  if (!dots) return false;
  *dots = '\0';
  *min = strtod(token, &end_min);
  *max = strtod(dots + 2, &end_max);
  return end_min != token && !*end_min && end_max != dots + 2 && !*end_max && *min <= *max;
}

/* Adds a field to the deck's section; the texts are copied. */
static vs_status add_field(vs_deck *deck, const vs_field *field, vs_where where, vs_error *err) {
  for (size_t k = 0; k < deck->section.count; k++)
    if (!strcmp(deck->section.fields[k].key, field->key))
      return vs_fail_at(err, where, "param %s stands here a second time%s", field->key,
                        k ? "" : ": that key is the program's");
  if (vs_is_standard(field->key))
    return vs_fail_at(err, where, "param %s is the program's; give yours another name", field->key);
  vs_field *own = &vs_deck_fields(deck)[deck->section.count++];
  *own = *field;
  own->key = vs_copy(field->key);
  own->unit = vs_copy(field->unit);
  own->default_text = vs_copy(field->default_text);
  own->text = vs_copy(field->text);
  return VS_OK;
}

/* param NAME = PART part "TEXT"; begun: up to the word part */
static vs_status read_part(vs_deck *deck, cursor *c, vs_field *field, vs_where where,
                           vs_error *err) {
  char text[VS_DECK_TEXT];
  if (deck->n_parts >= VS_DECK_PARTS)
    return vs_fail_at(err, where, "more than %d parts", VS_DECK_PARTS);
  vs_status status = take_text(c, text, sizeof text, err);
  field->kind = VS_NAME;
  field->text = text;
  field->offset = offsetof(vs_circuit_values, parts) + deck->n_parts * VS_NAME_SIZE;
  if (!status) status = add_field(deck, field, where, err);
  if (!status)
    deck->parts[deck->n_parts++].name = deck->section.fields[deck->section.count - 1].key;
  return status;
}

/* param NAME = VALUE UNIT  MIN..MAX  "TEXT" */
static vs_status read_param(vs_deck *deck, cursor *c, vs_error *err) {
  char name[VS_DECK_NAME], value[VS_DECK_NAME], unit[VS_DECK_NAME] = "", range[VS_DECK_NAME];
  char text[VS_DECK_TEXT], default_text[2 * VS_DECK_NAME], why[200];
  double si;
  vs_field field = {
      .kind = VS_REAL, .key = name, .unit = unit, .default_text = default_text, .text = text};
  vs_status status = take_name(c, name, err);
  if (status) return status;
  skip_blanks(c);
  vs_where at_value = here(c);
  take_token(c, value, sizeof value);
  take_token(c, range, sizeof range);
  if (!strstr(range, "..")) { /* that was the unit, or the word part */
    memcpy(unit, range, sizeof unit);
    if (strcmp(unit, "part")) take_token(c, range, sizeof range);
  }
  if (!strcmp(unit, "part")) {
    field.default_text = value;
    *unit = '\0';
    return read_part(deck, c, &field, at_value, err);
  }
  snprintf(default_text, sizeof default_text, "%s%s%s", value, *unit ? " " : "", unit);
  if (!vs_unit_known(unit) || !vs_quantity(default_text, unit, &si, why, sizeof why))
    return vs_fail_at(err, at_value, "param %s: '%s' is not a number with a unit known here", name,
                      default_text);
  if (!read_range(range, &field.min, &field.max))
    return vs_fail_at(err, at_value, "param %s: a range MIN..MAX is wanted after the value", name);
  if (si / vs_unit_factor(unit) < field.min || si / vs_unit_factor(unit) > field.max)
    return vs_fail_at(err, at_value, "param %s: %s is outside its own range", name, default_text);
  status = take_text(c, text, sizeof text, err);
  size_t n = deck->section.count - 1 - deck->n_parts; /* parameters so far */
  if (!status && n >= VS_DECK_MOST)
    status = vs_fail_at(err, at_value, "more than %d parameters", VS_DECK_MOST);
  field.offset = offsetof(vs_circuit_values, params) + n * sizeof(double);
  return status ? status : add_field(deck, &field, at_value, err);
}

/* port mains = SOURCE, port gate+180deg = SOURCE */
static vs_status read_port(vs_deck *deck, cursor *c, vs_error *err) {
  char name[VS_DECK_NAME], why[200];
  skip_blanks(c);
  vs_port port = {.where = here(c)};
  if (!take_word(c, "+.", name, sizeof name) || !take(c, '=') ||
      !take_word(c, ".", port.source, sizeof port.source))
    return vs_fail_at(err, here(c), "'port NAME = SOURCE' is wanted here");
  char *shift = strchr(name, '+');
  if (shift) *shift++ = '\0';
  while (port.drive < VS_DRIVES &&
         (strcmp(name, vs_drives[port.drive].name) || (shift && !vs_drives[port.drive].shifts)))
    port.drive++;
  if (port.drive == VS_DRIVES)
    return vs_fail_at(err, port.where,
                      "no port '%s'; there are: mains, gate, gate+ANGLE, burst, burst+ANGLE", name);
  if (shift && !vs_quantity(shift, "deg", &port.shift_rad, why, sizeof why))
    return vs_fail_at(err, port.where, "port %s: %s", name, why);
  vs_lower(port.source);
  if (port.source[0] != 'v')
    return vs_fail_at(err, port.where, "a port drives a voltage source (V...), not '%s'",
                      port.source);
  for (size_t k = 0; k < deck->n_ports; k++) {
    if (!strcmp(deck->ports[k].source, port.source))
      return vs_fail_at(err, port.where, "source %s has a port already", port.source);
    if (port.drive == VS_DRIVE_MAINS && deck->ports[k].drive == VS_DRIVE_MAINS)
      return vs_fail_at(err, port.where, "a second port mains; a deck has one at most");
  }
  if (deck->n_ports >= VS_DECK_MOST)
    return vs_fail_at(err, port.where, "more than %d ports", VS_DECK_MOST);
  deck->ports[deck->n_ports++] = port;
  skip_blanks(c);
  return *c->at ? vs_fail_at(err, here(c), "nothing may follow the source's name") : VS_OK;
}

/* The term's index; a new one if nobody named it before; -1: no room. */
static int find_term(vs_deck *deck, vs_where where, char quantity, const char *first,
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

/* probe NAME = [-]v(n) | v(n,m) | i(Vx)  UNIT  "TEXT" */
static vs_status read_probe(vs_deck *deck, cursor *c, vs_error *err) {
  vs_probe probe = {.sign = 1};
  char first[VS_DECK_NAME - 4], second[VS_DECK_NAME - 4];
  vs_status status = take_name(c, probe.name, err);
  if (status) return status;
  if (take(c, '-')) probe.sign = -1;
  skip_blanks(c);
  vs_where where = here(c);
  char quantity = (char)tolower((unsigned char)*c->at);
  bool good = (quantity == 'v' || quantity == 'i') && *c->at++ &&
              vs_term_read(&c->at, quantity, first, second, sizeof first) &&
              take_word(c, "./^%", probe.unit, sizeof probe.unit);
  if (!good || !vs_unit_known(probe.unit))
    return vs_fail_at(err, here(c), "'probe NAME = v(n) | v(n,m) | i(Vx)  UNIT' is wanted here");
  status = take_text(c, probe.text, sizeof probe.text, err);
  if (status) return status;
  probe.term = find_term(deck, where, quantity, first, second);
  for (size_t k = 0; k < deck->n_probes; k++)
    if (!strcmp(deck->probes[k].name, probe.name))
      return vs_fail_at(err, c->line, "probe %s stands here a second time", probe.name);
  if (deck->n_probes >= VS_DECK_MOST || probe.term < 0)
    return vs_fail_at(err, c->line, "more than %d probes and terms of formulas", VS_DECK_MOST);
  deck->probes[deck->n_probes++] = probe;
  return VS_OK;
}

/* What a formula is read for. */
typedef struct formula_scope {
  vs_deck *deck;
  const cursor *line;
} formula_scope;

static vs_where place(const formula_scope *scope, const char *at) {
  cursor c = *scope->line;
  c.at = at;
  return here(&c);
}

static int formula_term(void *ctx, const char *at, const vs_formula_term *term) {
  const formula_scope *scope = ctx;
  return find_term(scope->deck, place(scope, at), term->quantity, term->first, term->second);
}

static int formula_name(void *ctx, const char *at, const char *name) {
  const formula_scope *scope = ctx;
  vs_deck *deck = scope->deck;
  for (size_t k = 0; k < deck->n_names; k++)
    if (!strcmp(deck->names[k].name, name)) return (int)k;
  if (deck->n_names >= VS_DECK_MOST) return -1;
  vs_named *named = &deck->names[deck->n_names++];
  snprintf(named->name, sizeof named->name, "%s", name);
  named->where = place(scope, at);
  return (int)deck->n_names - 1;
}

/* loss NAME = FORMULA, store NAME = FORMULA */
static vs_status read_account(vs_deck *deck, vs_accounts *accounts, cursor *c, vs_error *err) {
  char why[200];
  const char *bad = NULL;
  if (accounts->count >= VS_DECK_MOST)
    return vs_fail_at(err, here(c), "more than %d of these lines", VS_DECK_MOST);
  vs_account *account = &accounts->item[accounts->count];
  vs_status status = take_name(c, account->name, err);
  if (status) return status;
  for (size_t k = 0; k < accounts->count; k++)
    if (!strcmp(accounts->item[k].name, account->name))
      return vs_fail_at(err, c->line, "%s stands here a second time", account->name);
  accounts->count++; /* its formula is freed with the deck, also when it is not good */
  skip_blanks(c);
  size_t n_terms = deck->n_terms, n_names = deck->n_names;
  formula_scope own = {deck, c};
  const vs_formula_scope scope = {&own, formula_term, formula_name};
  const char *end = vs_formula_read(c->at, &scope, &account->formula, &bad, why, sizeof why);
  c->at = end ? end : bad;
  skip_blanks(c);
  if (end && !*c->at) return VS_OK;
  vs_formula_free(&account->formula);
  deck->n_terms = n_terms; /* what a broken formula seems to name need not be there */
  deck->n_names = n_names;
  return vs_fail_at(err, here(c), "%s",
                    end ? "an operator or the end of the line is wanted here" : why);
}

static vs_status read_loss(vs_deck *deck, cursor *c, vs_error *err) {
  return read_account(deck, &deck->losses, c, err);
}

static vs_status read_store(vs_deck *deck, cursor *c, vs_error *err) {
  return read_account(deck, &deck->stores, c, err);
}

/* rating PROBE MIN..MAX UNIT "TEXT" */
static vs_status read_rating(vs_deck *deck, cursor *c, vs_error *err) {
  char name[VS_DECK_NAME], range[VS_DECK_NAME];
  const char *names[VS_DECK_MOST];
  vs_rating rating = {.probe = -1};
  skip_blanks(c);
  vs_where where = here(c);
  if (!take_word(c, "", name, sizeof name))
    return vs_fail_at(err, where, "'rating PROBE MIN..MAX UNIT' is wanted here");
  for (size_t k = 0; k < deck->n_probes; k++) {
    names[k] = deck->probes[k].name;
    if (!strcmp(name, names[k])) rating.probe = (int)k;
  }
  if (rating.probe < 0 && deck->lost & VS_LOST_PROBE) return VS_OK;
  if (rating.probe < 0) {
    const char *nearest = vs_nearest(name, names, deck->n_probes);
    return vs_fail_at(err, where, "rating: no probe '%s' stands above%s%s%s", name,
                      nearest ? "; did you mean '" : "", nearest ? nearest : "",
                      nearest ? "'?" : "");
  }
  skip_blanks(c);
  where = here(c);
  take_token(c, range, sizeof range);
  if (!read_range(range, &rating.min, &rating.max))
    return vs_fail_at(err, where, "rating %s: a range MIN..MAX is wanted here", name);
  skip_blanks(c);
  where = here(c);
  const vs_probe *probe = &deck->probes[rating.probe];
  double factor;
  char one[24] = "1 ", why[200];
  bool good = take_word(c, "./^%", rating.unit, sizeof rating.unit);
  snprintf(one + 2, sizeof one - 2, "%s", rating.unit);
  if (!good || !vs_quantity(one, probe->unit, &factor, why, sizeof why))
    return vs_fail_at(err, where, "rating %s: a unit of the probe's kind is wanted here, as %s",
                      name, probe->unit);
  rating.min *= factor;
  rating.max *= factor;
  vs_status status = take_text(c, rating.text, sizeof rating.text, err);
  if (!status && deck->n_ratings >= VS_DECK_MOST)
    status = vs_fail_at(err, c->line, "more than %d ratings", VS_DECK_MOST);
  if (!status) deck->ratings[deck->n_ratings++] = rating;
  return status;
}

/* compat ps */
static vs_status read_compat(vs_deck *deck, cursor *c, vs_error *err) {
  skip_blanks(c);
  vs_where where = here(c);
  take_token(c, deck->compat, sizeof deck->compat);
  skip_blanks(c);
  return strcmp(deck->compat, "ps") || *c->at
             ? vs_fail_at(err, where, "compat: there is: ps (PSpice)")
             : VS_OK;
}

static vs_status read_title(vs_deck *deck, cursor *c, vs_error *err) {
  (void)err;
  skip_blanks(c);
  snprintf(deck->title, sizeof deck->title, "%s", c->at);
  return VS_OK;
}

static const struct directive {
  const char *word;
  vs_status (*read)(vs_deck *, cursor *, vs_error *);
  unsigned lost; /* when it cannot be read */
} DIRECTIVES[] = {{"title", read_title, 0},
                  {"param", read_param, VS_LOST_PARAM},
                  {"port", read_port, VS_LOST_PORT},
                  {"probe", read_probe, VS_LOST_PROBE},
                  {"loss", read_loss, 0},
                  {"store", read_store, 0},
                  {"rating", read_rating, 0},
                  {"compat", read_compat, 0}};
enum { N_DIRECTIVES = sizeof DIRECTIVES / sizeof *DIRECTIVES };

vs_status vs_contract_line(vs_deck *deck, const char *line, vs_where begin, vs_error *err) {
  cursor cursor_here = {line, line + begin.column + 1, begin}, *c = &cursor_here;
  char word[VS_DECK_NAME] = "";
  const char *names[N_DIRECTIVES];
  skip_blanks(c);
  vs_where where = here(c);
  take_word(c, "", word, sizeof word);
  for (size_t k = 0; k < N_DIRECTIVES; k++) {
    names[k] = DIRECTIVES[k].word;
    if (strcmp(word, names[k])) continue;
    vs_status status = DIRECTIVES[k].read(deck, c, err);
    if (status) deck->lost |= DIRECTIVES[k].lost;
    return status;
  }
  deck->lost |= VS_LOST_PARAM | VS_LOST_PORT | VS_LOST_PROBE;
  const char *nearest = vs_nearest(word, names, N_DIRECTIVES);
  return vs_fail_at(err, where,
                    "'*$ %s' is not known; there are: title, param, port, probe, loss, store, "
                    "rating, compat%s%s%s",
                    word, nearest ? "; did you mean '" : "", nearest ? nearest : "",
                    nearest ? "'?" : "");
}
