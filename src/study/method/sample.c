/* SPDX-License-Identifier: GPL-3.0-or-later
 * Samples: `spread` says what of the scene is not known exactly (study/method/span.h), and the
 * methods choose points of it.
 *
 *   sample:
 *     method: sobol          or latin_hypercube (lhs), monte_carlo, corners
 *     n: 4096                points; of the corners there are as many as there are
 *     seed: 7
 *     spread: {actuator.inductance: 5 % normal, circuit.c1: 10 % uniform}
 *     correlation: [[circuit.r1, circuit.c1, 0.8], ...]    of the normal scores (study/random.h)
 *     sigmas: 3              how far corners and searches go where normal spreads have no end
 *
 * Corners: first the scene as it is, then all ends of all spreads (of a list: all it has), the
 * first axis running fastest. */
#include "study/methods.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/json.h"
#include "base/text.h"
#include "base/units.h"
#include "method/span.h"
#include "study/plan.h"

static const vs_inside MANY = {.instead = &vs_axis_many},
                       SPREAD = {.rows = VS_ROWS({.kind = VS_SPREAD, .inside = &MANY})},
                       ITEMS = {.rows = VS_ROWS({.kind = VS_TEXT}), .count = 3},
                       TRIPLES = {.rows = VS_ROWS({.kind = VS_LIST, .inside = &ITEMS}),
                                  .count = -1},
                       KEYS = {.rows = VS_ROWS(
                                   {"method", VS_NOTHING | VS_CHOICE,
                                    .choices = "sobol|latin_hypercube|lhs|monte_carlo|corners"},
                                   {"n", .kind = VS_COUNT}, {"seed", .kind = VS_COUNT},
                                   {"spread", VS_NEEDED | VS_MAP, .inside = &SPREAD},
                                   {"correlation", VS_NOTHING | VS_LIST, .inside = &TRIPLES},
                                   {"sigmas", .kind = VS_PART})};
static const vs_field SAMPLE = {"sample", VS_MAP, .inside = &KEYS};

typedef struct sample {
  uint64_t n;
  vs_correlation *correlation; /* NULL: no axes are correlated */
  vs_sobol *sobol;             /* NULL: the method is another */
} sample;

static void sample_free(void *state) {
  sample *s = state;
  if (!s) return;
  free(s->correlation);
  free(s->sobol);
  free(s);
}

static const char *method_of(const vs_node *section) {
  const vs_node *node = vs_tree_child(section, "method");
  return node && node->kind == VS_NODE_TEXT && *node->text ? node->text : "sobol";
}

static vs_status read_spread(vs_plan *plan, const vs_node *section, double sigmas, vs_error *err) {
  const vs_node *map = vs_tree_child(section, "spread");
  if (!map || map->kind != VS_NODE_MAP || !map->child)
    return vs_fail_at(err, map ? map->where : section->where,
                      "sample.spread: a map is wanted: {KEY: 5 %% normal, KEY: 2 ohm uniform}");
  return vs_span_read_map(plan, map, "sample", sigmas, err);
}

/* ---- correlation ---- */

/* Finds the axis of the sample that the node names. */
static vs_status find_axis(vs_plan *plan, size_t first, const vs_node *node, size_t *at,
                           vs_error *err) {
  const char *names[VS_PLAN_AXES];
  size_t n = plan->n_axes - first;
  for (*at = 0; *at < n; ++*at) {
    names[*at] = plan->axes[first + *at].key;
    if (node->kind == VS_NODE_TEXT && !strcmp(names[*at], node->text)) return VS_OK;
  }
  const char *near = node->kind == VS_NODE_TEXT ? vs_text_nearest(node->text, names, n) : NULL;
  return vs_fail_at(err, node->where, "sample.correlation: '%s' is not under spread%s%s%s",
                    node->kind == VS_NODE_TEXT ? node->text : "a list or map", near ? "; is '" : "",
                    near ? near : "", near ? "' meant?" : "");
}

static vs_status read_pair(vs_plan *plan, size_t first, const vs_node *pair, double *matrix,
                           vs_error *err) {
  const size_t n = plan->n_axes - first;
  size_t a, b;
  double rho;
  char why[256];
  const vs_node *one = pair->kind == VS_NODE_LIST ? pair->child : NULL,
                *two = one ? one->next : NULL, *number = two ? two->next : NULL;
  if (!number || number->next || number->kind != VS_NODE_TEXT)
    return vs_fail_at(err, pair->where,
                      "sample.correlation: a list of [KEY, KEY, NUMBER] is wanted");
  vs_status status = find_axis(plan, first, one, &a, err);
  if (!status) status = find_axis(plan, first, two, &b, err);
  if (status) return status;
  if (!vs_units_read(number->text, "", &rho, why, sizeof why))
    return vs_fail_at(err, number->where, "sample.correlation: %s", why);
  if (a == b || !(fabs(rho) < 1))
    return vs_fail_at(err, a == b ? two->where : number->where,
                      "sample.correlation: of two different axes, and between -1 and 1");
  matrix[a * n + b] = matrix[b * n + a] = rho;
  return VS_OK;
}

