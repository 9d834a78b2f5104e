/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/contract.h"

#include <ctype.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"
#include "base/units.h"
#include "netlist/devices.h"
#include "netlist/parts.h"

/* What vs_text_out_of_range says of an end of the range; NULL: nothing. */
static const char *beyond_in(const char *range) {
  const char *dots = strstr(range, ".."), *first = vs_text_out_of_range(range);
  return first || !dots ? first : vs_text_out_of_range(dots + 2);
}

static bool read_range(char *token, double *min, double *max) {
  char *dots = strstr(token, ".."), *end_min, *end_max;
  if (!dots) return false;
  *dots = '\0';
  *min = vs_text_to_number(token, &end_min);
  *max = vs_text_to_number(dots + 2, &end_max);
  return end_min != token && !*end_min && end_max != dots + 2 && !*end_max && *min <= *max;
}

/* param NAME = PART part [KIND] "TEXT", from behind the word part on */
static vs_status read_param_part(vs_deck *deck, vs_cursor *c, vs_field *field, vs_where where,
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
  if (!status) status = vs_deck_add_field(deck, field, where, err);
  if (status) return status;
  vs_part *part = &deck->parts[deck->n_parts++];
  part->name = deck->section.fields[deck->section.count - 1].key;
  memcpy(part->kind, kind, sizeof kind);
  part->where = where;
  return VS_OK;
}

/* The words of a line param, as they are written. */
typedef struct param_text {
  char name[VS_DECK_NAME], value[VS_DECK_NAME], unit[VS_DECK_NAME], range[VS_DECK_NAME];
  vs_where where; /* of the value */
} param_text;

/* Gives the field its default and its range. */
static vs_status set_range(vs_field *field, param_text *p, char *default_text, size_t size,
                           vs_error *err) {
  char why[200];
  double si;
  snprintf(default_text, size, "%s%s%s", p->value, *p->unit ? " " : "", p->unit);
  if (vs_text_out_of_range(p->value))
    return vs_fail_at(err, p->where, "param %s: %s: %s", p->name, p->value,
                      vs_text_out_of_range(p->value));
  if (!vs_units_known(p->unit) || !vs_units_read(default_text, p->unit, &si, why, sizeof why))
    return vs_fail_at(err, p->where,
                      "param %s: '%s' is not a number with a unit known here; both are words of "
                      "their own, as '25 mA'",
                      p->name, default_text);
  const char *beyond = beyond_in(p->range);
  if (beyond) return vs_fail_at(err, p->where, "param %s: %s: %s", p->name, p->range, beyond);
  if (!read_range(p->range, &field->min, &field->max))
    return vs_fail_at(err, p->where, "param %s: a range MIN..MAX is wanted after the value",
                      p->name);
  double shown = si / vs_units_factor(p->unit);
  if (shown < field->min || shown > field->max)
    return vs_fail_at(err, p->where, "param %s: %s is outside its own range", p->name,
                      default_text);
  return VS_OK;
}

/* param NAME = VALUE UNIT MIN..MAX [assumed | typical] "TEXT", from behind the range on */
static vs_status read_param_number(vs_deck *deck, vs_cursor *c, param_text *p, vs_error *err) {
  char text[VS_DECK_TEXT], default_text[2 * VS_DECK_NAME];
  vs_field field = {.kind = VS_REAL, .key = p->name, .unit = p->unit, .default_text = default_text};
  vs_status status = set_range(&field, p, default_text, sizeof default_text, err);
  if (status) return status;
  const unsigned unsure = vs_deck_unsure(c);
  status = vs_cursor_text(c, text, sizeof text, err);
  vs_text shown = {0};
  vs_text_add(&shown, "%s%s", text, vs_deck_unsure_notes[unsure]);
  field.text = shown.text;
  size_t n = deck->section.count - 1 - deck->n_parts; /* parameters so far */
  if (!status && n >= VS_DECK_MOST)
    status = vs_fail_at(err, p->where, "more than %d parameters", VS_DECK_MOST);
  field.offset = offsetof(vs_circuit_values, params) + n * sizeof(double);
  if (!status) status = vs_deck_add_field(deck, &field, p->where, err);
  if (!status) memset(deck->unsure[n], (int)unsure, sizeof deck->unsure[n]);
  vs_text_free(&shown);
  return status;
}

