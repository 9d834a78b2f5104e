/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/axis.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"
#include "run/keys.h"

enum { MOST_VALUES = 10000000 };

static const char START[] = "start";

/* As many as study.csv has of an axis' number. */
static double to_12_digits(double value) {
  return vs_text_rounded(value, 12);
}

static double nominal_of(const vs_key *key) {
  double value = vs_key_number(key);
  return key->field->kind == VS_COUNT ? value
                                      : to_12_digits(value / vs_units_factor(key->field->unit));
}

static vs_status describe_axis(vs_axis *axis, const vs_key *key, vs_error *err) {
  char suffix[64];
  const vs_field *f = key->field;
  if (f->kind == VS_PAIR)
    return vs_fail_at(err, axis->where, "%s is a pair [x, y], and an axis has one value",
                      axis->key);
  if (f->kind == VS_OPTION)
    return vs_fail_at(err, axis->where, "%s has keys of its own, such as %s.%s: name one of those",
                      axis->key, axis->key, f->inside->keys.fields[0].key);
  snprintf(axis->section, sizeof axis->section, "%s", key->section);
  axis->field = f;
  axis->unit = f->unit;
  axis->is_word = f->kind == VS_CHOICE || f->kind == VS_NAME;
  axis->nominal = axis->is_word ? NAN : nominal_of(key);
  vs_units_suffix(f->unit, suffix, sizeof suffix);
  snprintf(axis->column, sizeof axis->column, "%.190s%s%.20s", axis->key, *suffix ? "_" : "",
           suffix);
  return VS_OK;
}

vs_status vs_axis_init(vs_axis *axis, const vs_scene *scene, const vs_node *node, const char *by,
                       vs_error *err) {
  vs_key key;
  vs_status status = vs_key_find(scene, node->key, node->key_where, &key, err);
  *axis = (vs_axis){.by = by, .where = node->key_where};
  snprintf(axis->key, sizeof axis->key, "%s", node->key);
  if (!status) status = describe_axis(axis, &key, err);
  if (!status && scene->setup.steady && !strcmp(key.section, START))
    status = vs_fail_at(
        err, axis->where,
        "%s would replace start: steady, which the scene says; take one of them out", axis->key);
  return status;
}

void vs_axis_free(vs_axis *axis) {
  for (size_t w = 0; w < axis->n_words; w++) free(axis->word[w]);
  free(axis->word);
  free(axis->word_where);
  free(axis->value);
  free(axis->own);
}

/* ---- values ---- */

static double add_axis_word(vs_axis *axis, const vs_node *node) {
  for (size_t k = 0; k < axis->n_words; k++)
    if (!strcmp(axis->word[k], node->text)) return (double)k;
  size_t n = axis->n_words++;
  axis->word = vs_alloc_grow(axis->word, n, sizeof *axis->word);
  axis->word_where = vs_alloc_grow(axis->word_where, n, sizeof *axis->word_where);
  axis->word[n] = vs_copy(node->text);
  axis->word_where[n] = node->where;
  return (double)n;
}

vs_status vs_axis_number(vs_axis *axis, const vs_node *node, double *number, vs_error *err) {
  union {
    double real;
    int whole;
    char name[VS_NAME_SIZE];
  } value = {0};
  vs_field field = *axis->field;
  const vs_section section = {axis->section, &field, 1};
  field.offset = 0;
  if (field.kind == VS_PROFILE) field.kind = VS_REAL; /* a value of an axis is one number */
  vs_status status = vs_field_read(&section, &field, node, &value, err);
  if (status) return status;
  if (vs_field_is_real(&field) && isnan(value.real))
    return vs_fail_at(err, node->where, "%s: an axis has numbers; write one instead of '%s'",
                      axis->key, node->text);
  *number = axis->is_word            ? add_axis_word(axis, node)
            : field.kind == VS_COUNT ? value.whole
                                     : to_12_digits(value.real / vs_units_factor(axis->unit));
  return VS_OK;
}

static vs_status one_value(vs_axis *axis, const vs_node *node, vs_error *err) {
  double number = 0;
  vs_status status = vs_axis_number(axis, node, &number, err);
  if (status) return status;
  axis->value = vs_alloc_grow(axis->value, axis->n_values, sizeof *axis->value);
  axis->value[axis->n_values++] = number;
  return VS_OK;
}

static vs_status list_values(vs_axis *axis, const vs_node *list, vs_error *err) {
  if (!list->child) return vs_fail_at(err, list->where, "%s: the list is empty", axis->key);
  vs_status status = VS_OK;
  for (const vs_node *item = list->child; item && !status; item = item->next)
    status = vs_error_keep(err, one_value(axis, item, err));
  return status;
}