static vs_status read_correlation(vs_plan *plan, const vs_node *section, size_t first, sample *s,
                                  vs_error *err) {
  const vs_node *list = vs_tree_child(section, "correlation");
  const size_t n = plan->n_axes - first;
  vs_status status = VS_OK;
  if (!list || (list->kind == VS_NODE_TEXT && !*list->text)) return VS_OK;
  if (list->kind != VS_NODE_LIST)
    return vs_fail_at(err, list->where,
                      "sample.correlation: a list is wanted: [[KEY, KEY, 0.8], ...]");
  if (!strcmp(method_of(section), "corners"))
    return vs_fail_at(err, list->where, "sample.correlation: corners have none");
  double *matrix = vs_alloc(n * n + 1, sizeof *matrix);
  for (size_t k = 0; k < n; k++) matrix[k * n + k] = 1;
  for (const vs_node *pair = list->child; pair && !status; pair = pair->next)
    status = vs_error_keep(err, read_pair(plan, first, pair, matrix, err));
  if (!status && n && !(s->correlation = vs_random_correlation(n, matrix)))
    status = vs_fail_at(err, list->where,
                        "sample.correlation: no numbers can be correlated like this (the matrix is "
                        "not positive definite)");
  free(matrix);
  return status;
}

/* ---- reading ---- */

static vs_status read_numbers(vs_plan *plan, const vs_node *section, sample *s, double *sigmas,
                              vs_error *err) {
  const vs_node *node = vs_tree_child(section, "sigmas");
  const bool corners = !strcmp(method_of(section), "corners");
  char why[256];
  s->n = 256;
  *sigmas = 3;
  vs_status status = vs_error_keep(err, vs_axis_whole(section, "n", 1, VS_PLAN_CASES, &s->n, err));
  if (!status)
    status =
        vs_error_keep(err, vs_axis_whole(section, "seed", 0, UINT64_MAX >> 12, &plan->seed, err));
  if (status) return status;
  if (corners && vs_tree_child(section, "n"))
    status = vs_error_keep(err, vs_fail_at(err, vs_tree_child(section, "n")->key_where,
                                           "sample.n: there are as many corners as there are"));
  if (!node || status) return status;
  if (node->kind != VS_NODE_TEXT || !vs_units_read(node->text, "", sigmas, why, sizeof why) ||
      !(*sigmas > 0 && *sigmas <= 10))
    return vs_fail_at(err, node->where, "sample.sigmas: a number above 0 and up to 10 is wanted");
  return VS_OK;
}

static vs_status sample_read(vs_plan *plan, const vs_node *section, void **state, vs_error *err) {
  const size_t first = plan->n_axes;
  double sigmas;
  sample *s = *state = vs_alloc(1, sizeof *s);
  vs_status status = vs_field_map_keys(section, "sample", &KEYS, err);
  if (!status) status = read_numbers(plan, section, s, &sigmas, err);
  if (!status) status = read_spread(plan, section, sigmas, err);
  if (!status) status = read_correlation(plan, section, first, s, err);
  return status;
}

static bool claims_method(const vs_node *section, const char *method) {
  return !strcmp(method_of(section), method);
}

/* ---- manifest ---- */

static void spread_json(const vs_axis *axis, vs_json *json) {
  const vs_span *span = axis->own;
  if (!span) return;
  const bool normal = span->spread.shape == VS_SHAPE_NORMAL;
  vs_json_object(json, "spread", VS_JSON_ROW);
  vs_json_text(json, "shape", normal ? "normal" : "uniform");
  vs_json_number(json, normal ? "sigma" : "half_width", span->spread.width, 12);
  if (span->spread.truncate != 0) vs_json_number(json, "within_sigmas", span->spread.truncate, 12);
  vs_json_end(json);
}

/* ---- points ---- */

static uint64_t sample_count(const vs_plan *plan, const vs_plan_stage *stage) {
  (void)plan;
  return ((const sample *)stage->state)->n;
}

/* Turns value[], a point of the unit cube, into one of the axes. */
static void place_in_axes(const vs_plan *plan, const vs_plan_stage *stage, double *value) {
  const sample *s = stage->state;
  if (s->correlation) vs_random_correlate(s->correlation, value);
  for (size_t d = 0; d < stage->n; d++)
    value[d] = vs_span_at(&plan->axes[stage->axis + d], value[d]);
}

