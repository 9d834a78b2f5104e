/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "declare.h"

#include <ctype.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"

/* ---- names ---- */

static bool is_name(const char *name) {
  if (!isalpha((unsigned char)*name)) return false;
  for (; *name; name++)
    if (!isalnum((unsigned char)*name) && *name != '_') return false;
  return true;
}

/* Who has the name already; NULL: nobody. */
static const char *owner_of(const vs_machine *m, const char *name) {
  static const char *const TERMS[] = {"z", "lambda", "i", "force", "t", "pi"};
  for (size_t k = 0; k < sizeof TERMS / sizeof *TERMS; k++)
    if (!strcmp(name, TERMS[k])) return "the program";
  for (int k = 0; k < m->n_names; k++)
    if (!strcmp(name, m->names[k].name)) return k < m->n_parameters ? "a parameter" : "a let";
  for (int k = 0; k < m->dof; k++) {
    const vs_coordinate *c = &m->coordinates[k];
    if (!strcmp(name, c->name)) return "a coordinate";
    if (!strcmp(name, c->rate) || !strcmp(name, c->rate2)) return "a coordinate's rate";
  }
  for (int k = 0; k < m->n_probes; k++)
    if (!strcmp(name, m->probes[k].name)) return "a probe";
  return NULL;
}

vs_status vs_declare_check(const vs_machine *m, const char *what, const char *name, vs_where where,
                           vs_error *err) {
  const char *owner = owner_of(m, name);
  if (!is_name(name) || strlen(name) >= VS_MACHINE_NAME)
    return vs_fail_at(err, where,
                      "%s '%s': a name is a letter, then letters, digits and _, %d at the most",
                      what, name, VS_MACHINE_NAME - 1);
  if (owner)
    return vs_fail_at(err, where, "%s '%s': that name is %s's; give yours another name", what, name,
                      owner);
  return VS_OK;
}

vs_status vs_declare_name(vs_machine *m, const char *name, vs_machine_name entry, vs_where where,
                          vs_error *err) {
  vs_status status = vs_declare_check(m, "name", name, where, err);
  if (status) return status;
  if (m->n_names >= VS_MACHINE_NAMES)
    return vs_fail_at(err, where, "more than %d names", VS_MACHINE_NAMES);
  snprintf(entry.name, sizeof entry.name, "%s", name);
  m->names[m->n_names++] = entry;
  return VS_OK;
}

vs_status vs_declare_text(const vs_node *node, const char *what, char *text, size_t size,
                          vs_error *err) {
  *text = '\0';
  if (!node) return VS_OK;
  if (node->kind != VS_NODE_TEXT)
    return vs_fail_at(err, node->where, "%s: one line of text is wanted", what);
  if (strlen(node->text) >= size)
    return vs_fail_at(err, node->where, "%s: longer than %zu bytes", what, size - 1);
  snprintf(text, size, "%s", node->text);
  return VS_OK;
}

/* ---- coordinates ---- */

/* The rate's unit: "m" gives "m/s" and "m/s2", "N/m" gives "N/m.s", "" gives "1/s". */
static void rate_unit(const char *unit, const char *per, char *text, size_t size) {
  if (!*unit)
    snprintf(text, size, "1/%s", per);
  else
    snprintf(text, size, "%s%s%s", unit, strchr(unit, '/') ? "." : "/", per);
}

const vs_inside vs_declare_coordinate_keys = {
    .rows = VS_ROWS({"unit", .kind = VS_NEEDED | VS_TEXT}, {"text", .kind = VS_TEXT | VS_NOTHING})};

