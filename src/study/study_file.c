/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study_file.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "judge.h"
#include "report_columns.h"

/* ---- methods ---- */

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
  vs_status status = vs_fail_at(err, (vs_where){plan->tree.name, 1, 1},
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
    if (section) status = vs_error_keep(err, read_stage(plan, section, err));
  }
  if (!status && !vs_error_count(err) && !plan->n_stages)
    status = vs_error_keep(err, nothing_varied(plan, keys, n, err));
  free(keys);
  return status;
}

/* The most cases unless the key most_cases says otherwise: this process keeps eight bytes for each,
 * and its journal some hundred. */
enum { DEFAULT_CASES = 10000000 };

static vs_status too_many(const vs_plan *plan, const vs_plan_stage *stage, uint64_t most,
                          vs_error *err) {
  const vs_node *node = vs_tree_child(plan->tree.root, "most_cases");
  const vs_where where = node       ? node->where
                         : stage->n ? plan->axes[stage->axis].where
                                    : (vs_where){plan->tree.name, 1, 1};
  if (most == VS_PLAN_CASES)
    return vs_fail_at(err, where, "more than %llu cases; fewer values are wanted",
                      (unsigned long long)VS_PLAN_CASES);
  return vs_fail_at(err, where,
                    "more than %llu cases; fewer values are wanted, or a larger most_cases, which "
                    "may be up to %llu",
                    (unsigned long long)most, (unsigned long long)VS_PLAN_CASES);
}