static bool is_latin(const vs_node *section) {
  return claims_method(section, "lhs") || claims_method(section, "latin_hypercube");
}

static void latin_point(const vs_plan *plan, const vs_plan_stage *stage, uint64_t index,
                        double *value) {
  const sample *s = stage->state;
  for (size_t d = 0; d < stage->n; d++) value[d] = vs_random_latin(plan->seed, index, s->n, d);
  place_in_axes(plan, stage, value);
}

static bool is_monte_carlo(const vs_node *section) {
  return claims_method(section, "monte_carlo");
}

static void monte_carlo_point(const vs_plan *plan, const vs_plan_stage *stage, uint64_t index,
                              double *value) {
  for (size_t d = 0; d < stage->n; d++) value[d] = vs_random_uniform(plan->seed, index, d);
  place_in_axes(plan, stage, value);
}

static bool is_sobol(const vs_node *section) {
  return claims_method(section, "sobol");
}

static vs_status sobol_read(vs_plan *plan, const vs_node *section, void **state, vs_error *err) {
  const size_t first = plan->n_axes;
  vs_status status = sample_read(plan, section, state, err);
  sample *s = *state;
  if (status) return status;
  s->sobol = vs_alloc(1, sizeof *s->sobol);
  _Static_assert((int)VS_PLAN_AXES <= (int)VS_SOBOL_AXES && VS_PLAN_CASES <= 1ull << VS_SOBOL_BITS,
                 "every study that can be asked for has a Sobol sequence");
  bool begun = vs_random_sobol_begin(s->sobol, plan->n_axes - first, s->n, plan->seed);
  assert(begun);
  (void)begun;
  return VS_OK;
}

static void sobol_point(const vs_plan *plan, const vs_plan_stage *stage, uint64_t index,
                        double *value) {
  const sample *s = stage->state;
  for (size_t d = 0; d < stage->n; d++) value[d] = vs_random_sobol_at(s->sobol, index, d);
  place_in_axes(plan, stage, value);
}

static bool is_corners(const vs_node *section) {
  return claims_method(section, "corners");
}

static uint64_t corners_count(const vs_plan *plan, const vs_plan_stage *stage) {
  uint64_t count = 1;
  for (size_t d = 0; d < stage->n && count <= VS_PLAN_CASES; d++) {
    size_t levels = vs_span_levels(&plan->axes[stage->axis + d]);
    count *= levels ? levels : 2;
  }
  return count + 1;
}

static void corners_point(const vs_plan *plan, const vs_plan_stage *stage, uint64_t index,
                          double *value) {
  uint64_t rest = index - 1;
  for (size_t d = 0; d < stage->n; d++) {
    const vs_axis *axis = &plan->axes[stage->axis + d];
    size_t levels = vs_span_levels(axis), n = levels ? levels : 2;
    if (!index)
      value[d] = vs_span_nominal(axis);
    else
      value[d] = levels ? axis->value[rest % n] : vs_span_between(axis, (double)(rest % n));
    rest /= n;
  }
}

static const char *const SPREAD_EACH[] = {"histogram", NULL},
                         *const SPREAD_LAST[] = {"influence", NULL},
                         *const CORNERS_EACH[] = {"bars", NULL};

#define SAMPLED                                                                                    \
  .key = "sample", .keys = &SAMPLE, .uncertain = true, .free = sample_free, .axis_json = spread_json
const vs_method vs_sample_latin = {
    SAMPLED,
    .name = "lhs",
    .text = "Latin hypercube: every n-th part of every axis once (without correlation)",
    .claims = is_latin,
    .read = sample_read,
    .count = sample_count,
    .point = latin_point,
    .report = {.each = SPREAD_EACH, .last = SPREAD_LAST, .sampled = true}};
const vs_method vs_sample_monte_carlo = {
    SAMPLED,
    .name = "monte_carlo",
    .text = "independent random points",
    .claims = is_monte_carlo,
    .read = sample_read,
    .count = sample_count,
    .point = monte_carlo_point,
    .report = {.each = SPREAD_EACH, .last = SPREAD_LAST, .sampled = true, .independent = true}};
const vs_method vs_sample_sobol = {
    SAMPLED,
    .name = "sobol",
    .text = "Sobol's sequence, shifted by the seed",
    .claims = is_sobol,
    .read = sobol_read,
    .count = sample_count,
    .point = sobol_point,
    .report = {.each = SPREAD_EACH, .last = SPREAD_LAST, .sampled = true}};
const vs_method vs_sample_corners = {SAMPLED,
                                     .name = "corners",
                                     .text = "the scene as it is, then all ends of all spreads",
                                     .claims = is_corners,
                                     .read = sample_read,
                                     .count = corners_count,
                                     .point = corners_point,
                                     .report = {.each = CORNERS_EACH}};
