/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/field.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/units.h"

void vs_field_range(const vs_field *field, char *text, size_t size) {
  const char *space = *field->unit ? " " : "";
  if (field->kind == VS_OPTION) {
    int n = snprintf(text, size, "%s or {", field->choices);
    const vs_section *keys = &field->inside->keys;
    for (size_t k = 0; k < keys->count && n > 0 && (size_t)n < size; k++)
      n += snprintf(text + n, size - (size_t)n, "%s%s", keys->fields[k].key,
                    k + 1 < keys->count ? ", " : "}");
    if (field->inside->most > 1 && n > 0 && (size_t)n < size)
      snprintf(text + n, size - (size_t)n, " or a list");
    return;
  }
  if (field->kind == VS_CHOICE || field->kind == VS_NAME)
    snprintf(text, size, "%s", field->choices ? field->choices : "");
  else
    snprintf(text, size, "%s%s%g..%g%s%s%s%s", field->choices ? field->choices : "",
             field->choices ? " or " : "", field->min, field->max, space, field->unit,
             field->open ? " (ends excluded)" : "",
             field->kind == VS_PROFILE ? ", or over time: [[TIME, VALUE], ...]" : "");
}

bool vs_field_is_idle(const vs_field *field, const void *values) {
  const void *member = (const char *)values + field->offset;
  if (field->kind == VS_OPTION) return field->open && !*(const int *)member;
  const double value = field->kind & (VS_FACTOR | VS_REAL) ? *(const double *)member : 0;
  if (field->kind == VS_FACTOR) return value == 1;
  return field->kind == VS_REAL && isnan(value) && field->choices &&
         !strcmp(field->choices, "none");
}

static vs_status read_real(const char *name, const vs_field *field, const vs_node *node,
                           double *out, vs_error *err) {
  char why[256], range[128];
  double si;
  if (node->kind != VS_NODE_TEXT)
    return vs_fail_at(err, node->where, "%s: one value is wanted, for example %s", name,
                      field->default_text);
  if (field->kind == VS_REAL && field->choices && !strcmp(node->text, field->choices)) {
    *out = NAN;
    return VS_OK;
  }
  if (!vs_units_read(node->text, field->unit, &si, why, sizeof why))
    return vs_fail_at(err, node->where, "%s: %s", name, why);
  double shown = si / vs_units_factor(field->unit);
  const double rounding = 1e-12; /* by the unit's conversion */
  double least = field->min - rounding * fabs(field->min),
         most = field->max + rounding * fabs(field->max);
  bool inside =
      field->open ? shown > field->min && shown < field->max : shown >= least && shown <= most;
  if (inside) {
    *out = si;
    return VS_OK;
  }
  vs_field_range(field, range, sizeof range);
  return vs_fail_at(err, node->where, "%s: %s is out of range; allowed: %s", name, node->text,
                    range);
}

/* ---- a quantity over time ---- */

double vs_field_profile_at(const vs_field_profile *c, double t_s) {
  int k = 0;
  if (!c->count) return c->first;
  while (k < c->count && c->at_s[k] <= t_s) k++;
  if (k == 0) return c->value[0];
  if (k == c->count) return c->value[k - 1];
  double share = (t_s - c->at_s[k - 1]) / (c->at_s[k] - c->at_s[k - 1]);
  return c->value[k - 1] + share * (c->value[k] - c->value[k - 1]);
}

bool vs_field_is_real(const vs_field *field) {
  return field->kind == VS_REAL || field->kind == VS_FACTOR || field->kind == VS_PROFILE;
}