/* param NAME = ..., of a number or of a part */
static vs_status read_param(vs_deck *deck, vs_cursor *c, vs_error *err) {
  param_text p = {.unit = ""};
  vs_status status = vs_cursor_name(c, p.name, VS_DECK_NAME, err);
  if (status) return status;
  vs_cursor_skip(c);
  p.where = vs_cursor_here(c);
  vs_cursor_token(c, p.value, sizeof p.value);
  vs_cursor_token(c, p.range, sizeof p.range);
  if (!strstr(p.range, "..")) { /* that was the unit, or the word part */
    memcpy(p.unit, p.range, sizeof p.unit);
    if (strcmp(p.unit, "part")) vs_cursor_token(c, p.range, sizeof p.range);
  }
  if (strcmp(p.unit, "part")) return read_param_number(deck, c, &p, err);
  vs_field field = {.key = p.name, .unit = "", .default_text = p.value};
  return read_param_part(deck, c, &field, p.where, err);
}

/* port mains = SOURCE, port gate+180deg = SOURCE */
static vs_status read_port(vs_deck *deck, vs_cursor *c, vs_error *err) {
  char name[VS_DECK_NAME];
  vs_cursor_skip(c);
  vs_port port = {.where = vs_cursor_here(c)};
  if (!vs_cursor_word(c, "+.", name, sizeof name) || !vs_cursor_take(c, '=') ||
      !vs_cursor_word(c, ".", port.source, sizeof port.source))
    return vs_fail_at(err, vs_cursor_here(c), "'port NAME = SOURCE' is wanted here");
  vs_status status = vs_port_read(name, port.where, &port.signal, err);
  if (status) return status;
  vs_cursor_lower(port.source);
  if (port.source[0] != 'v')
    return vs_fail_at(err, port.where, "a port drives a voltage source (V...), not '%s'",
                      port.source);
  for (size_t k = 0; k < deck->n_ports; k++) {
    if (!strcmp(deck->ports[k].source, port.source))
      return vs_fail_at(err, port.where, "source %s has a port already", port.source);
    if (port.signal.drive == VS_PORT_MAINS && deck->ports[k].signal.drive == VS_PORT_MAINS)
      return vs_fail_at(err, port.where, "a second port mains; a deck has one at most");
  }
  if (deck->n_ports >= VS_DECK_MOST)
    return vs_fail_at(err, port.where, "more than %d ports", VS_DECK_MOST);
  deck->ports[deck->n_ports++] = port;
  vs_cursor_skip(c);
  return *c->at ? vs_fail_at(err, vs_cursor_here(c), "nothing may follow the source's name")
                : VS_OK;
}

/* probe NAME = [-]v(n) | v(n,m) | i(Vx)  UNIT  "TEXT" */
static vs_status read_probe(vs_deck *deck, vs_cursor *c, vs_error *err) {
  vs_probe probe = {.sign = 1};
  char first[VS_DECK_NAME - 4], second[VS_DECK_NAME - 4];
  vs_cursor_skip(c);
  probe.where = vs_cursor_here(c);
  vs_status status = vs_cursor_name(c, probe.name, VS_DECK_NAME, err);
  if (status) return status;
  if (vs_cursor_take(c, '-')) probe.sign = -1;
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  char quantity = (char)tolower((unsigned char)*c->at);
  bool good = (quantity == 'v' || quantity == 'i') && *c->at++ &&
              vs_formula_term_read(&c->at, quantity, first, second, sizeof first);
  if (good) vs_cursor_skip(c);
  probe.unit_at = vs_cursor_here(c);
  good = good && vs_cursor_word(c, "./^%", probe.unit, sizeof probe.unit);
  if (!good || !vs_units_known(probe.unit))
    return vs_fail_at(err, vs_cursor_here(c),
                      "'probe NAME = v(n) | v(n,m) | i(Vx)  UNIT' is wanted here");
  status = vs_cursor_text(c, probe.text, sizeof probe.text, err);
  if (status) return status;
  probe.term = vs_deck_add_term(deck, where, quantity, first, second);
  for (size_t k = 0; k < deck->n_probes; k++)
    if (!strcasecmp(deck->probes[k].name, probe.name)) /* files of some systems tell none apart */
      return vs_fail_at(err, probe.where, "probe %s stands here a second time; leave one out",
                        probe.name);
  if (deck->n_probes >= VS_DECK_MOST || probe.term < 0)
    return vs_fail_at(err, c->line, "more than %d probes and terms of formulas", VS_DECK_MOST);
  deck->probes[deck->n_probes++] = probe;
  return VS_OK;
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
      return vs_fail_at(err, c->line, "%s stands here a second time; leave one out", account->name);
  accounts->count++; /* its formula is freed with the deck, also when it is not good */
  return vs_deck_add_formula(deck, c, "", &account->formula, err);
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
  vs_cursor_lower(deck->line[0]);
  vs_cursor_lower(deck->line[1]);
  vs_cursor_skip(c);
  return *c->at ? vs_fail_at(err, vs_cursor_here(c), "nothing may follow the nodes") : VS_OK;
}

