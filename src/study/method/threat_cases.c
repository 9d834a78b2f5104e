/* SPDX-License-Identifier: GPL-3.0-or-later
 * What stands under threats (study/threats.h) as cases of a study: one threat after the other, the
 * scene itself last. Each has all combinations of its lists where these are all it has; else as
 * many cases as its key n says, at least one of each combination, in which each continuous range is
 * cut into equal pieces.
 *
 * A study-level `spread`, what is not known exactly (study/method/span.h), goes along: each case
 * has its own numbers of it, and each threat as many cases as n says.
 *
 * The columns of study.csv: `threat`, its name; threat.KEY, the union of the threats' ranges;
 * with.KEY, those of the threat that comes along. The cell of a range that the case's threat has
 * not is empty. */
#include "study/methods.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/units.h"
#include "measure/expect.h"
#include "method/span.h"
#include "threats.h"

static const vs_inside TEXTS = {.rows = VS_ROWS({.kind = VS_TEXT}), .count = -1},
                       VALUES = {.rows = VS_ROWS({.kind = VS_TEXT | VS_LIST, .inside = &TEXTS}),
                                 .count = -1},
                       KEYS = {.rows = VS_ROWS(
                                   {.kind = VS_TEXT | VS_LIST | VS_MAP, .inside = &VALUES})},
                       NAMES = {.rows = VS_ROWS({.kind = VS_MAP | VS_COUNT, .inside = &KEYS})};
static const vs_field THREATS = {"threats", VS_TEXT | VS_MAP, .inside = &NAMES};

/* What the axis `threat` is, in lists. */
static const vs_field THREAT = {.key = "threat",
                                .kind = VS_NAME,
                                .unit = "",
                                .text = "what is laid over the scene; none: nothing"};

enum { WORD = 0, RANGES = 1, SPREAD_SIGMAS = 3 }; /* axes of the stage; of the spread, see span.h */

typedef struct cases {
  vs_threats threats;
  size_t axis[VS_THREATS_MOST][VS_THREAT_NUMBERS]; /* of a threat's number: which of the stage's */
  size_t spread; /* the first axis of a spread; n: there is none */
  size_t n;      /* of axes */
} cases;

static void free_cases(void *state) {
  cases *c = state;
  if (c) vs_threats_free(&c->threats);
  free(c);
}

/* ---- axes ---- */

/* Adds an axis to the plan and returns it. NULL is an error: there are too many. */
static vs_axis *add_axis(vs_plan *plan, vs_where where, vs_error *err) {
  if (plan->n_axes >= VS_PLAN_AXES) {
    vs_fail_at(err, where, "threats: more than %d axes; fewer different ranges are wanted",
               VS_PLAN_AXES);
    return NULL;
  }
  vs_axis *axis = &plan->axes[plan->n_axes++];
  *axis = (vs_axis){.by = THREATS.key, .where = where, .nominal = NAN, .unit = ""};
  return axis;
}

static void add_word(vs_axis *axis, const char *word, vs_where where) {
  const size_t n = axis->n_words++;
  axis->word = vs_alloc_grow(axis->word, n, sizeof *axis->word);
  axis->word_where = vs_alloc_grow(axis->word_where, n, sizeof *axis->word_where);
  axis->word[n] = vs_copy(word);
  axis->word_where[n] = where;
  axis->value = vs_alloc_grow(axis->value, axis->n_values, sizeof *axis->value);
  axis->value[axis->n_values++] = (double)n;
}

static size_t word_number(const vs_axis *axis, const char *word) {
  size_t k = 0;
  while (k < axis->n_words && strcmp(axis->word[k], word) != 0) k++;
  return k;
}

static vs_status add_threat_axis(vs_plan *plan, const vs_threats *threats, vs_where where,
                                 vs_error *err) {
  vs_axis *axis = add_axis(plan, where, err);
  if (!axis) return VS_INPUT;
  snprintf(axis->key, sizeof axis->key, "%s", THREAT.key);
  snprintf(axis->column, sizeof axis->column, "%s", THREAT.key);
  snprintf(axis->section, sizeof axis->section, "events.");
  axis->field = &THREAT;
  axis->is_word = true;
  for (size_t k = 0; k < threats->count; k++)
    add_word(axis, threats->item[k].name, threats->item[k].where);
  return VS_OK;
}