/* Reads one point, [TIME, VALUE], behind those that the table has. */
static vs_status read_point(const char *name, const vs_field *field, const vs_node *node,
                            vs_field_profile *c, vs_error *err) {
  static const vs_field TIME = {.kind = VS_REAL, .unit = "s", .default_text = "0 s", .max = 1e9};
  int k = c->count;
  const vs_node *at = node->kind == VS_NODE_LIST ? node->child : NULL;
  if (k == VS_PROFILE_MOST)
    return vs_fail_at(err, node->where, "%s: a list of at most %d points is allowed", name, k);
  if (!at || !at->next || at->next->next)
    return vs_fail_at(err, node->where, "%s: each point is a time and a value: [0 s, %s]", name,
                      field->default_text);
  vs_status status = read_real(name, &TIME, at, &c->at_s[k], err);
  if (!status) status = read_real(name, field, at->next, &c->value[k], err);
  if (status) return status;
  if (k && c->at_s[k] < c->at_s[k - 1])
    return vs_fail_at(err, at->where, "%s: %g s stands behind %g s; times must not go back", name,
                      c->at_s[k], c->at_s[k - 1]);
  c->count++;
  return VS_OK;
}

/* Reads the one value, or a list of points. */
static vs_status read_profile(const char *name, const vs_field *field, const vs_node *node,
                              vs_field_profile *out, vs_error *err) {
  vs_field_profile read = {0};
  vs_status status = VS_OK;
  if (node->kind != VS_NODE_LIST) {
    status = read_real(name, field, node, &read.first, err);
  } else {
    if (!node->child) return vs_fail_at(err, node->where, "%s: the list has no points", name);
    for (const vs_node *n = node->child; n && !status; n = n->next)
      status = read_point(name, field, n, &read, err);
    read.first = read.value[0];
  }
  if (!status) *out = read;
  return status;
}

static vs_status read_choice(const char *name, const vs_field *field, const vs_node *node, int *out,
                             vs_error *err) {
  char words[256], *rest = words;
  snprintf(words, sizeof words, "%s", field->choices);
  int choice = 0;
  for (char *word; (word = strsep(&rest, "|")); choice++) {
    if (node->kind != VS_NODE_TEXT || strcmp(word, node->text)) continue;
    *out = choice;
    return VS_OK;
  }
  return vs_fail_at(err, node->where, "%s: '%s' is not one of: %s", name,
                    node->kind == VS_NODE_TEXT ? node->text : "a list or map", field->choices);
}

static vs_status read_count(const char *name, const vs_field *field, const vs_node *node, int *out,
                            vs_error *err) {
  double value;
  if (field->choices && node->kind == VS_NODE_TEXT && !strcmp(node->text, field->choices)) {
    *out = 0;
    return VS_OK;
  }
  vs_status status = read_real(name, field, node, &value, err);
  if (status) return status;
  if ((double)(int)value != value)
    return vs_fail_at(err, node->where, "%s: %s is not a whole number", name, node->text);
  *out = (int)value;
  return VS_OK;
}

const vs_section *vs_field_form(const vs_inside *inside, const void *values) {
  int choice;
  if (!inside->forms) return &inside->keys;
  memcpy(&choice, (const char *)values + inside->keys.fields[inside->chooser].offset,
         sizeof choice);
  return &inside->forms[choice];
}

int vs_field_maps(const vs_field *field, const void *member) {
  int count = 0, present = 1;
  for (; count < field->inside->most && present; count += present)
    memcpy(&present, (const char *)member + (size_t)count * field->inside->size, sizeof present);
  return count;
}

static vs_status read_default(const vs_section *section, const vs_field *field, void *out,
                              vs_error *err);

/* Reads one map of an option: first the key on which the others depend. */
static vs_status read_map(const vs_field *field, const vs_node *map, void *out, vs_error *err) {
  const vs_inside *inside = field->inside;
  int present = 1;
  if (inside->forms) {
    const vs_field *chooser = &inside->keys.fields[inside->chooser];
    const vs_node *node = vs_tree_child(map, chooser->key);
    vs_status status = read_default(&inside->keys, chooser, out, err);
    if (!status && node)
      status = vs_error_keep(err, vs_field_read(&inside->keys, chooser, node, out, err));
    if (status) return status;
  }
  memcpy(out, &present, sizeof present);
  return vs_field_section_read(vs_field_form(inside, out), map, out, err);
}

