/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "circuit/contract.h"

#include <ctype.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "circuit/devices.h"
#include "circuit/limits.h"
#include "circuit/rules.h"

void vs_lower(char *s) {
  for (; *s; s++) *s = (char)tolower((unsigned char)*s);
}

/* ---- the lines of the contract ---- */

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
  if (vs_is_reserved(field->key))
    return vs_fail_at(err, where,
                      "param %s: ngspice has that name for itself in expressions; give yours another "
                      "name",
                      field->key);
  vs_field *own = &vs_deck_fields(deck)[deck->section.count++];
  *own = *field;
  own->key = vs_copy(field->key);
  own->unit = vs_copy(field->unit);
  own->default_text = vs_copy(field->default_text);
  own->text = vs_copy(field->text);
  return VS_OK;
}

/* param NAME = PART part [KIND] "TEXT"; begun: up to the word part */
static vs_status read_part(vs_deck *deck, vs_cursor *c, vs_field *field, vs_where where,
                           vs_error *err) {
  char text[VS_DECK_TEXT], kind[VS_DECK_NAME] = "";
  if (deck->n_parts >= VS_DECK_PARTS)
    return vs_fail_at(err, where, "more than %d parts", VS_DECK_PARTS);
  vs_cursor_skip(c);
  if (isalpha((unsigned char)*c->at)) vs_cursor_word(c, "", kind, sizeof kind);
  vs_status status = vs_cursor_text(c, text, sizeof text, err);
  field->kind = VS_NAME;
  field->text = text;
  field->offset = offsetof(vs_circuit_values, parts) + deck->n_parts * VS_NAME_SIZE;
  if (!status) status = add_field(deck, field, where, err);
  if (status) return status;
  vs_part *part = &deck->parts[deck->n_parts++];
  part->name = deck->section.fields[deck->section.count - 1].key;
  memcpy(part->kind, kind, sizeof kind);
  return VS_OK;
}