/* {unit: m, text: trough} */
static vs_status read_coordinate(vs_machine *m, const vs_node *node, vs_error *err) {
  vs_coordinate c = {.where = node->key_where};
  char what[VS_MACHINE_NAME + 24];
  snprintf(what, sizeof what, "coordinates.%.*s", VS_MACHINE_NAME - 1, node->key);
  vs_status s = vs_declare_check(m, "coordinate", node->key, node->key_where, err);
  if (s) return s;
  if (!strcmp(node->key, "gap"))
    return vs_fail_at(err, node->key_where,
                      "coordinate 'gap': its measures would be gap_min and gap_max, which are the "
                      "travel's; give yours another name");
  if (m->dof >= VS_MACHINE_COORDINATES)
    return vs_fail_at(err, node->key_where, "more than %d coordinates", VS_MACHINE_COORDINATES);
  if (node->kind != VS_NODE_MAP)
    return vs_fail_at(err, node->where, "%s: {unit: m, text: ...} is wanted", what);
  const vs_node *unit = vs_tree_child(node, "unit");
  s = vs_field_map_keys(node, what, &vs_declare_coordinate_keys, err);
  if (!s) s = vs_declare_text(unit, what, c.unit, sizeof c.unit, err);
  if (!s) s = vs_declare_text(vs_tree_child(node, "text"), what, c.text, sizeof c.text, err);
  if (s) return s;
  if (!unit)
    return vs_fail_at(err, node->where, "%s: a unit is wanted: m or rad, for example", what);
  if (!vs_units_known(c.unit) || vs_units_factor(c.unit) != 1)
    return vs_fail_at(err, unit->where,
                      "%s: '%s' is no unit of the SI without a prefix; m or rad, for example, is",
                      what, c.unit);
  snprintf(c.name, sizeof c.name, "%s", node->key);
  snprintf(c.rate, sizeof c.rate, "v%.*s", VS_MACHINE_NAME - 2, node->key);
  snprintf(c.rate2, sizeof c.rate2, "a%.*s", VS_MACHINE_NAME - 2, node->key);
  rate_unit(c.unit, "s", c.rate_unit, sizeof c.rate_unit);
  rate_unit(c.unit, "s2", c.rate2_unit, sizeof c.rate2_unit);
  snprintf(c.rate_text, sizeof c.rate_text, "velocity of %s", c.name);
  snprintf(c.rate2_text, sizeof c.rate2_text, "acceleration of %s", c.name);
  s = vs_declare_check(m, "coordinate's rate", c.rate, node->key_where, err);
  if (!s) s = vs_declare_check(m, "coordinate's rate", c.rate2, node->key_where, err);
  if (!s) m->coordinates[m->dof++] = c;
  return s;
}

/* Units and limits of `start`, chosen so that a typing error is found: no armature starts a metre
 * away. For other units the limits are wide. */
static const struct start_limit {
  const char *unit, *shown;
  double most;
  double most_rate;
} START_LIMITS[] = {{"m", "mm", 1000, 100}, {"rad", "rad", 1, 1000}, {NULL, NULL, 1e9, 1e9}};

static const struct start_limit *limit_of(const char *unit) {
  const struct start_limit *limit = START_LIMITS;
  while (limit->unit && strcmp(limit->unit, unit) != 0) limit++;
  return limit;
}

/* The section start: coordinates, then their rates, in the order of a state. */
static void make_start(vs_machine *m) {
  char text[VS_MACHINE_TEXT + 32], zero[32];
  for (int k = 0; k < 2 * m->dof; k++) {
    const vs_coordinate *c = &m->coordinates[k % m->dof];
    const struct start_limit *limit = limit_of(c->unit);
    bool rate = k >= m->dof;
    double most = rate ? limit->most_rate : limit->most;
    const char *unit = rate ? c->rate_unit : limit->shown ? limit->shown : c->unit;
    snprintf(zero, sizeof zero, "0%s%s", *unit ? " " : "", unit);
    snprintf(text, sizeof text, "%s%s at t = 0%s", rate ? "velocity of " : "", c->name,
             k == m->dof ? ": a kick" : "");
    vs_machine_add_field(&m->start, &(vs_field){.key = rate ? c->rate : c->name,
                                                .kind = VS_REAL,
                                                .unit = unit,
                                                .default_text = zero,
                                                .min = -most,
                                                .max = most,
                                                .offset = (size_t)k * sizeof(double),
                                                .text = text});
  }
}

vs_status vs_declare_coordinates(vs_machine *m, const vs_node *map, vs_error *err) {
  vs_status s = VS_OK;
  if (!map || map->kind != VS_NODE_MAP)
    return vs_error_keep(
        err, vs_fail_at(err, map ? map->where : (vs_where){m->tree.name, 1, 1},
                        "coordinates are wanted: coordinates: {x: {unit: m, text: ...}, ...}"));
  for (const vs_node *n = map->child; n && !s; n = n->next)
    s = vs_error_keep(err, read_coordinate(m, n, err));
  if (!s && !m->dof && !vs_error_count(err))
    s = vs_error_keep(err, vs_fail_at(err, map->where, "coordinates: one at least is wanted"));
  if (!s) make_start(m);
  return s;
}

/* ---- parameters ---- */

/* A parameter as it is read. */
typedef struct declaration {
  vs_field field;
  char what[VS_MACHINE_NAME + 24], unit[24], default_text[64], choices[200], text[VS_MACHINE_TEXT];
} declaration;

/* The unit of "20 kg": what follows the number. */
static vs_status take_unit(declaration *d, const vs_node *value, vs_error *err) {
  char *end, why[200];
  double si;
  strtod(value->text, &end);
  end += strspn(end, " ");
  snprintf(d->unit, sizeof d->unit, "%s", end == value->text ? "" : end);
  if (vs_text_out_of_range(value->text))
    return vs_fail_at(err, value->where, "%s: the default '%s': %s", d->what, value->text,
                      vs_text_out_of_range(value->text));
  if (!vs_units_known(d->unit) || !vs_units_read(value->text, d->unit, &si, why, sizeof why))
    return vs_fail_at(
        err, value->where,
        "%s: the default '%s' is not a number with a unit known here; write it as '6 kg'", d->what,
        value->text);
  return VS_OK;
}