static vs_status count_cases(vs_plan *plan, vs_error *err) {
  uint64_t most = DEFAULT_CASES;
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
  for (size_t p = 0; p < plan->n_stages; p++) {
    const vs_plan_stage *stage = &plan->stages[p];
    if (!stage->method->draw) continue; /* else not all its axes have a number in each case */
    /* the last of the threats is the scene itself, which goes with all that the others may not */
    const uint64_t last = stage->method->count(plan, stage) - 1;
    stage->method->point(plan, stage, last, point + stage->axis);
  }
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
  vs_plan_put(plan, point, &scene->tree);
  size_t found = vs_error_count(err);
  status = vs_scene_read_sections(scene, NULL, err);
  if (!status && vs_error_count(err) == found) status = vs_plan_check_case(plan, point, scene, err);
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

/* Tries a point besides the first one. Its part, deck or tier may bring lines of the verdict that
 * the first point's does not have. */
static vs_status try_case(vs_plan *plan, const double *point, vs_scene *scene, vs_error *err) {
  const size_t found = vs_error_count(err);
  vs_status status = try_point(plan, point, scene, err);
  if (status || vs_error_count(err) > found) return status;
  return vs_report_columns_add_lines(plan, scene, err);
}

/* True for an axis whose numbers depend on each other. */
static bool is_drawn(const vs_plan *plan, size_t axis) {
  for (size_t p = 0; p < plan->n_stages; p++) {
    const vs_plan_stage *stage = &plan->stages[p];
    if (stage->method->draw && axis >= stage->axis && axis < stage->axis + stage->n) return true;
  }
  return false;
}

/* Tries each name that an axis lists once, as it may be a file that is not there. */
static vs_status try_names(vs_plan *plan, double *point, vs_error *err) {
  vs_status status = VS_OK;
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  for (size_t a = 0; a < plan->n_axes && !status; a++) {
    double kept = point[a];
    for (size_t w = 0; w < plan->axes[a].n_words && !status; w++) {
      if (plan->axes[a].field->kind != VS_NAME || (double)w == kept) continue;
      if (is_drawn(plan, a)) break; /* it names no file, and its method has tried it */
      point[a] = (double)w;
      status = vs_error_keep(err, try_case(plan, point, scene, err));
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
      status = vs_error_keep(err, try_case(plan, point, scene, err));
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
  status = vs_report_columns_resolve(plan, plan->first, plan->first->tier, err);
  if (!status && vs_error_count(err) == found)
    status = vs_report_columns_add_lines(plan, plan->first, err);
  if (!status) status = try_tiers(plan, point, err);
  if (!status) status = try_names(plan, point, err);
  for (size_t p = 0; p < plan->n_stages && !status && vs_error_count(err) == found; p++)
    if (plan->stages[p].method->ready)
      status = vs_error_keep(err, plan->stages[p].method->ready(plan, &plan->stages[p], err));
  return status;
}

/* ---- all of it ---- */

/* Error: a spread of the study itself, and no threats that it goes along with. */
static vs_status check_spread(const vs_plan *plan, vs_error *err) {
  const vs_node *spread = vs_tree_child(plan->tree.root, "spread");
  if (!spread || vs_tree_child(plan->tree.root, "threats")) return VS_OK;
  return vs_fail_at(err, spread->key_where,
                    "spread: it goes along with threats, and the study has none; "
                    "sample: {method: sobol, spread: {...}} is wanted");
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
  bool found = strchr(node->text, '.') && !vs_plan_find(node, path, &none);
  snprintf(plan->scene_name, sizeof plan->scene_name, "%s", found ? path : node->text);
  return VS_OK;
}

static vs_status read_base(vs_plan *plan, vs_error *err) {
  vs_status status = name_scene(plan, err);
  plan->base = vs_alloc(1, sizeof *plan->base);
  if (!status) status = vs_plan_scene(plan, plan->base, err);
  if (!status) status = vs_plan_input(plan, plan->path, err);
  if (!status) status = vs_plan_input(plan, plan->base->path, err);
  if (!status)
    status = vs_error_keep(err, vs_orbit_columns_read(plan->tree.root, &plan->periods, err));
  plan->base->of_period = plan->periods > 0;
  return status ? status : vs_scene_read_sections(plan->base, NULL, err);
}

/* True if the scene's keys are known. In a check they may be, though errors were found in the
 * scene. */
static bool has_sections(const vs_scene *scene) {
  return scene && scene->setup.deck.n_files && !scene->setup.deck.lost &&
         !scene->setup.machine->lost;
}

/* Error: the file has a key that no study has, or one that goes with a method it does not ask for.
 */
static vs_status check_keys(const vs_plan *plan, vs_error *err) {
  size_t n;
  const char **keys = vs_plan_known_keys(plan->methods, &n);
  vs_status status = vs_field_known_keys(plan->tree.root, "a study", keys, n, err);
  free(keys);
  for (const vs_method *const *m = plan->methods; *m && !status; m++)
    for (const vs_field *row = (*m)->besides; row && row->key && !status; row++) {
      const vs_node *node = vs_tree_child(plan->tree.root, row->key);
      if (!node || vs_tree_child(plan->tree.root, (*m)->key)) continue;
      status = vs_error_keep(err, vs_fail_at(err, node->key_where,
                                             "%s: goes with %s, which the study "
                                             "does not have",
                                             row->key, (*m)->key));
    }
  return status;
}

vs_status vs_study_file_read(const char *name, const vs_method *const *methods, char *const *sets,
                             size_t n_sets, vs_plan *plan, vs_error *err) {
  *plan = (vs_plan){.methods = methods, .sets = sets, .n_sets = n_sets};

  /* The file, with those --set that are the study's own. */
  vs_status status = vs_path_find(&vs_scene_study_shelf, name, (vs_where){0}, plan->path, err);
  if (!status) status = vs_tree_read(plan->path, &plan->tree, err);
  for (size_t k = 0; k < n_sets && !status; k++)
    if (vs_plan_is_own(plan, sets[k]))
      status = vs_error_keep(err, vs_tree_set(&plan->tree, sets[k], err));
  if (!status) status = check_keys(plan, err);
  if (!status) status = vs_error_keep(err, check_spread(plan, err));

  /* The scene that is varied: its sections say which keys there are, with their units. */
  if (!status) status = vs_error_keep(err, read_base(plan, err));
  if (status || !has_sections(plan->base))
    return status; /* without the scene's keys no axis can be read */

  /* The methods with their axes, then the columns. */
  status = read_stages(plan, err);
  if (!status) status = vs_report_columns_read(plan, err);
  if (status) return status;
  if (vs_error_count(err))
    return vs_report_columns_resolve(plan, plan->base, vs_tiers_automatic(true), err);

  /* How many cases there are; the scenes of the first ones are settled, so that a study that cannot
   * run is refused here. */
  status = count_cases(plan, err);
  if (!status) status = try_cases(plan, err);
  return status ? status : vs_judge_check(plan, err);
}
