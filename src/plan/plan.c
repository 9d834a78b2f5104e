/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plan/plan.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/jail.h"
#include "scene/shown.h"
#include "syntax/units.h"

static bool is_of_study(const vs_plan *plan, const char *set);

/* ---- the scene ---- */

vs_status vs_plan_find(const vs_plan *plan, const vs_node *name, char path[VS_PATH_SIZE],
                       vs_error *err) {
  static const vs_shelf FILES = {"file", "studies", ""};
  const char *slash = strrchr(plan->path, '/');
  if (name->kind != VS_NODE_TEXT || !*name->text)
    return vs_fail_at(err, name->where, "a file's name is wanted");
  int n = snprintf(path, VS_PATH_SIZE, "%.*s%s",
                   slash && *name->text != '/' ? (int)(slash - plan->path + 1) : 0, plan->path,
                   name->text);
  if (access(name->text, R_OK) && n < VS_PATH_SIZE && !access(path, R_OK))
    return vs_jail_check(path, name->where, err);
  return vs_path_find(&FILES, name->text, name->where, path, err);
}

/* Reads `scene`: a path, which may start from the study's folder, or the name of a scene that comes
 * with the program. */
static vs_status name_scene(vs_plan *plan, vs_error *err) {
  const vs_node *node = vs_tree_child(plan->tree.root, "scene");
  snprintf(plan->scene_name, sizeof plan->scene_name, "paper");
  if (!node) return VS_OK;
  char path[VS_PATH_SIZE];
  vs_error none = {0};
  plan->scene_where = node->where;
  if (node->kind != VS_NODE_TEXT || !*node->text)
    return vs_fail_at(err, node->where, "scene: a file, or the name of a scene, is wanted");
  bool found = strchr(node->text, '.') && !vs_plan_find(plan, node, path, &none);
  snprintf(plan->scene_name, sizeof plan->scene_name, "%s", found ? path : node->text);
  return VS_OK;
}

vs_status vs_plan_scene(const vs_plan *plan, vs_scene *scene, vs_error *err) {
  const vs_node *set = vs_tree_child(plan->tree.root, "set");
  vs_status status = vs_scene_open(plan->scene_name, plan->scene_where, scene, err);
  scene->allow_code = plan->allow_code;
  if (status) return status;
  if (set && (set->kind == VS_NODE_LIST || (set->kind == VS_NODE_TEXT && *set->text)))
    return vs_fail_at(err, set->where, "set: a map of keys is wanted: {run.until: 0.1 s, ...}");
  for (const vs_node *n = set ? set->child : NULL; n; n = n->next)
    vs_tree_graft(&scene->tree, n->key, n);
  for (size_t k = 0; k < plan->n_sets && !status; k++)
    if (!is_of_study(plan, plan->sets[k]))
      status = vs_error_carry_on(err, vs_tree_set(&scene->tree, plan->sets[k], err));
  return status;
}

/* ---- axes ---- */