/* One end of a range, in the parameter's unit: "1e-6 kg"; nothing: there is no such end. */
static bool read_range_end(const declaration *d, const char *text, double none, double *value) {
  char why[200], *end;
  double si;
  text += strspn(text, " ");
  *value = none;
  if (!*text) return true;
  *value = vs_text_to_number(text, &end);
  end += strspn(end, " ");
  if (end != text && !strcmp(end, d->unit)) return true; /* not rounded by a conversion */
  if (!vs_units_read(text, d->unit, &si, why, sizeof why)) return false;
  *value = si / vs_units_factor(d->unit);
  return true;
}

/* A .. B, where either may be missing */
static vs_status read_range(declaration *d, const vs_node *node, vs_error *err) {
  char words[128];
  d->field.min = -INFINITY;
  d->field.max = INFINITY;
  if (!node) return VS_OK;
  bool good = node->kind == VS_NODE_TEXT && strlen(node->text) < sizeof words;
  snprintf(words, sizeof words, "%s", good ? node->text : "");
  char *dots = strstr(words, "..");
  const char *first = vs_text_out_of_range(words),
             *beyond = first || !dots ? first : vs_text_out_of_range(dots + 2);
  if (beyond) return vs_fail_at(err, node->where, "%s: '%s': %s", d->what, words, beyond);
  if (dots) {
    *dots = '\0';
    for (char *c = dots; c > words && c[-1] == ' ';) *--c = '\0';
    good = read_range_end(d, words, -INFINITY, &d->field.min) &&
           read_range_end(d, dots + 2, INFINITY, &d->field.max) && d->field.min <= d->field.max;
  }
  return good && dots ? VS_OK
                      : vs_fail_at(err, node->where,
                                   "%s: a range is wanted: 'A .. B' in %s, from the less to the "
                                   "more; either end may be left out",
                                   d->what, *d->unit ? d->unit : "plain numbers");
}

static vs_status read_flag(const vs_node *node, const char *what, bool *flag, vs_error *err) {
  *flag = node && node->kind == VS_NODE_TEXT && !strcmp(node->text, "true");
  if (!node || *flag || (node->kind == VS_NODE_TEXT && !strcmp(node->text, "false"))) return VS_OK;
  return vs_fail_at(err, node->where, "%s.open: true or false is wanted", what);
}

/* choices: one|other, or [one, other] */
static vs_status read_choices(declaration *d, const vs_node *node, vs_error *err) {
  const vs_node *first = node->kind == VS_NODE_LIST ? node->child : node;
  size_t n = 0;
  for (const vs_node *w = first; w && n < sizeof d->choices;
       w = node->kind == VS_NODE_LIST ? w->next : NULL) {
    if (w->kind != VS_NODE_TEXT || !*w->text) first = NULL;
    n += (size_t)snprintf(d->choices + n, sizeof d->choices - n, "%s%s", n ? "|" : "",
                          w->text ? w->text : "");
  }
  if (first && n < sizeof d->choices && strchr(d->choices, '|')) return VS_OK;
  return vs_fail_at(err, node->where, "%s.choices: two words or more are wanted: one|other",
                    d->what);
}

/* What kind of parameter it is, with unit and default. */
static vs_status read_default(declaration *d, const vs_node *node, vs_error *err) {
  const vs_node *value = vs_tree_child(node, "default"), *choices = vs_tree_child(node, "choices");
  const vs_node *x = value && value->kind == VS_NODE_LIST ? value->child : NULL,
                *y = x ? x->next : NULL;
  bool pair = x && y && !y->next && x->kind == VS_NODE_TEXT && y->kind == VS_NODE_TEXT;
  bool word = value && value->kind == VS_NODE_TEXT && *value->text;
  if (!word && (!pair || choices))
    return vs_fail_at(err, value ? value->where : node->where,
                      "%s: a default is wanted: '20 kg', '[194 mm, 89 mm]', or a word of `choices`",
                      d->what);
  int n = snprintf(d->default_text, sizeof d->default_text, "%s%s%s", pair ? x->text : value->text,
                   pair ? ", " : "", pair ? y->text : "");
  if (n < 0 || (size_t)n >= sizeof d->default_text)
    return vs_fail_at(err, value->where, "%s: too long a default", d->what);
  d->field.kind = choices ? VS_CHOICE : pair ? VS_PAIR : VS_REAL;
  if (choices) return read_choices(d, choices, err);
  return take_unit(d, pair ? x : value, err);
}

