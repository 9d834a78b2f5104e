/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "circuit/contract.h"

#include <ctype.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"

void vs_lower(char *s) {
  for (; *s; s++) *s = (char)tolower((unsigned char)*s);
}

typedef struct cursor {
  const char *start, *at;
  vs_where line;
} cursor;

static vs_where here(const cursor *c) {
  vs_where w = c->line;
  w.column = (int)(c->at - c->start) + 1;
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

static vs_status add_param(vs_deck *deck, const vs_field *field, vs_where where, vs_error *err) {
  size_t n = deck->section.count - 1; /* parameters so far, behind the key deck */
  for (size_t k = 0; k < deck->section.count; k++)
    if (!strcmp(deck->section.fields[k].key, field->key))
      return vs_fail_at(err, where, "param %s stands here a second time%s", field->key,
                        k ? "" : ": that key is the program's");
  if (n >= VS_DECK_MOST) return vs_fail_at(err, where, "more than %d parameters", VS_DECK_MOST);
  vs_field *own = &vs_deck_fields(deck)[deck->section.count++];
  *own = *field;
  own->offset = offsetof(vs_circuit_values, params) + n * sizeof(double);
  own->key = vs_copy(field->key);
  own->unit = vs_copy(field->unit);
  own->default_text = vs_copy(field->default_text);
  own->text = vs_copy(field->text);
  return VS_OK;
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
  if (!strstr(range, "..")) { /* that was the unit */
    memcpy(unit, range, sizeof unit);
    take_token(c, range, sizeof range);
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
  return status ? status : add_param(deck, &field, at_value, err);
}

/* port mains = SOURCE, port gate+180deg = SOURCE */
static vs_status read_port(vs_deck *deck, cursor *c, vs_error *err) {
  char name[VS_DECK_NAME], why[200];
  vs_port port = {.where = here(c)};
  if (!take_word(c, "+.", name, sizeof name) || !take(c, '=') ||
      !take_word(c, ".", port.source, sizeof port.source))
    return vs_fail_at(err, here(c), "'port NAME = SOURCE' is wanted here");
  char *shift = strchr(name, '+');
  if (shift) *shift++ = '\0';
  if (!strcmp(name, "mains") && !shift)
    port.kind = VS_PORT_MAINS;
  else if (!strcmp(name, "gate"))
    port.kind = VS_PORT_GATE;
  else
    return vs_fail_at(err, port.where, "no port '%s'; there are: mains, gate, gate+ANGLE", name);
  if (shift && !vs_quantity(shift, "deg", &port.shift_rad, why, sizeof why))
    return vs_fail_at(err, port.where, "port gate: %s", why);
  vs_lower(port.source);
  if (port.source[0] != 'v')
    return vs_fail_at(err, port.where, "a port drives a voltage source (V...), not '%s'",
                      port.source);
  for (size_t k = 0; k < deck->n_ports; k++)
    if (!strcmp(deck->ports[k].source, port.source))
      return vs_fail_at(err, port.where, "source %s has a port already", port.source);
  if (deck->n_ports >= VS_DECK_MOST)
    return vs_fail_at(err, port.where, "more than %d ports", VS_DECK_MOST);
  deck->ports[deck->n_ports++] = port;
  skip_blanks(c);
  return *c->at ? vs_fail_at(err, here(c), "nothing may follow the source's name") : VS_OK;
}

/* probe NAME = [-]v(n) | v(n,m) | i(Vx)  UNIT  "TEXT" */
static vs_status read_probe(vs_deck *deck, cursor *c, vs_error *err) {
  vs_probe probe = {.sign = 1, .minus = "v(0)"};
  char first[VS_DECK_NAME - 4], second[VS_DECK_NAME - 4] = "0";
  vs_status status = take_name(c, probe.name, err);
  if (status) return status;
  if (take(c, '-')) probe.sign = -1;
  skip_blanks(c);
  char quantity = (char)tolower((unsigned char)*c->at);
  static const char NODE[] = ".#+-:"; /* besides letters, digits and '_' */
  bool good = (quantity == 'v' || quantity == 'i') && *c->at++ && take(c, '(') &&
              take_word(c, NODE, first, sizeof first);
  if (good && quantity == 'v' && take(c, ',')) good = take_word(c, NODE, second, sizeof second);
  good = good && take(c, ')') && take_word(c, "./^%", probe.unit, sizeof probe.unit);
  if (!good || !vs_unit_known(probe.unit))
    return vs_fail_at(err, here(c), "'probe NAME = v(n) | v(n,m) | i(Vx)  UNIT' is wanted here");
  status = take_text(c, probe.text, sizeof probe.text, err);
  if (status) return status;
  vs_lower(first);
  vs_lower(second);
  snprintf(probe.plus, sizeof probe.plus, "%c(%s)", quantity, first);
  snprintf(probe.minus, sizeof probe.minus, "v(%s)", second);
  for (size_t k = 0; k < deck->n_probes; k++)
    if (!strcmp(deck->probes[k].name, probe.name))
      return vs_fail_at(err, c->line, "probe %s stands here a second time", probe.name);
  if (deck->n_probes >= VS_DECK_MOST)
    return vs_fail_at(err, c->line, "more than %d probes", VS_DECK_MOST);
  deck->probes[deck->n_probes++] = probe;
  return VS_OK;
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
} DIRECTIVES[] = {
    {"title", read_title}, {"param", read_param}, {"port", read_port}, {"probe", read_probe}};
enum { N_DIRECTIVES = sizeof DIRECTIVES / sizeof *DIRECTIVES };

vs_status vs_contract_line(vs_deck *deck, const char *line, vs_where begin, vs_error *err) {
  cursor cursor_here = {line, line + begin.column + 1, begin}, *c = &cursor_here;
  char word[VS_DECK_NAME] = "";
  const char *names[N_DIRECTIVES];
  skip_blanks(c);
  vs_where where = here(c);
  take_word(c, "", word, sizeof word);
  for (size_t k = 0; k < N_DIRECTIVES; k++) {
    if (!strcmp(word, DIRECTIVES[k].word)) return DIRECTIVES[k].read(deck, c, err);
    names[k] = DIRECTIVES[k].word;
  }
  const char *nearest = vs_nearest(word, names, N_DIRECTIVES);
  return vs_fail_at(err, where, "'*$ %s' is not known; there are: title, param, port, probe%s%s%s",
                    word, nearest ? "; did you mean '" : "", nearest ? nearest : "",
                    nearest ? "'?" : "");
}