static vs_status read_option(const char *name, const vs_field *field, const vs_node *node,
                             char *member, vs_error *err) {
  const vs_inside *inside = field->inside;
  char range[160];
  memset(member, 0, (size_t)inside->most * inside->size);
  if (node->kind == VS_NODE_MAP) return read_map(field, node, member, err);
  if (node->kind == VS_NODE_TEXT && !strcmp(node->text, field->choices)) return VS_OK;
  const vs_node *item = inside->most > 1 && node->kind == VS_NODE_LIST ? node->child : NULL;
  vs_field_range(field, range, sizeof range);
  if (!item) return vs_fail_at(err, node->where, "%s: allowed: %s", name, range);
  vs_status status = VS_OK;
  for (int k = 0; item && !status; k++, item = item->next) {
    if (k == inside->most)
      status = vs_fail_at(err, item->where, "%s: a list of at most %d is allowed", name, k);
    else if (item->kind != VS_NODE_MAP)
      status = vs_fail_at(err, item->where, "%s: each of the list is a map of keys: {%s: %s, ...}",
                          name, inside->keys.fields[0].key, inside->keys.fields[0].default_text);
    else
      status = read_map(field, item, member + (size_t)k * inside->size, err);
    status = vs_error_keep(err, status);
    if (k == inside->most) break;
  }
  return status;
}

vs_status vs_field_read(const vs_section *section, const vs_field *field, const vs_node *node,
                        void *out, vs_error *err) {
  char name[128];
  snprintf(name, sizeof name, "%s.%s", section->name, field->key);
  char *member = (char *)out + field->offset;
  switch (field->kind) {
  case VS_REAL:
  case VS_FACTOR:
    return read_real(name, field, node, (double *)(void *)member, err);
  case VS_PROFILE:
    return read_profile(name, field, node, (vs_field_profile *)(void *)member, err);
  case VS_CHOICE:
    return read_choice(name, field, node, (int *)(void *)member, err);
  case VS_COUNT:
    return read_count(name, field, node, (int *)(void *)member, err);
  case VS_NAME:
    if (node->kind != VS_NODE_TEXT || !*node->text)
      return vs_fail_at(err, node->where, "%s: a name is wanted, for example %s", name,
                        field->default_text);
    if (strlen(node->text) >= VS_NAME_SIZE)
      return vs_fail_at(err, node->where, "%s: longer than %d bytes", name, VS_NAME_SIZE - 1);
    memcpy(member, node->text, strlen(node->text) + 1);
    return VS_OK;
  case VS_OPTION:
    return read_option(name, field, node, member, err);
  default: /* a pair; other kinds have readers of their own */
    break;
  }
  const vs_node *x = node->kind == VS_NODE_LIST ? node->child : NULL;
  if (!x || !x->next || x->next->next)
    return vs_fail_at(err, node->where, "%s: two values are wanted: [x, y]", name);
  double *pair = (double *)(void *)member;
  vs_status status = vs_error_keep(err, read_real(name, field, x, pair, err));
  return status ? status : read_real(name, field, x->next, pair + 1, err);
}

static vs_status read_default(const vs_section *section, const vs_field *field, void *out,
                              vs_error *err) {
  char words[128];
  snprintf(words, sizeof words, "%s", field->default_text);
  const vs_where where = {.file = "built-in default"};
  vs_node node = vs_tree_word(NULL, words, where);
  if (field->kind != VS_PAIR) return vs_field_read(section, field, &node, out, err);
  char *second = strchr(words, ',');
  *second = '\0';
  vs_node y = vs_tree_word(NULL, second + 1 + strspn(second + 1, " "), where);
  node.next = &y;
  vs_node list = {.kind = VS_NODE_LIST, .child = &node};
  return vs_field_read(section, field, &list, out, err);
}