/* Finds or adds the axis that a threat's range shares with those of the same key and unit. */
static vs_status share_axis(vs_plan *plan, size_t first, const vs_axis *range, const char *head,
                            size_t *at, vs_error *err) {
  char column[VS_KEY_SIZE], suffix[64];
  vs_axis *axis;
  vs_units_suffix(range->unit, suffix, sizeof suffix);
  snprintf(column, sizeof column, "%s.%.100s%s%.20s", head, range->field->key, *suffix ? "_" : "",
           suffix);
  for (*at = RANGES; first + *at < plan->n_axes; ++*at)
    if (!strcmp(plan->axes[first + *at].column, column)) break;
  axis = &plan->axes[first + *at];
  if (first + *at == plan->n_axes) {
    axis = add_axis(plan, range->where, err);
    if (!axis) return VS_INPUT;
    snprintf(axis->column, sizeof axis->column, "%s", column);
    snprintf(axis->key, sizeof axis->key, "%s.%.100s", head, range->field->key);
    for (size_t k = first; k + 1 < plan->n_axes; k++) /* as that of another unit */
      if (!strcmp(plan->axes[k].key, axis->key))
        snprintf(axis->key, sizeof axis->key, "%s", column);
    snprintf(axis->section, sizeof axis->section, "events.");
    axis->field = range->field;
    axis->unit = range->unit;
    axis->is_word = range->is_word;
  }
  for (size_t w = 0; w < range->n_words; w++)
    if (word_number(axis, range->word[w]) == axis->n_words)
      add_word(axis, range->word[w], range->word_where[w]);
  return VS_OK;
}

static vs_status add_ranges(vs_plan *plan, size_t first, cases *c, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t t = 0; t < c->threats.count; t++) {
    const vs_threat *threat = &c->threats.item[t];
    for (size_t k = 0; k < vs_threat_numbers(threat) && !status; k++)
      status = share_axis(plan, first, vs_threat_range(threat, k),
                          k < threat->n_ranges ? "threat" : "with", &c->axis[t][k], err);
  }
  return status;
}

static vs_status add_spread(vs_plan *plan, const vs_node *map, vs_error *err) {
  if (!map) return VS_OK;
  if (map->kind != VS_NODE_MAP || !map->child)
    return vs_fail_at(err, map->where,
                      "spread: a map is wanted: {KEY: 5 %% normal, KEY: 2 ohm uniform}");
  return vs_span_read_map(plan, map, "spread", SPREAD_SIGMAS, err);
}

/* A search would need one set of ranges for all cases. */
static vs_status refuse_search(const vs_plan *plan, const vs_node *section, vs_error *err) {
  for (const vs_method *const *m = plan->methods; *m; m++)
    if ((*m)->next && !(*m)->takes_cases && vs_tree_child(plan->tree.root, (*m)->key))
      return vs_fail_at(err, section->key_where,
                        "threats: %s chooses the cases itself, from what stands under vary; one of "
                        "the two is wanted",
                        (*m)->key);
  return VS_OK;
}

static vs_status read_cases(vs_plan *plan, const vs_node *section, void **state, vs_error *err) {
  const size_t first = plan->n_axes, found = vs_error_count(err);
  cases *c = *state = vs_alloc(1, sizeof *c);
  vs_status status = refuse_search(plan, section, err);
  if (!status) status = vs_threats_read(section, plan->base, &c->threats, err);
  if (status || vs_error_count(err) > found) return status;
  status = add_threat_axis(plan, &c->threats, section->key_where, err);
  if (!status) status = add_ranges(plan, first, c, err);
  c->spread = plan->n_axes - first;
  if (!status) status = add_spread(plan, vs_tree_child(plan->tree.root, "spread"), err);
  c->n = plan->n_axes - first;
  return status || !*c->threats.path ? status : vs_plan_input(plan, c->threats.path, err);
}

/* Error: no line of any verdict could break, so that all cases would count as held. */
static vs_status find_lines(const vs_plan *plan, const vs_plan_stage *stage, vs_error *err) {
  for (size_t k = 0; k < plan->n_columns; k++)
    if (plan->columns[k].line) return VS_OK;
  return vs_fail_at(err, plan->axes[stage->axis].where,
                    "threats: no part of the deck states a limit, so that nothing could break; "
                    "parts of a maker are wanted, as circuit.deck: halfwave_paper has, or ratings");
}

