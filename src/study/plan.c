/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/plan.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "netlist/catalogue.h"
#include "run/sections.h"

/* ---- keys ---- */

static const vs_inside NAMES = {.rows = VS_ROWS({.kind = VS_TEXT}), .count = -1},
                       SETTINGS = {.rows = VS_ROWS({.kind = VS_SETTING})},
                       MANY = {.instead = &vs_axis_many},
                       SPREADS = {.rows = VS_ROWS({.kind = VS_SPREAD, .inside = &MANY})};
const vs_field vs_plan_keys[] = {{"scene", .kind = VS_TEXT},
                                 {"set", VS_NOTHING | VS_MAP, .inside = &SETTINGS},
                                 {"most_cases", .kind = VS_COUNT},
                                 {"steady", VS_FLAG | VS_MAP, .inside = &vs_orbit_columns_keys},
                                 {"spread", VS_MAP, .inside = &SPREADS},
                                 {"report", VS_NOTHING | VS_TEXT | VS_LIST, .inside = &NAMES},
                                 {0}};

const char **vs_plan_known_keys(const vs_method *const *methods, size_t *count) {
  enum { N_OWN = sizeof vs_plan_keys / sizeof *vs_plan_keys - 1 };
  size_t besides = 0;
  for (const vs_method *const *m = methods; *m; m++)
    for (const vs_field *row = (*m)->besides; row && row->key; row++) besides++;
  const char **names = vs_alloc(N_OWN + vs_method_count(methods) + besides, sizeof *names);
  for (int k = 0; k < N_OWN; k++) names[k] = vs_plan_keys[k].key;
  *count = N_OWN + vs_method_keys(methods, names + N_OWN);
  for (const vs_method *const *m = methods; *m; m++)
    for (const vs_field *row = (*m)->besides; row && row->key; row++) names[(*count)++] = row->key;
  return names;
}

static bool is_of_scenes(const char *key) {
  for (size_t k = 0; k < VS_SECTION_KEYS; k++)
    if (!strcmp(vs_section_keys[k], key)) return true;
  return false;
}

bool vs_plan_has_keys(const vs_tree *file, const vs_method *const *methods) {
  size_t n;
  const char **keys = vs_plan_known_keys(methods, &n);
  bool has = false;
  for (size_t k = 0; k < n && !has; k++)
    has = !is_of_scenes(keys[k]) && vs_tree_child(file->root, keys[k]);
  free(keys);
  return has;
}

bool vs_plan_is_own(const vs_plan *plan, const char *set) {
  size_t n, length = strcspn(set, ".=");
  const char **keys = vs_plan_known_keys(plan->methods, &n);
  bool own = false;
  for (size_t k = 0; k < n && !own; k++)
    own = strlen(keys[k]) == length && !strncmp(keys[k], set, length);
  free(keys);
  return own;
}

/* ---- the scene ---- */

vs_status vs_plan_find(const vs_node *name, char path[VS_PATH_SIZE], vs_error *err) {
  static const vs_shelf FILES = {"file", "studies", ""};
  if (name->kind != VS_NODE_TEXT || !*name->text)
    return vs_fail_at(err, name->where, "a file's name is wanted");
  return vs_path_find(&FILES, name->text, name->where, path, err);
}

/* An entry of `set` that a later one, of the section that it is of, replaces; NULL: there is none.
 */
static const vs_node *replaced_by(const vs_node *set, const vs_node *later) {
  const size_t n = strlen(later->key);
  for (const vs_node *k = set->child; k != later; k = k->next)
    if (!strncmp(k->key, later->key, n) && k->key[n] == '.') return k;
  return NULL;
}

vs_status vs_plan_scene(const vs_plan *plan, vs_scene *scene, vs_error *err) {
  const vs_node *set = vs_tree_child(plan->tree.root, "set");
  vs_status status = vs_scene_open(plan->scene_name, plan->scene_where, scene, err);
  scene->allow_code = plan->allow_code;
  scene->of_period = plan->periods > 0;
  if (status) return status;
  if (set && (set->kind == VS_NODE_LIST || (set->kind == VS_NODE_TEXT && *set->text)))
    return vs_fail_at(err, set->where, "set: a map of keys is wanted: {run.until: 0.1 s, ...}");
  for (const vs_node *n = set ? set->child : NULL; n && !status; n = n->next) {
    const vs_node *gone = replaced_by(set, n);
    if (gone)
      return vs_fail_at(err, gone->key_where,
                        "set: '%s' replaces all of its section and with it %s; "
                        "write that below it, or behind it",
                        n->key, gone->key);
    status = vs_error_keep(err, vs_tree_graft(&scene->tree, n->key, n, err));
  }
  for (size_t k = 0; k < plan->n_sets && !status; k++)
    if (!vs_plan_is_own(plan, plan->sets[k]))
      status = vs_error_keep(err, vs_tree_set(&scene->tree, plan->sets[k], err));
  return status;
}

/* ---- axes ---- */

static vs_axis *find_axis(vs_plan *plan, const char *key) {
  for (size_t k = 0; k < plan->n_axes; k++)
    if (!strcmp(plan->axes[k].key, key)) return &plan->axes[k];
  return NULL;
}

/* Returns the --set of the same key, which would have no effect; NULL: there is none. */
static const char *set_of(const vs_plan *plan, const char *key) {
  size_t n = strlen(key);
  for (size_t k = 0; k < plan->n_sets; k++)
    if (!strncmp(plan->sets[k], key, n) && plan->sets[k][n] == '=') return plan->sets[k];
  return NULL;
}

/* True where one of the two axes of a key is what a search chooses, and the other a tolerance of
 * it: under vary and sample, or under catalogue, which comes behind spread. */