/* Writes which keys there are, as far as the line has room: "it has: a, b, c". */
static void add_known(const char *const *names, size_t count, char *text, size_t size) {
  const char *const more = ", ...";
  size_t n = 0;
  *text = '\0';
  for (size_t k = 0; k < count; k++) {
    if (n + strlen(names[k]) + strlen("it has: ") + strlen(more) >= size) {
      snprintf(text + n, size - n, "%s", more);
      return;
    }
    n += (size_t)snprintf(text + n, size - n, "%s%s", k ? ", " : "it has: ", names[k]);
  }
}

vs_status vs_field_known_keys(const vs_node *map, const char *what, const char *const *names,
                              size_t count, vs_error *err) {
  if (map && map->kind == VS_NODE_LIST && map->child) /* whose items have no keys */
    return vs_fail_at(err, map->where, "%s: a map of keys is wanted, and this is a list", what);
  for (const vs_node *n = map ? map->child : NULL; n; n = n->next) {
    bool known = false;
    for (size_t k = 0; k < count && !known; k++) known = !strcmp(names[k], n->key);
    if (known) continue;
    const char *nearest = vs_text_nearest(n->key, names, count);
    char known_keys[240];
    add_known(names, count, known_keys, sizeof known_keys);
    vs_status status = vs_fail_at(err, n->key_where, "%s has no key '%s'; %s%s%s%s", what, n->key,
                                  nearest ? "did you mean '" : "", nearest ? nearest : "",
                                  nearest ? "'? " : "", known_keys);
    status = vs_error_keep(err, status);
    if (status) return status;
  }
  return VS_OK;
}

vs_status vs_field_map_keys(const vs_node *map, const char *what, const vs_inside *inside,
                            vs_error *err) {
  const vs_section *besides = inside->besides;
  size_t own = 0, count = 0;
  if (!map || !map->child) return VS_OK;
  while (inside->rows && inside->rows[own].kind) own++;
  const char **names = vs_alloc(own + (besides ? besides->count : 0), sizeof *names);
  while (count < own) names[count] = inside->rows[count].key, count++;
  for (size_t k = 0; besides && k < besides->count; k++) names[count++] = besides->fields[k].key;
  vs_status status = vs_field_known_keys(map, what, names, count, err);
  free(names);
  return status;
}

vs_status vs_field_section_keys(const vs_section *section, const vs_node *map, vs_error *err) {
  return vs_field_map_keys(map, section->name, &(vs_inside){.besides = section}, err);
}

vs_status vs_field_read_key(const vs_section *section, const vs_field *field, const vs_node *node,
                            void *out, vs_error *err) {
  vs_status status = read_default(section, field, out, err);
  if (status || !node) return status;
  return vs_error_keep(err, vs_field_read(section, field, node, out, err));
}

vs_status vs_field_section_read(const vs_section *section, const vs_node *map, void *out,
                                vs_error *err) {
  vs_status status = VS_OK;
  if (map && map->kind == VS_NODE_TEXT && !*map->text)
    map = NULL; /* the scene says "run:" and nothing more */
  if (map && map->kind != VS_NODE_MAP) {
    const bool colon = map->kind == VS_NODE_TEXT && strchr(map->text, ':');
    status = vs_fail_at(err, map->where, "%s: a map of keys is wanted: {key: value, ...}%s",
                        section->name, colon ? "; a blank has to follow each colon" : "");
    status = vs_error_keep(err, status);
    map = NULL;
  }
  if (!status) status = vs_field_section_keys(section, map, err);
  for (size_t k = 0; k < section->count && !status; k++) {
    const vs_field *field = &section->fields[k];
    status = vs_field_read_key(section, field, vs_tree_child(map, field->key), out, err);
  }
  return status;
}

/* Writes the word of that index among "paper|derived". */
static void add_choice(const char *choices, int choice, vs_json *json) {
  char words[256], *rest = words, *word = words;
  snprintf(words, sizeof words, "%s", choices);
  for (int k = 0; k <= choice; k++) word = strsep(&rest, "|");
  vs_json_text(json, NULL, word);
}