/* ---- points ---- */

static uint64_t cases_of(const cases *c, const vs_threat *t) {
  const uint64_t listed = vs_threat_combinations(t);
  if (vs_threat_is_closed(t) && c->spread == c->n) return listed;
  return listed > t->n ? listed : t->n;
}

static uint64_t count_cases(const vs_plan *plan, const vs_plan_stage *stage) {
  const cases *c = stage->state;
  uint64_t count = 0;
  (void)plan;
  for (size_t t = 0; t < c->threats.count && count <= VS_PLAN_CASES; t++)
    count += cases_of(c, &c->threats.item[t]);
  return count;
}

/* Gives the axes of the stage a case's numbers. */
static void take_numbers(const cases *c, const vs_axis *axes, const vs_threat *threat,
                         const double *number, double *value) {
  const size_t t = (size_t)(threat - c->threats.item);
  for (size_t k = 0; k < c->spread; k++) value[k] = NAN;
  value[WORD] = (double)t;
  for (size_t k = 0; k < vs_threat_numbers(threat); k++) {
    const vs_axis *range = vs_threat_range(threat, k), *axis = &axes[c->axis[t][k]];
    value[c->axis[t][k]] =
        axis->is_word ? (double)word_number(axis, range->word[(size_t)number[k]]) : number[k];
  }
}

static void case_point(const vs_plan *plan, const vs_plan_stage *stage, uint64_t index,
                       double *value) {
  const cases *c = stage->state;
  const vs_axis *axes = &plan->axes[stage->axis];
  const vs_threat *threat = c->threats.item;
  double number[VS_THREAT_NUMBERS];
  for (uint64_t n; index >= (n = cases_of(c, threat)); threat++) index -= n;
  const uint64_t count = cases_of(c, threat), seed = c->threats.seed;
  if (vs_threat_is_closed(threat))
    vs_threat_listed(threat, index, number);
  else
    vs_threat_stratum(threat, seed, index, count, number);
  take_numbers(c, axes, threat, number, value);
  for (size_t k = c->spread; k < c->n; k++)
    value[k] = vs_span_at(
        &axes[k], vs_random_latin(seed, index, count, vs_threat_key(threat->name, axes[k].key)));
}

/* One threat is as likely as another; `none` comes where the spread alone may differ. */
static bool case_draw(const vs_plan *plan, const vs_plan_stage *stage, uint64_t index,
                      double *value) {
  const cases *c = stage->state;
  const vs_axis *axes = &plan->axes[stage->axis];
  const bool spread = c->spread < c->n;
  const uint64_t seed = c->threats.seed, count = c->threats.count - !spread;
  double number[VS_THREAT_NUMBERS];
  bool any = spread;
  for (size_t t = 0; t < c->threats.count; t++)
    any = any || vs_threat_combinations(&c->threats.item[t]) > 1 ||
          !vs_threat_is_closed(&c->threats.item[t]);
  if (!any) return false;
  const vs_threat *threat =
      &c->threats.item[vs_random_bits(seed, index, vs_threat_key("draw", THREAT.key)) % count];
  vs_threat_draw(threat, seed, index, number);
  take_numbers(c, axes, threat, number, value);
  for (size_t k = c->spread; k < c->n; k++)
    value[k] =
        vs_span_at(&axes[k], vs_random_uniform(seed, index, vs_threat_key("draw", axes[k].key)));
  return true;
}

static size_t threat_ranges(const vs_plan *plan, const vs_plan_stage *stage, size_t which,
                            const vs_axis **axis) {
  const cases *c = stage->state;
  if (which >= c->threats.count) return SIZE_MAX;
  const vs_threat *threat = &c->threats.item[which];
  size_t n = 0;
  if (vs_threat_is_closed(threat) && c->spread == c->n) return 0;
  for (size_t k = 0; k < vs_threat_numbers(threat); k++) axis[n++] = vs_threat_range(threat, k);
  for (size_t k = c->spread; k < c->n; k++) axis[n++] = &plan->axes[stage->axis + k];
  return n;
}