/* Reads both ends of the range, in the order given. */
static vs_status read_ends(vs_axis *axis, const vs_node *from, const vs_node *to, vs_error *err) {
  vs_status status = vs_axis_number(axis, from, &axis->from, err);
  if (!status) status = vs_axis_number(axis, to, &axis->to, err);
  if (!status && axis->from == axis->to)
    status = vs_fail_at(err, to->where, "%s: the range ends where it begins", axis->key);
  axis->ranged = !status;
  return status;
}

double vs_axis_between(const vs_axis *axis, double u) {
  if (u <= 0) return axis->from; /* exact at both ends */
  if (u >= 1) return axis->to;
  return axis->log ? axis->from * pow(axis->to / axis->from, u)
                   : axis->from + u * (axis->to - axis->from);
}

static void cut_axis(vs_axis *axis, size_t count, double step) {
  axis->n_values = count;
  axis->value = vs_alloc(count, sizeof *axis->value);
  for (size_t k = 0; k < count; k++)
    axis->value[k] = to_12_digits(vs_axis_between(axis, (double)k * step));
}

static vs_status whole_values(const vs_axis *axis, const vs_node *node, vs_error *err) {
  for (size_t k = 0; k < axis->n_values && axis->field->kind == VS_COUNT; k++)
    if (axis->value[k] != floor(axis->value[k]))
      return vs_fail_at(err, node->where, "%s: %g among its values is not a whole number",
                        axis->key, axis->value[k]);
  return VS_OK;
}

static const vs_field VALUE = {.kind = VS_VALUE};
static const vs_inside TWO = {.rows = &VALUE, .count = 2};
static const vs_inside
    LIN = {.rows = VS_ROWS({"lin", VS_NEEDED | VS_LIST, .inside = &TWO}, {"n", .kind = VS_COUNT})},
    LOG = {.rows = VS_ROWS({"log", VS_NEEDED | VS_LIST, .inside = &TWO}, {"n", .kind = VS_COUNT}),
           .instead = &(const vs_field){.kind = VS_MAP, .inside = &LIN}},
    STEP = {.rows = VS_ROWS({"from", .kind = VS_NEEDED | VS_VALUE},
                            {"to", .kind = VS_NEEDED | VS_VALUE}, {"step", .kind = VS_VALUE}),
            .instead = &(const vs_field){.kind = VS_MAP, .inside = &LOG}},
    LIST = {.rows = &VALUE, .instead = &(const vs_field){.kind = VS_MAP, .inside = &STEP}};
const vs_field vs_axis_many = {.kind = VS_LIST, .inside = &LIST};

/* Cuts a range of whole numbers into all of them. */
static vs_status cut_whole(vs_axis *axis, const vs_node *node, vs_error *err) {
  const double n = fabs(axis->to - axis->from);
  if (n >= MOST_VALUES)
    return vs_fail_at(err, node->where, "%s: more than %d values", axis->key, MOST_VALUES);
  cut_axis(axis, (size_t)n + 1, 1 / n);
  return VS_OK;
}

/* Reads {from: A, to: B, step: C}, which is A, A + C, ... up to B; B itself need not be met.
 * Without a step a range is a continuum; one of whole numbers is all of them. */
static vs_status stepped(vs_axis *axis, const vs_node *map, vs_error *err) {
  const vs_node *from = vs_tree_child(map, "from"), *to = vs_tree_child(map, "to"),
                *step = vs_tree_child(map, "step");
  char why[256];
  double si;
  if (!from || !to)
    return vs_fail_at(err, map->where, "%s: both ends are wanted: {from: A, to: B, step: C}",
                      axis->key);
  vs_status status = read_ends(axis, from, to, err);
  if (!status && !step && axis->field->kind == VS_COUNT) return cut_whole(axis, map, err);
  if (status || !step) return status;
  if (step->kind != VS_NODE_TEXT || !vs_units_read(step->text, axis->unit, &si, why, sizeof why))
    return vs_fail_at(err, step->where, "%s: step: %s", axis->key,
                      step->kind == VS_NODE_TEXT ? why : "one value is wanted");
  double steps = (axis->to - axis->from) / to_12_digits(si / vs_units_factor(axis->unit));
  if (!(steps > 0) || steps > MOST_VALUES)
    return vs_fail_at(err, step->where, "%s: steps of %s lead from %s to %s %s", axis->key,
                      step->text, from->text, to->text, steps > 0 ? "in too many" : "never");
  cut_axis(axis, (size_t)floor(steps * (1 + 1e-9)) + 1, 1 / steps);
  return whole_values(axis, map, err);
}