static bool takes_tolerance(const vs_plan *plan, const vs_axis *other, const char *by) {
  if (other->is_word) return false;
  if (!strcmp(by, "catalogue")) return !strcmp(other->by, "spread") && !other->about;
  if (strcmp(other->by, "vary") || strcmp(by, "sample")) return false;
  for (const vs_method *const *m = plan->methods; *m; m++)
    if ((*m)->tolerates && vs_tree_child(plan->tree.root, (*m)->key)) return true;
  return false;
}

/* The column of a tolerance: circuit.r1_spread_kohm beside circuit.r1_kohm. */
static void name_tolerance(vs_axis *axis) {
  char unit[VS_KEY_SIZE];
  snprintf(unit, sizeof unit, "%s", axis->column + strlen(axis->key));
  snprintf(axis->column, sizeof axis->column, "%.180s_spread%.24s", axis->key, unit);
}

vs_status vs_plan_axis(vs_plan *plan, const vs_node *node, const char *by, vs_axis **out,
                       vs_error *err) {
  vs_axis *other = find_axis(plan, node->key);
  const char *set = set_of(plan, node->key);
  vs_axis axis;
  const bool tolerance = other && takes_tolerance(plan, other, by);
  if (other && !tolerance)
    return vs_fail_at(err, node->key_where, "%s is an axis already, under %s", node->key,
                      other->by);
  if (set)
    return vs_fail_at(err, node->key_where, "%s is an axis, and --set %s sets it", node->key, set);
  if (plan->n_axes >= VS_PLAN_AXES)
    return vs_fail_at(err, node->key_where, "more than %d axes", VS_PLAN_AXES);
  vs_status status = vs_axis_init(&axis, plan->base, node, by, err);
  if (status) return status;
  *out = &plan->axes[plan->n_axes++];
  **out = axis;
  const bool behind = tolerance && !strcmp(by, "catalogue");
  vs_axis *first = behind ? *out : other, *second = behind ? other : *out;
  if (tolerance) second->about = (size_t)(first - plan->axes) + 1;
  if (tolerance) name_tolerance(second);
  return VS_OK;
}

/* ---- cases ---- */

void vs_plan_method(const vs_plan *plan, char *text, size_t size) {
  *text = '\0';
  for (size_t p = 0; p < plan->n_stages; p++) {
    size_t n = strlen(text);
    if (!plan->adaptive || plan->adaptive == &plan->stages[p])
      snprintf(text + n, size - n, "%s%s", n ? " x " : "", plan->stages[p].method->name);
  }
}

void vs_plan_point(const vs_plan *plan, uint64_t index, double *point) {
  for (size_t p = plan->n_stages; p-- > 0;) {
    const vs_plan_stage *stage = &plan->stages[p];
    stage->method->point(plan, stage, index % stage->count, point + stage->axis);
    index /= stage->count;
  }
}

void vs_plan_put(const vs_plan *plan, const double *point, vs_tree *tree) {
  for (size_t p = 0; p < plan->n_stages; p++) {
    const vs_plan_stage *stage = &plan->stages[p];
    if (stage->method->put) stage->method->put(plan, stage, point + stage->axis, tree);
    for (size_t k = stage->axis; k < stage->axis + stage->n && !stage->method->put; k++)
      vs_axis_put(&plan->axes[k], point[k], 12, tree);
  }
}

vs_status vs_plan_check_case(const vs_plan *plan, const double *point, const vs_scene *scene,
                             vs_error *err) {
  vs_status status = VS_OK;
  for (size_t p = 0; p < plan->n_stages && !status; p++) {
    const vs_plan_stage *stage = &plan->stages[p];
    if (stage->method->check) status = stage->method->check(stage, point + stage->axis, scene, err);
  }
  return status;
}

vs_status vs_plan_input(vs_plan *plan, const char *path, vs_error *err) {
  for (size_t k = 0; k < plan->n_inputs; k++)
    if (!strcmp(plan->inputs[k].path, path)) return VS_OK;
  plan->inputs = vs_alloc_grow(plan->inputs, plan->n_inputs, sizeof *plan->inputs);
  vs_input *input = &plan->inputs[plan->n_inputs];
  *input = (vs_input){0};
  snprintf(input->path, sizeof input->path, "%s", path);
  vs_status status = vs_catalogue_hash(path, input->sha256, err);
  if (!status) plan->n_inputs++;
  return status;
}

double vs_plan_results_value(const vs_results *r, uint64_t index, int column) {
  return r->values[index * (1 + r->plan->n_columns) + (size_t)(column + 1)];
}

void vs_plan_generation_add(vs_generation *g, const double *point) {
  if (g->count == g->capacity) {
    g->capacity = g->capacity ? 2 * g->capacity : 64;
    g->points = vs_resize(g->points, g->capacity * (g->n_axes ? g->n_axes : 1), sizeof *g->points);
  }
  memcpy(g->points + g->count++ * g->n_axes, point, g->n_axes * sizeof *point);
}

static void free_scene(vs_scene *scene) {
  if (scene) vs_scene_free(scene);
  free(scene);
}

void vs_plan_free(vs_plan *plan) {
  for (size_t p = 0; p < plan->n_stages; p++)
    if (plan->stages[p].method->free) plan->stages[p].method->free(plan->stages[p].state);
  for (size_t k = 0; k < plan->n_axes; k++) vs_axis_free(&plan->axes[k]);
  free_scene(plan->base);
  free_scene(plan->first);
  free(plan->stages);
  free(plan->inputs);
  vs_tree_free(&plan->tree);
  *plan = (vs_plan){0};
}