static void place_threat(const vs_plan *plan, const vs_plan_stage *stage, size_t which,
                         const double *share, double *value) {
  const cases *c = stage->state;
  const vs_axis *axes = &plan->axes[stage->axis];
  const vs_threat *threat = &c->threats.item[which];
  double number[VS_THREAT_NUMBERS];
  for (size_t k = 0; k < vs_threat_numbers(threat); k++)
    number[k] = vs_threat_value(vs_threat_range(threat, k), *share++);
  take_numbers(c, axes, threat, number, value);
  for (size_t k = c->spread; k < c->n; k++) value[k] = vs_span_between(&axes[k], *share++);
}

/* The numbers of a point as the threat's own. Where a point is made up, for a trial, a number may
 * be another threat's or none: the first of the range stands for that. */
static void numbers_of(const cases *c, const vs_axis *axes, const double *value,
                       const vs_threat *threat, double *number) {
  const size_t t = (size_t)(threat - c->threats.item);
  vs_threat_listed(threat, 0, number);
  for (size_t k = 0; k < vs_threat_numbers(threat); k++) {
    const vs_axis *range = vs_threat_range(threat, k), *axis = &axes[c->axis[t][k]];
    const double x = value[c->axis[t][k]];
    if (isnan(x)) continue;
    if (!axis->is_word) number[k] = x;
    for (size_t w = 0; axis->is_word && w < range->n_words; w++)
      if (!strcmp(range->word[w], axis->word[(size_t)x])) number[k] = (double)w;
  }
}

static const vs_threat *threat_of(const cases *c, const double *value) {
  return &c->threats.item[(size_t)value[WORD]];
}

static void put_case(const vs_plan *plan, const vs_plan_stage *stage, const double *value,
                     vs_tree *tree) {
  const cases *c = stage->state;
  const vs_axis *axes = &plan->axes[stage->axis];
  double number[VS_THREAT_NUMBERS];
  const vs_threat *threat = threat_of(c, value);
  numbers_of(c, axes, value, threat, number);
  vs_threats_put(&c->threats, threat, number, tree);
  for (size_t k = c->spread; k < c->n; k++) vs_axis_put(&axes[k], value[k], 12, tree);
}

static vs_status check_case(const vs_plan_stage *stage, const double *value, const vs_scene *scene,
                            vs_error *err) {
  return vs_threats_check(threat_of(stage->state, value), scene, err);
}

/* ---- manifest ---- */

/* The threats with their keys: `set` is what all cases of one have, `columns` says which key each
 * column is. So a row tells how `run` makes it again. */
static void cases_json(const vs_plan *plan, const vs_plan_stage *stage, const vs_results *results,
                       vs_json *json) {
  const cases *c = stage->state;
  (void)results;
  vs_json_array(json, THREATS.key, VS_JSON_LINES);
  for (size_t t = 0; t < c->threats.count; t++) {
    const vs_threat *threat = &c->threats.item[t];
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_text(json, "name", threat->name);
    vs_json_text(json, "text", threat->text);
    vs_json_text(json, "criterion", vs_expect_criteria[threat->criterion].name);
    vs_json_text(json, "with", threat->with ? threat->with->name : NULL);
    vs_json_whole(json, "cases", (int64_t)cases_of(c, threat));
    vs_json_array(json, "set", VS_JSON_ROW);
    vs_text set = {0};
    for (size_t k = 0; set.length = 0, vs_threats_setting(&c->threats, threat, k, &set); k++)
      vs_json_text(json, NULL, set.text);
    vs_text_free(&set);
    vs_json_end(json);
    vs_json_object(json, "columns", VS_JSON_ROW);
    for (size_t k = 0; k < vs_threat_numbers(threat); k++)
      vs_json_text(json, plan->axes[stage->axis + c->axis[t][k]].column,
                   vs_threat_range(threat, k)->key);
    vs_json_end(json);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static const char *const EACH[] = {"cases", NULL};

const vs_method vs_threat_cases_method = {.name = "threats",
                                          .key = "threats",
                                          .keys = &THREATS,
                                          .text = "what the scene has to withstand, one at a time",
                                          .read = read_cases,
                                          .ready = find_lines,
                                          .free = free_cases,
                                          .count = count_cases,
                                          .point = case_point,
                                          .draw = case_draw,
                                          .ranges = threat_ranges,
                                          .place = place_threat,
                                          .put = put_case,
                                          .check = check_case,
                                          .json = cases_json,
                                          .report = {.each = EACH}};