static const vs_axis *find_axis(const vs_plan *plan, const char *key) {
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

vs_status vs_plan_axis(vs_plan *plan, const vs_node *node, const char *by, vs_axis **out,
                       vs_error *err) {
  const vs_axis *other = find_axis(plan, node->key);
  const char *set = set_of(plan, node->key);
  vs_axis axis;
  if (other)
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
  return VS_OK;
}

/* ---- columns ---- */

int vs_plan_column(vs_plan *plan, const char *measure, vs_where where) {
  if (!strcmp(measure, "margin_least")) return VS_COLUMN_MARGIN;
  for (size_t k = 0; k < plan->n_columns; k++)
    if (!strcmp(plan->columns[k].name, measure)) return (int)k;
  if (plan->n_columns >= VS_PLAN_COLUMNS)
    return VS_COLUMN_MARGIN; /* read_report refuses a study with so many */
  vs_report_column *column = &plan->columns[plan->n_columns];
  *column = (vs_report_column){.rating = NAN, .where = where};
  snprintf(column->name, sizeof column->name, "%s", measure);
  return (int)plan->n_columns++;
}

vs_status vs_plan_derive(vs_plan *plan, const vs_sensitivity_order *order, vs_where where,
                         vs_error *err) {
  size_t entries = order->n_of * order->n_to;
  if (2 * entries > VS_PLAN_COLUMNS - plan->n_columns)
    return vs_fail_at(err, where,
                      "sensitivity: %zu derivatives with their errors; there is room "
                      "for %zu",
                      entries, (VS_PLAN_COLUMNS - plan->n_columns) / 2);
  for (size_t k = 0; k < 2 * entries; k++) {
    vs_report_column *column = &plan->columns[plan->n_columns++];
    const char *of = order->of[k / 2 / order->n_to].name;
    const char *to = order->to[k / 2 % order->n_to].name;
    *column = (vs_report_column){.rating = NAN, .where = where};
    column->derivative = (k % 2 ? -1 : 1) * (int)(1 + k / 2);
    snprintf(column->name, sizeof column->name, "%s_to_%s%s", of, to, k % 2 ? "_error" : "");
    memcpy(column->column, column->name, sizeof column->name);
    snprintf(column->text, sizeof column->text, "%sd ln|%s| / d ln %s", k % 2 ? "error of " : "",
             of, to);
  }
  plan->derivatives = order;
  return VS_OK;
}

/* Adds the columns of an orbit that nobody has to ask for. */
static void add_usual(vs_plan *plan) {
  const vs_steady blank = {.model = &plan->base->setup.model};
  vs_shown m;
  for (int k = 0; vs_atwork_usual(&blank, k, &m); k++) vs_plan_column(plan, m.name, (vs_where){0});
}

static vs_status read_report(vs_plan *plan, vs_error *err) {
  const vs_node *list = vs_tree_child(plan->tree.root, "report");
  size_t room = VS_PLAN_COLUMNS - plan->n_columns, n = 0;
  vs_status status = VS_OK;
  if (!list || (list->kind == VS_NODE_TEXT && !*list->text)) {
    vs_measure m;
    for (int k = 0; vs_measure_at(&plan->base->setup.model, k, &m); k++)
      vs_plan_column(plan, m.name, (vs_where){0});
    if (plan->periods) add_usual(plan);
    return VS_OK;
  }
  for (const vs_node *item = list->kind == VS_NODE_LIST ? list->child : list; item && !status;
       item = list->kind == VS_NODE_LIST ? item->next : NULL) {
    if (item->kind != VS_NODE_TEXT || !*item->text || strlen(item->text) >= VS_JUDGED_NAME)
      status = vs_fail_at(err, item->where, "report: names of measures are wanted: [p_min, ...]");
    else if (++n > room)
      status = vs_fail_at(err, item->where, "report: more than %d columns", VS_PLAN_COLUMNS);
    else
      vs_plan_column(plan, item->text, item->where);
    status = vs_error_carry_on(err, status);
  }
  return status;
}

static vs_status unknown_measure(const vs_report_column *column, const vs_atwork *of,
                                 const vs_tier *tier, vs_error *err) {
  enum { MOST = 1024 };
  vs_shown *all = vs_alloc(MOST, sizeof *all);
  const char **names = vs_alloc(MOST, sizeof *names);
  size_t n = 0;
  while (n < MOST && vs_atwork_at(of, (int)n, &all[n])) {
    names[n] = all[n].name;
    n++;
  }
  const char *nearest = vs_text_nearest(column->name, names, n);
  vs_fail_at(err, column->where, "no measure '%s' on tier %s%s%s%s", column->name, tier->name,
             nearest ? "; did you mean '" : "", nearest ? nearest : "",
             nearest ? "'?" : "; see 'vibrospice list measures'");
  free(all);
  free(names);
  return VS_INPUT;
}

/* Gives the columns the units and ratings that the scene has on that tier. */
static vs_status resolve_columns(vs_plan *plan, const vs_scene *scene, const vs_tier *tier,
                                 vs_error *err) {
  const vs_frame frame = vs_sim_frame(tier, &scene->setup);
  vs_result result = {0};
  vs_watchers_begin(&result.watchers, &frame, NULL);
  vs_result_begin_quality(&result, scene);
  const vs_steady blank = {.model = &scene->setup.model, .devices = result.watchers.devices};
  const vs_atwork of = {&frame, &result, plan->periods ? &blank : NULL};
  vs_status status = VS_OK;
  for (size_t c = 0; c < plan->n_columns && !status; c++) {
    vs_report_column *column = &plan->columns[c];
    vs_shown m = {0};
    char suffix[64];
    int k = 0;
    if (column->derivative) continue;
    while (vs_atwork_at(&of, k, &m) && strcmp(m.name, column->name)) k++;
    if (strcmp(m.name, column->name)) {
      status = vs_error_carry_on(err, unknown_measure(column, &of, tier, err));
      continue;
    }
    snprintf(column->unit, sizeof column->unit, "%s", m.unit);
    snprintf(column->text, sizeof column->text, "%.*s", VS_DECK_TEXT - 1, m.text);
    column->rating = m.limit;
    column->at_least = m.at_least;
    vs_units_suffix(m.unit, suffix, sizeof suffix);
    snprintf(column->column, sizeof column->column, "%s%s%.20s", m.name, *suffix ? "_" : "",
             suffix);
  }
  vs_result_free(&result);
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

/* ---- methods ---- */

static const vs_outline NAME = {.takes = VS_OUTLINE_TEXT},
                        SETTINGS[] = {{.takes = VS_OUTLINE_SETTING}, {0}};
const vs_outline vs_plan_keys[] = {
    {"scene", .takes = VS_OUTLINE_TEXT},
    {"set", .takes = VS_OUTLINE_NOTHING | VS_OUTLINE_MAP, .of = SETTINGS},
    {"most_cases", .takes = VS_OUTLINE_WHOLE},
    {"steady", .takes = VS_OUTLINE_FLAG | VS_OUTLINE_MAP, .of = vs_atwork_keys},
    {"report", .takes = VS_OUTLINE_NOTHING | VS_OUTLINE_TEXT | VS_OUTLINE_LIST, .of = &NAME,
     .count = -1},
    {0}};

/* Returns the keys a study may have: its own, and those that methods stand under. The list is the
 * caller's to free(). */
static const char **study_keys(const vs_method *const *methods, size_t *count) {
  enum { N_OWN = sizeof vs_plan_keys / sizeof *vs_plan_keys - 1 };
  const char **names = vs_alloc(N_OWN + vs_method_count(methods), sizeof *names);
  for (int k = 0; k < N_OWN; k++) names[k] = vs_plan_keys[k].key;
  *count = N_OWN + vs_method_keys(methods, names + N_OWN);
  return names;
}

bool vs_plan_has_keys(const vs_tree *file, const vs_method *const *methods) {
  size_t n;
  const char **keys = study_keys(methods, &n);
  bool has = false;
  for (size_t k = 0; k < n && !has; k++) has = vs_tree_child(file->root, keys[k]) != NULL;
  free(keys);
  return has;
}

/* True if a --set is one of the study itself (sample.n=4096) and none of its scene. */
static bool is_of_study(const vs_plan *plan, const char *set) {
  size_t n, length = strcspn(set, ".=");
  const char **keys = study_keys(plan->methods, &n);
  bool own = false;
  for (size_t k = 0; k < n && !own; k++)
    own = strlen(keys[k]) == length && !strncmp(keys[k], set, length);
  free(keys);
  return own;
}

static vs_status read_stage(vs_plan *plan, const vs_node *section, vs_error *err) {
  const vs_method *method = vs_method_claiming(plan->methods, section, err);
  if (!method) return VS_INPUT;
  const bool searches = method->next != NULL;
  assert(searches != (method->point != NULL));
  assert(!searches || method->report.best); /* what a search finds must be announced */
  vs_plan_stage *stage = &plan->stages[plan->n_stages++];
  *stage = (vs_plan_stage){.method = method, .axis = plan->n_axes};
  vs_status status = method->read(plan, section, &stage->state, err);
  stage->n = plan->n_axes - stage->axis;
  if (status || !searches) return status;
  if (plan->adaptive)
    return vs_fail_at(err, section->key_where, "%s: %s chooses the cases already; one study, one",
                      section->key, plan->adaptive->method->key);
  plan->adaptive = stage;
  return VS_OK;
}

static vs_status nothing_varied(const vs_plan *plan, const char *const *keys, size_t n,
                                vs_error *err) {
  vs_text list = {0};
  for (size_t k = 0; k < n; k++) vs_text_add(&list, "%s%s", k ? ", " : "", keys[k]);
  vs_status status = vs_fail_at(err, (vs_where){.file = plan->tree.name},
                                "nothing is varied: one of %s is wanted", list.text);
  vs_text_free(&list);
  return status;
}

/* Reads the methods' sections in the order of the table, whatever the order of the file. Of two
 * methods the first one's index runs slower. */
static vs_status read_stages(vs_plan *plan, vs_error *err) {
  vs_status status = VS_OK;
  const char **keys = vs_alloc(vs_method_count(plan->methods), sizeof *keys);
  size_t n = vs_method_keys(plan->methods, keys);
  plan->stages = vs_alloc(n, sizeof *plan->stages);
  for (size_t k = 0; k < n && !status; k++) {
    const vs_node *section = vs_tree_child(plan->tree.root, keys[k]);
    if (section) status = vs_error_carry_on(err, read_stage(plan, section, err));
  }
  if (!status && !vs_error_count(err) && !plan->n_stages)
    status = vs_error_carry_on(err, nothing_varied(plan, keys, n, err));
  free(keys);
  return status;
}

/* What a study may have unless its key most_cases says otherwise: this process keeps eight bytes
 * for each, and its journal some hundred. */
enum { USUAL_CASES = 10000000 };

static vs_status too_many(const vs_plan *plan, const vs_plan_stage *stage, uint64_t most,
                          vs_error *err) {
  const vs_node *node = vs_tree_child(plan->tree.root, "most_cases");
  const vs_where where = node       ? node->where
                         : stage->n ? plan->axes[stage->axis].where
                                    : (vs_where){.file = plan->tree.name};
  if (most == VS_PLAN_CASES)
    return vs_fail_at(err, where, "more than %llu cases; fewer values are wanted",
                      (unsigned long long)VS_PLAN_CASES);
  return vs_fail_at(err, where,
                    "more than %llu cases; fewer values are wanted, or a larger most_cases, which "
                    "may be up to %llu",
                    (unsigned long long)most, (unsigned long long)VS_PLAN_CASES);
}

static vs_status count_cases(vs_plan *plan, vs_error *err) {
  uint64_t most = USUAL_CASES;
  vs_status status = vs_axis_whole(plan->tree.root, "most_cases", 1, VS_PLAN_CASES, &most, err);
  if (status) return status;
  plan->count = 1;
  for (size_t p = 0; p < plan->n_stages; p++) {
    vs_plan_stage *stage = &plan->stages[p];
    if (plan->adaptive && stage != plan->adaptive) continue;
    stage->count = stage->method->count(plan, stage);
    for (size_t k = stage->axis; k < stage->axis + stage->n && !stage->count; k++)
      if (!plan->axes[k].n_values)
        return vs_fail_at(err, plan->axes[k].where,
                          "%s: a range alone has no values; add step or n", plan->axes[k].key);
    if (stage->count > most) return too_many(plan, stage, most, err);
    plan->count *= stage->count;
    if (plan->count > most) return too_many(plan, stage, most, err);
  }
  return VS_OK;
}

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

/* ---- the first case ---- */

static double some_value(const vs_axis *a) {
  return a->n_values ? a->value[0] : a->ranged ? a->from : isnan(a->nominal) ? 0 : a->nominal;
}

static void first_point(const vs_plan *plan, double *point) {
  if (!plan->adaptive) {
    vs_plan_point(plan, 0, point);
    return;
  }
  for (size_t k = 0; k < plan->n_axes; k++) point[k] = some_value(&plan->axes[k]);
}

/* Error: the study asks for orbits, and the scene has none for a reason known before any search. */
static vs_status check_orbit(const vs_plan *plan, const vs_scene *scene, vs_error *err) {
  const vs_node *node = vs_tree_child(plan->tree.root, "steady");
  vs_error why = {0};
  if (!plan->periods || !vs_steady_check(scene, plan->periods, &why)) return VS_OK;
  return vs_fail_at(err, node->where, "%s", why.text + why.place_size);
}

/* Settles the scene of that point, and adds the files of its machine and its deck to the inputs. */
static vs_status try_point(vs_plan *plan, const double *point, vs_scene *scene, vs_error *err) {
  vs_status status = vs_plan_scene(plan, scene, err);
  if (status) return status;
  for (size_t k = 0; k < plan->n_axes; k++) vs_axis_put(&plan->axes[k], point[k], &scene->tree);
  size_t found = vs_error_count(err);
  status = vs_scene_settle(scene, NULL, err);
  if (!status && vs_error_count(err) == found) status = check_orbit(plan, scene, err);
  if (!status && vs_error_count(err) == found)
    status = vs_plan_input(plan, scene->setup.machine->path, err);
  const vs_coil *coil = &scene->setup.model.coil;
  if (!status && vs_error_count(err) == found && coil->law && coil->law->file)
    status = vs_plan_input(plan, coil->law->file(coil), err);
  for (size_t k = 0; k < scene->setup.deck.n_files && !status && vs_error_count(err) == found; k++)
    status = vs_plan_input(plan, scene->setup.deck.files[k], err);
  char path[VS_PATH_SIZE];
  for (int k = 0; !status && vs_control_file(&scene->control, k, path); k++)
    status = vs_plan_input(plan, path, err);
  return status;
}

/* Tries each name that an axis lists once, as it may be a file that is not there. */
static vs_status try_names(vs_plan *plan, double *point, vs_error *err) {
  vs_status status = VS_OK;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  for (size_t a = 0; a < plan->n_axes && !status; a++) {
    double kept = point[a];
    for (size_t w = 0; w < plan->axes[a].n_words && !status; w++) {
      if (plan->axes[a].field->kind != VS_NAME || (double)w == kept) continue;
      point[a] = (double)w;
      status = vs_error_carry_on(err, try_point(plan, point, scene, err));
      vs_scene_free(scene);
    }
    point[a] = kept;
  }
  free(scene);
  return status;
}

/* Finds the first case in which the axis has that number, among the first MOST, and writes its
 * point; false: there is none. */
static bool case_with(const vs_plan *plan, size_t axis, double number, double *point) {
  enum { MOST = 100000 };
  for (uint64_t k = 0; k < plan->count && k < MOST; k++) {
    vs_plan_point(plan, k, point);
    if (point[axis] == number) return true;
  }
  return false;
}

/* Where the tier is an axis, a case of each tier is tried: a scene may be bad input for one tier
 * alone, which would ignore its keys of the circuit. */
static vs_status try_tiers(vs_plan *plan, const double *first, vs_error *err) {
  vs_status status = VS_OK;
  double point[VS_PLAN_AXES];
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  for (size_t a = 0; a < plan->n_axes && !status && !plan->adaptive; a++) {
    if (strcmp(plan->axes[a].key, "run.tier")) continue;
    for (size_t w = 0; w < plan->axes[a].n_words && !status; w++) {
      if ((double)w == first[a] || !case_with(plan, a, (double)w, point)) continue;
      status = vs_error_carry_on(err, try_point(plan, point, scene, err));
      vs_scene_free(scene);
    }
  }
  free(scene);
  return status;
}

static vs_status try_cases(vs_plan *plan, vs_error *err) {
  double point[VS_PLAN_AXES];
  first_point(plan, point);
  plan->first = vs_alloc(1, sizeof *plan->first);
  size_t found = vs_error_count(err);
  vs_status status = try_point(plan, point, plan->first, err);
  if (status || vs_error_count(err) > found) return status;
  status = resolve_columns(plan, plan->first, plan->first->tier, err);
  for (size_t p = 0; p < plan->n_stages && !status && vs_error_count(err) == found; p++)
    if (plan->stages[p].method->ready)
      status = vs_error_carry_on(err, plan->stages[p].method->ready(plan, &plan->stages[p], err));
  if (!status) status = try_tiers(plan, point, err);
  return status ? status : try_names(plan, point, err);
}

vs_status vs_plan_input(vs_plan *plan, const char *path, vs_error *err) {
  for (size_t k = 0; k < plan->n_inputs; k++)
    if (!strcmp(plan->inputs[k].path, path)) return VS_OK;
  plan->inputs = vs_resize(plan->inputs, plan->n_inputs + 1, sizeof *plan->inputs);
  vs_input *input = &plan->inputs[plan->n_inputs];
  *input = (vs_input){0};
  snprintf(input->path, sizeof input->path, "%s", path);
  vs_status status = vs_hash_file(path, input->sha256, err);
  if (!status) plan->n_inputs++;
  return status;
}

/* ---- all of it ---- */

static vs_status read_base(vs_plan *plan, vs_error *err) {
  vs_status status = name_scene(plan, err);
  plan->base = vs_alloc(1, sizeof *plan->base);
  if (!status) status = vs_plan_scene(plan, plan->base, err);
  if (!status) status = vs_plan_input(plan, plan->path, err);
  if (!status) status = vs_plan_input(plan, plan->base->path, err);
  if (!status)
    status = vs_error_carry_on(err, vs_atwork_read(plan->tree.root, &plan->periods, err));
  return status ? status : vs_scene_settle(plan->base, NULL, err);
}

/* True if the scene's keys are known. In a check they may be, though errors were found in the
 * scene. */
static bool has_sections(const vs_scene *scene) {
  return scene && scene->setup.deck.n_files && !scene->setup.deck.lost &&
         !scene->setup.machine->lost;
}

/* Error: the file has a key that no study has. */
static vs_status check_keys(const vs_plan *plan, vs_error *err) {
  size_t n;
  const char **keys = study_keys(plan->methods, &n);
  vs_status status = vs_field_known_keys(plan->tree.root, "a study", keys, n, err);
  free(keys);
  return status;
}

vs_status vs_plan_read(const char *name, const vs_method *const *methods, char *const *sets,
                       size_t n_sets, vs_plan *plan, vs_error *err) {
  *plan = (vs_plan){.methods = methods, .sets = sets, .n_sets = n_sets};
  vs_status status = vs_path_find(&vs_scene_study_shelf, name, (vs_where){0}, plan->path, err);
  if (!status) status = vs_tree_read(plan->path, &plan->tree, err);
  for (size_t k = 0; k < n_sets && !status; k++)
    if (is_of_study(plan, sets[k]))
      status = vs_error_carry_on(err, vs_tree_set(&plan->tree, sets[k], err));
  if (!status) status = check_keys(plan, err);
  if (!status) status = vs_error_carry_on(err, read_base(plan, err));
  if (status || !has_sections(plan->base))
    return status; /* without the scene's keys no axis can be read */
  status = read_stages(plan, err);
  if (!status) status = read_report(plan, err);
  if (status) return status;
  if (vs_error_count(err)) return resolve_columns(plan, plan->base, vs_tiers_automatic(true), err);
  status = count_cases(plan, err);
  return status ? status : try_cases(plan, err);
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