/* Writes {"value": 6, "unit": "mm"}; the value of a pair is [x, y]. */
static void add_quantity(const vs_field *field, const double *si, vs_json *json) {
  const double factor = vs_units_factor(field->unit);
  if (vs_field_is_real(field) && isnan(si[0])) {
    vs_json_text(json, NULL, field->choices);
    return;
  }
  vs_json_object(json, NULL, VS_JSON_ROW);
  if (field->kind == VS_PAIR) {
    vs_json_array(json, "value", VS_JSON_ROW);
    for (int k = 0; k < 2; k++) vs_json_number(json, NULL, si[k] / factor, 12);
    vs_json_end(json);
  } else
    vs_json_number(json, "value", si[0] / factor, 12);
  vs_json_text(json, "unit", field->unit);
  vs_json_end(json);
}

/* Writes {"value": [[0, 160], [1, 100]], "unit": "deg", "over": "s"}. */
static void add_profile(const vs_field *field, const vs_field_profile *c, vs_json *json) {
  const double factor = vs_units_factor(field->unit);
  vs_json_object(json, NULL, VS_JSON_ROW);
  vs_json_array(json, "value", VS_JSON_ROW);
  for (int k = 0; k < c->count; k++) {
    vs_json_array(json, NULL, VS_JSON_ROW);
    vs_json_number(json, NULL, c->at_s[k], 12);
    vs_json_number(json, NULL, c->value[k] / factor, 12);
    vs_json_end(json);
  }
  vs_json_end(json);
  vs_json_text(json, "unit", field->unit);
  vs_json_text(json, "over", "s");
  vs_json_end(json);
}

static void add_keys(const vs_section *keys, const void *values, vs_json *json) {
  vs_json_object(json, NULL, VS_JSON_ROW);
  for (size_t k = 0; k < keys->count; k++) {
    vs_json_key(json, keys->fields[k].key);
    vs_field_json(&keys->fields[k], values, json->text);
  }
  vs_json_end(json);
}

/* Writes the word where there is no map, the map where there is one, and a list of more. */
static void add_maps(const vs_field *field, const char *member, vs_json *json) {
  const vs_inside *inside = field->inside;
  int count = vs_field_maps(field, member);
  if (!count) vs_json_text(json, NULL, field->choices);
  if (count > 1) vs_json_array(json, NULL, VS_JSON_ROW);
  for (int k = 0; k < count; k++) {
    const char *values = member + (size_t)k * inside->size;
    add_keys(vs_field_form(inside, values), values, json);
  }
  if (count > 1) vs_json_end(json);
}

void vs_field_json(const vs_field *field, const void *values, vs_text *text) {
  const char *member = (const char *)values + field->offset;
  const vs_field_profile *profile = (const vs_field_profile *)(const void *)member;
  int whole = 0;
  vs_json json = vs_json_new(text);
  if (field->kind == VS_CHOICE || field->kind == VS_COUNT) memcpy(&whole, member, sizeof whole);
  switch (field->kind) {
  case VS_PROFILE:
    if (profile->count)
      add_profile(field, profile, &json);
    else
      add_quantity(field, &profile->first, &json);
    break;
  case VS_REAL:
  case VS_FACTOR:
  case VS_PAIR:
    add_quantity(field, (const double *)(const void *)member, &json);
    break;
  case VS_CHOICE:
    add_choice(field->choices, whole, &json);
    break;
  case VS_COUNT:
    if (field->choices && whole == 0)
      vs_json_text(&json, NULL, field->choices);
    else
      vs_json_whole(&json, NULL, whole);
    break;
  case VS_NAME:
    vs_json_text(&json, NULL, member);
    break;
  case VS_OPTION:
    add_maps(field, member, &json);
    break;
  default: /* no struct has it */
    break;
  }
}