/* param NAME = VALUE UNIT  MIN..MAX [assumed] "TEXT" */
static vs_status read_param(vs_deck *deck, vs_cursor *c, vs_error *err) {
  char name[VS_DECK_NAME], value[VS_DECK_NAME], unit[VS_DECK_NAME] = "", range[VS_DECK_NAME];
  char text[VS_DECK_TEXT], default_text[2 * VS_DECK_NAME], why[200];
  double si;
  vs_field field = {
      .kind = VS_REAL, .key = name, .unit = unit, .default_text = default_text, .text = text};
  vs_status status = vs_cursor_name(c, name, VS_DECK_NAME, err);
  if (status) return status;
  vs_cursor_skip(c);
  vs_where at_value = vs_cursor_here(c);
  vs_cursor_token(c, value, sizeof value);
  vs_cursor_token(c, range, sizeof range);
  if (!strstr(range, "..")) { /* that was the unit, or the word part */
    memcpy(unit, range, sizeof unit);
    if (strcmp(unit, "part")) vs_cursor_token(c, range, sizeof range);
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
  bool assumed = vs_cursor_is(c, "assumed");
  status = vs_cursor_text(c, text, sizeof text, err);
  vs_text shown = {0};
  vs_text_add(&shown, "%s%s", text, assumed ? " (assumed)" : "");
  field.text = shown.text;
  size_t n = deck->section.count - 1 - deck->n_parts; /* parameters so far */
  if (!status && n >= VS_DECK_MOST)
    status = vs_fail_at(err, at_value, "more than %d parameters", VS_DECK_MOST);
  field.offset = offsetof(vs_circuit_values, params) + n * sizeof(double);
  if (!status) status = add_field(deck, &field, at_value, err);
  vs_text_free(&shown);
  return status;
}

/* port mains = SOURCE, port gate+180deg = SOURCE */
static vs_status read_port(vs_deck *deck, vs_cursor *c, vs_error *err) {
  char name[VS_DECK_NAME], why[200];
  vs_cursor_skip(c);
  vs_port port = {.where = vs_cursor_here(c)};
  if (!vs_cursor_word(c, "+.", name, sizeof name) || !vs_cursor_take(c, '=') ||
      !vs_cursor_word(c, ".", port.source, sizeof port.source))
    return vs_fail_at(err, vs_cursor_here(c), "'port NAME = SOURCE' is wanted here");
  char *shift = strchr(name, '+');
  if (shift) *shift++ = '\0';
  int drive = 0;
  while (drive < VS_DRIVES && (!vs_drives[drive].name || strcmp(name, vs_drives[drive].name) ||
                               (shift && !vs_drives[drive].shifts)))
    drive++;
  port.signal.drive = drive;
  if (drive == VS_DRIVES)
    return vs_fail_at(err, port.where,
                      "no port '%s'; there are: mains, gate, gate+ANGLE, burst, burst+ANGLE", name);
  if (shift && !vs_quantity(shift, "deg", &port.signal.shift_rad, why, sizeof why))
    return vs_fail_at(err, port.where, "port %s: %s", name, why);
  vs_lower(port.source);
  if (port.source[0] != 'v')
    return vs_fail_at(err, port.where, "a port drives a voltage source (V...), not '%s'",
                      port.source);
  for (size_t k = 0; k < deck->n_ports; k++) {
    if (!strcmp(deck->ports[k].source, port.source))
      return vs_fail_at(err, port.where, "source %s has a port already", port.source);
    if (drive == VS_DRIVE_MAINS && deck->ports[k].signal.drive == VS_DRIVE_MAINS)
      return vs_fail_at(err, port.where, "a second port mains; a deck has one at most");
  }
  if (deck->n_ports >= VS_DECK_MOST)
    return vs_fail_at(err, port.where, "more than %d ports", VS_DECK_MOST);
  deck->ports[deck->n_ports++] = port;
  vs_cursor_skip(c);
  return *c->at ? vs_fail_at(err, vs_cursor_here(c), "nothing may follow the source's name")
                : VS_OK;
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
static vs_status read_probe(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_probe probe = {.sign = 1};
  char first[VS_DECK_NAME - 4], second[VS_DECK_NAME - 4];
  vs_status status = vs_cursor_name(c, probe.name, VS_DECK_NAME, err);
  if (status) return status;
  if (vs_cursor_take(c, '-')) probe.sign = -1;
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  char quantity = (char)tolower((unsigned char)*c->at);
  bool good = (quantity == 'v' || quantity == 'i') && *c->at++ &&
              vs_term_read(&c->at, quantity, first, second, sizeof first) &&
              vs_cursor_word(c, "./^%", probe.unit, sizeof probe.unit);
  if (!good || !vs_unit_known(probe.unit))
    return vs_fail_at(err, vs_cursor_here(c),
                      "'probe NAME = v(n) | v(n,m) | i(Vx)  UNIT' is wanted here");
  status = vs_cursor_text(c, probe.text, sizeof probe.text, err);
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
  const vs_cursor *line;
} formula_scope;

static vs_where place(const formula_scope *scope, const char *at) {
  vs_cursor c = *scope->line;
  c.at = at;
  return vs_cursor_here(&c);
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

vs_status vs_contract_formula(vs_deck *deck, vs_cursor *c, const char *follow, vs_formula *formula,
                              vs_error *err) {
  char why[200] = "an operator or the end of the line is wanted here";
  const char *bad = NULL;
  vs_cursor_skip(c);
  size_t n_terms = deck->n_terms, n_names = deck->n_names;
  formula_scope own = {deck, c};
  const vs_formula_scope scope = {&own, formula_term, formula_name};
  const char *end = vs_formula_read(c->at, &scope, formula, &bad, why, sizeof why);
  c->at = end ? end : bad;
  vs_cursor_skip(c);
  if (end && (!*c->at || strchr(follow, *c->at))) return VS_OK;
  vs_formula_free(formula);
  deck->n_terms = n_terms; /* what a broken formula seems to name need not be there */
  deck->n_names = n_names;
  return vs_fail_at(err, vs_cursor_here(c), "%s", why);
}

/* loss NAME = FORMULA, store NAME = FORMULA */
static vs_status read_account(vs_deck *deck, vs_accounts *accounts, vs_cursor *c, vs_error *err) {
  if (accounts->count >= VS_DECK_MOST)
    return vs_fail_at(err, vs_cursor_here(c), "more than %d of these lines", VS_DECK_MOST);
  vs_account *account = &accounts->item[accounts->count];
  vs_status status = vs_cursor_name(c, account->name, VS_DECK_NAME, err);
  if (status) return status;
  for (size_t k = 0; k < accounts->count; k++)
    if (!strcmp(accounts->item[k].name, account->name))
      return vs_fail_at(err, c->line, "%s stands here a second time", account->name);
  accounts->count++; /* its formula is freed with the deck, also when it is not good */
  return vs_contract_formula(deck, c, "", &account->formula, err);
}

static vs_status read_loss(vs_deck *deck, vs_cursor *c, vs_error *err) {
  return read_account(deck, &deck->losses, c, err);
}

static vs_status read_store(vs_deck *deck, vs_cursor *c, vs_error *err) {
  return read_account(deck, &deck->stores, c, err);
}

/* line NODE [NODE] */
static vs_status read_line_nodes(vs_deck *deck, vs_cursor *c, vs_error *err) {
  if (*deck->line[0]) return vs_fail_at(err, c->line, "a second '*$ line'");
  if (!vs_cursor_word(c, "._#", deck->line[0], sizeof deck->line[0]))
    return vs_fail_at(err, vs_cursor_here(c), "'line NODE [NODE]' is wanted here");
  if (!vs_cursor_word(c, "._#", deck->line[1], sizeof deck->line[1]))
    memcpy(deck->line[1], "0", sizeof "0");
  vs_lower(deck->line[0]);
  vs_lower(deck->line[1]);
  vs_cursor_skip(c);
  return *c->at ? vs_fail_at(err, vs_cursor_here(c), "nothing may follow the nodes") : VS_OK;
}

/* compat ps */
static vs_status read_compat(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  vs_cursor_token(c, deck->compat, sizeof deck->compat);
  vs_cursor_skip(c);
  return strcmp(deck->compat, "ps") || *c->at
             ? vs_fail_at(err, where, "compat: there is: ps (PSpice)")
             : VS_OK;
}

static vs_status read_title(vs_deck *deck, vs_cursor *c, vs_error *err) {
  (void)err;
  vs_cursor_skip(c);
  snprintf(deck->title, sizeof deck->title, "%s", c->at);
  return VS_OK;
}

static const struct directive {
  const char *word;
  vs_status (*read)(vs_deck *, vs_cursor *, vs_error *);
  unsigned lost; /* when it cannot be read */
} DIRECTIVES[] = {{"title", read_title, 0},
                  {"param", read_param, VS_LOST_PARAM},
                  {"port", read_port, VS_LOST_PORT},
                  {"line", read_line_nodes, 0},
                  {"probe", read_probe, VS_LOST_PROBE},
                  {"loss", read_loss, 0},
                  {"store", read_store, 0},
                  {"part", vs_limits_part, 0},
                  {"limit", vs_limits_limit, 0},
                  {"rating", vs_limits_rating, 0},
                  {"require", vs_limits_require, 0},
                  {"device", vs_devices_line, 0},
                  {"zth", vs_devices_zth, 0},
                  {"compat", read_compat, 0}};
enum { N_DIRECTIVES = sizeof DIRECTIVES / sizeof *DIRECTIVES };

vs_status vs_contract_line(vs_deck *deck, const char *line, vs_where begin, vs_error *err) {
  vs_cursor cursor_here = {line, line + begin.column + 1, begin}, *c = &cursor_here;
  char word[VS_DECK_NAME] = "";
  const char *names[N_DIRECTIVES];
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  vs_cursor_word(c, "", word, sizeof word);
  for (size_t k = 0; k < N_DIRECTIVES; k++) {
    names[k] = DIRECTIVES[k].word;
    if (strcmp(word, names[k])) continue;
    vs_status status = DIRECTIVES[k].read(deck, c, err);
    if (status) deck->lost |= DIRECTIVES[k].lost;
    return status;
  }
  deck->lost |= VS_LOST_PARAM | VS_LOST_PORT | VS_LOST_PROBE;
  const char *nearest = vs_nearest(word, names, N_DIRECTIVES);
  return vs_fail_at(
      err, where,
      "'*$ %s' is not known; there are: title, param, port, line, probe, loss, store, "
      "part, limit, rating, require, device, zth, compat%s%s%s",
      word, nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}