static const vs_field TEXT = {.kind = VS_TEXT};
static const vs_inside TWO = {.rows = &TEXT, .count = 2}, SOME = {.rows = &TEXT};
const vs_inside vs_declare_parameter_keys = {
    .rows = VS_ROWS({"default", VS_NEEDED | VS_TEXT | VS_LIST, .inside = &TWO},
                    {"range", .kind = VS_TEXT}, {"open", .kind = VS_FLAG},
                    {"choices", VS_TEXT | VS_LIST, .inside = &SOME},
                    {"text", .kind = VS_TEXT | VS_NOTHING})};

static vs_status read_declaration(const vs_node *node, declaration *d, vs_error *err) {
  const vs_node *range = vs_tree_child(node, "range");
  snprintf(d->what, sizeof d->what, "parameters.%.*s", VS_MACHINE_NAME - 1, node->key);
  if (node->kind != VS_NODE_MAP)
    return vs_fail_at(err, node->where,
                      "%s: {default: 20 kg, range: 0 kg .. 100 kg, text: ...} is wanted", d->what);
  vs_status s = vs_field_map_keys(node, d->what, &vs_declare_parameter_keys, err);
  if (!s) s = read_default(d, node, err);
  if (!s && range && d->field.kind == VS_CHOICE)
    s = vs_fail_at(err, range->where, "%s: a choice has no range", d->what);
  if (!s && d->field.kind != VS_CHOICE) s = read_range(d, range, err);
  if (!s) s = read_flag(vs_tree_child(node, "open"), d->what, &d->field.open, err);
  if (!s) s = vs_declare_text(vs_tree_child(node, "text"), d->what, d->text, sizeof d->text, err);
  d->field.key = node->key;
  d->field.unit = d->unit;
  d->field.default_text = d->default_text;
  d->field.text = d->text;
  d->field.choices = d->field.kind == VS_CHOICE ? d->choices : NULL;
  return s;
}

/* Checks that a scene might have the default as its value: it is read in its place where the scene
 * has none. */
static vs_status check_default(const declaration *d, const vs_node *node, vs_error *err) {
  static const vs_section OF_FILE = {.name = "parameters"};
  double values[2];
  vs_field field = d->field;
  field.offset = 0;
  return vs_field_read(&OF_FILE, &field, vs_tree_child(node, "default"), values, err);
}

/* Adds the field to the section, and its names to those that formulas know. */
static vs_status add_parameter(vs_machine *m, const declaration *d, vs_where where, vs_error *err) {
  vs_field field = d->field;
  int choices = 0, n = field.kind == VS_PAIR ? 2 : 1;
  vs_status s = strcmp(field.key, vs_machine_key.key)
                    ? vs_declare_check(m, "parameter", field.key, where, err)
                    : vs_fail_at(err, where, "parameter '%s': that name is the program's",
                                 vs_machine_key.key);
  if (s) return s;
  if (m->section.count > VS_MACHINE_PARAMETERS)
    return vs_fail_at(err, where, "more than %d parameters", VS_MACHINE_PARAMETERS);
  for (int k = 0; k < m->n_names; k++) choices += m->names[k].choice >= 0;
  field.offset = offsetof(vs_machine_values, real) + (size_t)m->n_names * sizeof(double);
  if (field.kind == VS_CHOICE)
    field.offset = offsetof(vs_machine_values, choice) + (size_t)choices * sizeof(int);
  vs_machine_add_field(&m->section, &field);
  for (int k = 0; k < n; k++) {
    vs_machine_name *name = &m->names[m->n_names++];
    *name = (vs_machine_name){.choice = field.kind == VS_CHOICE ? choices : -1,
                              .dimension = vs_dimension_of(field.unit)};
    snprintf(name->name, sizeof name->name, "%.*s%s", VS_MACHINE_NAME - 1, field.key,
             n == 1 ? ""
             : k    ? ".y"
                    : ".x");
  }
  m->n_parameters = m->n_names;
  return VS_OK;
}

static vs_status read_parameter(vs_machine *m, const vs_node *node, vs_error *err) {
  declaration d = {.field = {.unit = ""}};
  vs_status s = read_declaration(node, &d, err);
  if (!s) s = check_default(&d, node, err);
  return s ? s : add_parameter(m, &d, node->key_where, err);
}

vs_status vs_declare_parameters(vs_machine *m, const vs_node *map, vs_error *err) {
  vs_status s = VS_OK;
  if (map && map->kind == VS_NODE_TEXT && !*map->text) return VS_OK;
  if (map && map->kind != VS_NODE_MAP)
    return vs_error_keep(err, vs_fail_at(err, map->where,
                                         "parameters: a map is wanted: {NAME: {default: "
                                         "20 kg, ...}, ...}"));
  for (const vs_node *n = map ? map->child : NULL; n && !s; n = n->next)
    s = vs_error_keep(err, read_parameter(m, n, err));
  return s;
}