/* Reads {log: [A, B], n: N} or {lin: [A, B], n: N}. */
static vs_status spaced(vs_axis *axis, const vs_node *map, const vs_node *ends, vs_error *err) {
  uint64_t n = 0;
  const vs_node *a = ends->kind == VS_NODE_LIST ? ends->child : NULL;
  if (!a || !a->next || a->next->next)
    return vs_fail_at(err, ends->where, "%s: %s: two ends are wanted: [A, B]", axis->key,
                      ends->key);
  axis->log = !strcmp(ends->key, "log");
  vs_status status = read_ends(axis, a, a->next, err);
  if (status) return status;
  if (axis->log && !(axis->from * axis->to > 0)) /* 0 and signs have no logarithm */
    return vs_fail_at(err, ends->where, "%s: log: both ends must be of one sign, and not 0",
                      axis->key);
  status = vs_axis_whole(map, "n", 2, MOST_VALUES, &n, err);
  if (status || !n) return status;
  cut_axis(axis, (size_t)n, 1 / (double)(n - 1));
  axis->value[n - 1] = axis->to;
  return whole_values(axis, map, err);
}

static const char DOTS[] = " .. ";

/* Reads 'A .. B', which is {from: A, to: B}. */
static vs_status dotted(vs_axis *axis, const vs_node *node, const char *dots, vs_error *err) {
  char *from = vs_alloc_part(node->text, (size_t)(dots - node->text));
  const vs_node a = vs_tree_word(NULL, from, node->where),
                b = vs_tree_word(NULL, dots + strlen(DOTS), node->where);
  vs_status status = read_ends(axis, &a, &b, err);
  free(from);
  return status || axis->field->kind != VS_COUNT ? status : cut_whole(axis, node, err);
}

vs_status vs_axis_values(vs_axis *axis, const vs_node *node, vs_error *err) {
  const char *dots = node->kind == VS_NODE_TEXT && !axis->is_word ? strstr(node->text, DOTS) : NULL;
  if (dots) return dotted(axis, node, dots, err);
  if (node->kind == VS_NODE_TEXT) return one_value(axis, node, err);
  if (node->kind == VS_NODE_LIST) return list_values(axis, node, err);
  if (axis->is_word)
    return vs_fail_at(err, node->where, "%s has words for values: a list of them is wanted",
                      axis->key);
  const vs_node *log = vs_tree_child(node, "log"), *lin = vs_tree_child(node, "lin");
  size_t found = vs_error_count(err);
  vs_status status = vs_field_map_keys(node, axis->key, log ? &LOG : lin ? &LIN : &STEP, err);
  if (status || vs_error_count(err) > found) return status;
  return log || lin ? spaced(axis, node, log ? log : lin, err) : stepped(axis, node, err);
}

vs_status vs_axis_whole(const vs_node *map, const char *key, uint64_t least, uint64_t most,
                        uint64_t *value, vs_error *err) {
  const vs_node *node = vs_tree_child(map, key);
  char *end = NULL;
  if (!node) return VS_OK;
  double number = node->kind == VS_NODE_TEXT ? vs_text_to_number(node->text, &end) : NAN;
  if (!end || end == node->text || *end || number != floor(number) || number < (double)least ||
      number > (double)most)
    return vs_fail_at(err, node->where, "%s: a whole number from %llu to %llu is wanted", key,
                      (unsigned long long)least, (unsigned long long)most);
  *value = (uint64_t)number;
  return VS_OK;
}

vs_status vs_axis_word(const vs_node *map, const char *name, const char *words, int *which,
                       vs_error *err) {
  char section_name[VS_KEY_SIZE];
  const char *key = strrchr(name, '.') + 1;
  const vs_node *node = vs_tree_child(map, key);
  vs_field field = {
      .key = key, .kind = VS_CHOICE, .choices = words, .unit = "", .default_text = ""};
  const vs_section section = {section_name, &field, 1};
  snprintf(section_name, sizeof section_name, "%.*s", (int)(key - name) - 1, name);
  return node ? vs_field_read(&section, &field, node, which, err) : VS_OK;
}

/* ---- print-out ---- */

/* Returns the word that the number stands for: an axis of words has one for each, a count may have
 * one for 0 ("once"). NULL: it is a number. */
static const char *word_of_axis(const vs_axis *axis, double number) {
  if (axis->is_word) return axis->word[(size_t)number];
  return axis->field->kind == VS_COUNT && axis->field->choices && number == 0 ? axis->field->choices
                                                                              : NULL;
}

bool vs_axis_print(const vs_axis *axis, double number, char *text, size_t size) {
  *text = '\0';
  if (isnan(number)) return false;
  const char *word = word_of_axis(axis, number);
  char digits[VS_NUMBER_SIZE];
  if (!word) vs_text_number(digits, number, 12);
  snprintf(text, size, "%s", word ? word : digits);
  return !word;
}

void vs_axis_put(const vs_axis *axis, double number, int digits, vs_tree *tree) {
  char value[VS_NUMBER_SIZE], text[VS_NAME_SIZE];
  const char *word = word_of_axis(axis, number);
  vs_text_number(value, number, digits);
  snprintf(text, sizeof text, "%s%s%s", value, *axis->unit ? " " : "", axis->unit);
  vs_tree_put(tree, axis->key, word ? word : text,
              axis->is_word ? axis->word_where[(size_t)number] : axis->where);
}