/* earth NODE */
static vs_status read_earth(vs_deck *deck, vs_cursor *c, vs_error *err) {
  if (*deck->earth) return vs_fail_at(err, c->line, "a second '*$ earth'");
  if (!vs_cursor_word(c, "._#", deck->earth, sizeof deck->earth))
    return vs_fail_at(err, vs_cursor_here(c), "'earth NODE' is wanted here");
  vs_cursor_lower(deck->earth);
  vs_cursor_skip(c);
  return *c->at ? vs_fail_at(err, vs_cursor_here(c), "nothing may follow the node") : VS_OK;
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

/* start operating_point */
static vs_status read_start(vs_deck *deck, vs_cursor *c, vs_error *err) {
  char word[VS_DECK_NAME];
  vs_cursor_skip(c);
  vs_where where = vs_cursor_here(c);
  vs_cursor_token(c, word, sizeof word);
  vs_cursor_skip(c);
  deck->stands = !strcmp(word, "operating_point") && !*c->at;
  return deck->stands ? VS_OK : vs_fail_at(err, where, "start: there is: operating_point");
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
  unsigned lost; /* VS_LOST_... where such a line cannot be read */
} DIRECTIVES[] = {{"title", read_title, 0},
                  {"param", read_param, VS_LOST_PARAM},
                  {"port", read_port, VS_LOST_PORT},
                  {"line", read_line_nodes, 0},
                  {"earth", read_earth, 0},
                  {"probe", read_probe, VS_LOST_PROBE},
                  {"loss", read_loss, 0},
                  {"store", read_store, 0},
                  {"part", vs_parts_kind, 0},
                  {"limit", vs_parts_limit, 0},
                  {"rating", vs_parts_rating, 0},
                  {"require", vs_parts_require, 0},
                  {"device", vs_devices_line, 0},
                  {"time_current", vs_devices_time_current, 0},
                  {"derate", vs_devices_derate, 0},
                  {"zth", vs_devices_zth, 0},
                  {"pulse", vs_devices_pulse, 0},
                  {"surge", vs_devices_surge, 0},
                  {"at", vs_devices_at, 0},
                  {"model", vs_parts_model, 0},
                  {"start", read_start, 0},
                  {"compat", read_compat, 0}};
enum { N_DIRECTIVES = sizeof DIRECTIVES / sizeof *DIRECTIVES };

bool vs_contract_knows(const char *text) {
  size_t n = 0;
  while (isalnum((unsigned char)text[n]) || text[n] == '_') n++;
  for (size_t k = 0; k < N_DIRECTIVES; k++)
    if (strlen(DIRECTIVES[k].word) == n && !strncmp(DIRECTIVES[k].word, text, n)) return true;
  return false;
}

vs_status vs_contract_line(vs_deck *deck, const char *line, vs_where begin, vs_error *err) {
  vs_cursor cursor_here = {line, line + begin.column + 1, begin, deck->column}, *c = &cursor_here;
  char word[VS_DECK_NAME] = "";
  const char *names[N_DIRECTIVES];
  if (c->column) c->line.column = *c->column;
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
  vs_text all = {0};
  for (size_t k = 0; k < N_DIRECTIVES; k++) vs_text_add(&all, "%s%s", k ? ", " : "", names[k]);
  vs_status status = vs_fail_at(err, where, "'*$ %s' is not known; there are: %s%s", word, all.text,
                                vs_text_hint(word, names, N_DIRECTIVES, "").text);
  vs_text_free(&all);
  return status;
}
