/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/plan.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "base/hash.h"
#include "base/units.h"
#include "scene/result.h"

static bool is_of_study(const char *set);

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
  if (access(name->text, R_OK) && n < VS_PATH_SIZE && !access(path, R_OK)) return VS_OK;
  return vs_path_find(&FILES, name->text, name->where, path, err);
}

/* scene: a path, also from the study's folder, or the name of one that comes with the program. */
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
  if (status) return status;
  if (set && (set->kind == VS_NODE_LIST || (set->kind == VS_NODE_TEXT && *set->text)))
    return vs_fail_at(err, set->where, "set: a map of keys is wanted: {run.until: 0.1 s, ...}");
  for (const vs_node *n = set ? set->child : NULL; n; n = n->next)
    vs_tree_graft(&scene->tree, n->key, n);
  for (size_t k = 0; k < plan->n_sets && !status; k++)
    if (!is_of_study(plan->sets[k]))
      status = vs_error_carry_on(err, vs_tree_set(&scene->tree, plan->sets[k], err));
  return status;
}

/* ---- columns ---- */

int vs_plan_column(vs_plan *plan, const char *measure, vs_where where) {
  if (!strcmp(measure, "margin_least")) return VS_COLUMN_MARGIN;
  for (size_t k = 0; k < plan->n_columns; k++)
    if (!strcmp(plan->columns[k].name, measure)) return (int)k;
  if (plan->n_columns >= VS_PLAN_COLUMNS) return VS_COLUMN_MARGIN; /* read_report refuses so many */
  vs_report_column *column = &plan->columns[plan->n_columns];
  *column = (vs_report_column){.rating = NAN, .where = where};
  snprintf(column->name, sizeof column->name, "%s", measure);
  return (int)plan->n_columns++;
}

static vs_status read_report(vs_plan *plan, vs_error *err) {
  const vs_node *list = vs_tree_child(plan->tree.root, "report");
  size_t room = VS_PLAN_COLUMNS - plan->n_columns, n = 0;
  vs_status status = VS_OK;
  if (!list || (list->kind == VS_NODE_TEXT && !*list->text)) {
    for (size_t k = 0; k < VS_MEASURES; k++)
      vs_plan_column(plan, vs_measures_standard[k].name, (vs_where){0});
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

static vs_status unknown_measure(const vs_report_column *column, const vs_frame *frame,
                                 const vs_tier *tier, const vs_result *result, vs_error *err) {
  enum { MOST = 1024 };
  vs_shown *all = vs_alloc(MOST, sizeof *all);
  const char **names = vs_alloc(MOST, sizeof *names);
  size_t n = 0;
  while (n < MOST && vs_result_shown_at(frame, result, (int)n, &all[n])) {
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

/* Gives columns their units, as that scene on that tier has them. */
static vs_status resolve_columns(vs_plan *plan, const vs_scene *scene, const vs_tier *tier,
                                 vs_error *err) {
  const vs_frame frame = vs_sim_frame(tier, &scene->setup);
  vs_measures *measures = vs_measures_new(&frame);
  vs_devices *devices = vs_devices_new(&frame);
  const vs_result result = {.measures = measures, .devices = devices};
  vs_status status = VS_OK;
  for (size_t c = 0; c < plan->n_columns && !status; c++) {
    vs_report_column *column = &plan->columns[c];
    vs_shown m = {0};
    char suffix[64];
    int k = 0;
    while (vs_result_shown_at(&frame, &result, k, &m) && strcmp(m.name, column->name)) k++;
    if (strcmp(m.name, column->name)) {
      status = vs_error_carry_on(err, unknown_measure(column, &frame, tier, &result, err));
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
  vs_measures_free(measures);
  vs_devices_free(devices);
  return status;
}

double vs_plan_results_value(const vs_results *r, uint64_t index, int column) {
  return r->values[index * (1 + r->plan->n_columns) + (size_t)(column + 1)];
}

void vs_plan_generation_add(vs_generation *g, const double *point) {
  if (g->count == g->capacity) {
    g->capacity = g->capacity ? 2 * g->capacity : 64;
    g->points = realloc(g->points, g->capacity * (g->n_axes ? g->n_axes : 1) * sizeof *g->points);
    if (!g->points) abort();
  }
  memcpy(g->points + g->count++ * g->n_axes, point, g->n_axes * sizeof *point);
}

/* ---- methods ---- */

static const vs_method *find_method(const vs_node *section, vs_error *err) {
  vs_text names = {0};
  for (const vs_method *const *m = vs_methods_all; *m; m++) {
    if (strcmp((*m)->key, section->key)) continue;
    if ((*m)->claims(section)) {
      vs_text_free(&names);
      return *m;
    }
    vs_text_add(&names, "%s%s", names.length ? ", " : "", (*m)->name);
  }
  const vs_node *word = vs_tree_child(section, "method");
  vs_fail_at(err, word ? word->where : section->where, "%s: no method '%s'; there are: %s",
             section->key, word && word->text ? word->text : "", names.text ? names.text : "none");
  vs_text_free(&names);
  return NULL;
}

static bool is_key(const char *key, size_t before) {
  for (size_t k = 0; k < before; k++)
    if (!strcmp(vs_methods_all[k]->key, key)) return true;
  return false;
}

/* The keys a study may have: its own, and one for each kind of method. */
static size_t study_keys(const char *names[16]) {
  static const char *const OWN[] = {"scene", "set", "report"};
  size_t n = 0;
  for (; n < sizeof OWN / sizeof *OWN; n++) names[n] = OWN[n];
  for (size_t k = 0; vs_methods_all[k] && n < 16; k++)
    if (!is_key(vs_methods_all[k]->key, k)) names[n++] = vs_methods_all[k]->key;
  return n;
}

/* Is a --set one of the study itself (sample.n=4096), none of its scene? */
static bool is_of_study(const char *set) {
  const char *keys[16];
  size_t n = study_keys(keys), length = strcspn(set, ".=");
  for (size_t k = 0; k < n; k++)
    if (strlen(keys[k]) == length && !strncmp(keys[k], set, length)) return true;
  return false;
}

static vs_status read_part(vs_plan *plan, const vs_node *section, vs_error *err) {
  const vs_method *method = find_method(section, err);
  if (!method) return VS_INPUT;
  vs_plan_stage *part = &plan->parts[plan->n_parts++];
  *part = (vs_plan_stage){.method = method, .axis = plan->n_axes};
  vs_status status = method->read(plan, section, &part->state, err);
  part->n = plan->n_axes - part->axis;
  if (status || !method->next) return status;
  if (plan->adaptive)
    return vs_fail_at(err, section->key_where, "%s: %s chooses the cases already; one study, one",
                      section->key, plan->adaptive->method->key);
  plan->adaptive = part;
  return VS_OK;
}

/* In the order of the table, whatever the file's: of two, the first runs slower. */
static vs_status read_parts(vs_plan *plan, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t k = 0; vs_methods_all[k] && !status; k++) {
    if (is_key(vs_methods_all[k]->key, k)) continue;
    const vs_node *section = vs_tree_child(plan->tree.root, vs_methods_all[k]->key);
    if (section && plan->n_parts < VS_PLAN_STAGES)
      status = vs_error_carry_on(err, read_part(plan, section, err));
  }
  if (!status && !vs_error_count(err) && !plan->n_parts)
    status = vs_error_carry_on(
        err, vs_fail_at(err, (vs_where){.file = plan->tree.name},
                        "nothing is varied: one of vary, sample, find, snubber is "
                        "wanted"));
  return status;
}

static vs_status too_many(const vs_plan *plan, vs_error *err) {
  return vs_fail_at(err, (vs_where){.file = plan->tree.name},
                    "more than %llu cases; fewer values are wanted",
                    (unsigned long long)VS_PLAN_CASES);
}

static vs_status count_cases(vs_plan *plan, vs_error *err) {
  plan->count = 1;
  for (size_t p = 0; p < plan->n_parts; p++) {
    vs_plan_stage *part = &plan->parts[p];
    if (plan->adaptive && part != plan->adaptive) continue;
    part->count = part->method->count(plan, part);
    for (size_t k = part->axis; k < part->axis + part->n && !part->count; k++)
      if (!plan->axes[k].n_values)
        return vs_fail_at(err, plan->axes[k].where,
                          "%s: a range alone has no values; add step or n", plan->axes[k].key);
    if (part->count > VS_PLAN_CASES) return too_many(plan, err);
    plan->count *= part->count;
    if (plan->count > VS_PLAN_CASES) return too_many(plan, err);
  }
  return VS_OK;
}

void vs_plan_method(const vs_plan *plan, char *text, size_t size) {
  *text = '\0';
  for (size_t p = 0; p < plan->n_parts; p++) {
    size_t n = strlen(text);
    if (!plan->adaptive || plan->adaptive == &plan->parts[p])
      snprintf(text + n, size - n, "%s%s", n ? " x " : "", plan->parts[p].method->name);
  }
}

void vs_plan_point(const vs_plan *plan, uint64_t index, double *point) {
  for (size_t p = plan->n_parts; p-- > 0;) {
    const vs_plan_stage *part = &plan->parts[p];
    part->method->point(plan, part, index % part->count, point + part->axis);
    index /= part->count;
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

/* The scene of that point, settled, and its deck's files as inputs. */
static vs_status try_point(vs_plan *plan, const double *point, vs_scene *scene, vs_error *err) {
  vs_status status = vs_plan_scene(plan, scene, err);
  if (status) return status;
  for (size_t k = 0; k < plan->n_axes; k++) vs_axis_put(&plan->axes[k], point[k], &scene->tree);
  size_t found = vs_error_count(err);
  status = vs_scene_settle(scene, NULL, err);
  for (size_t k = 0; k < scene->setup.deck.n_files && !status && vs_error_count(err) == found; k++)
    status = vs_plan_input(plan, scene->setup.deck.files[k], err);
  return status;
}

/* Each name an axis lists is tried once, as it may be a file that is not there. */
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

/* The point of the first case, of so many, in which the axis has that number; false: there is
 * none. */
static bool case_with(const vs_plan *plan, size_t axis, double number, double *point) {
  enum { MOST = 100000 };
  for (uint64_t k = 0; k < plan->count && k < MOST; k++) {
    vs_plan_point(plan, k, point);
    if (point[axis] == number) return true;
  }
  return false;
}

/* Where the tier itself is an axis, a case of each is tried: a scene may be bad input for one of
 * them alone, with keys of the circuit that it would ignore. */
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
  for (size_t p = 0; p < plan->n_parts && !status && vs_error_count(err) == found; p++)
    if (plan->parts[p].method->ready)
      status = vs_error_carry_on(err, plan->parts[p].method->ready(plan, &plan->parts[p], err));
  if (!status) status = try_tiers(plan, point, err);
  return status ? status : try_names(plan, point, err);
}

vs_status vs_plan_input(vs_plan *plan, const char *path, vs_error *err) {
  for (size_t k = 0; k < plan->n_inputs; k++)
    if (!strcmp(plan->inputs[k].path, path)) return VS_OK;
  plan->inputs = realloc(plan->inputs, (plan->n_inputs + 1) * sizeof *plan->inputs);
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
  return status ? status : vs_scene_settle(plan->base, NULL, err);
}

/* Where a check has found errors in the scene, its keys may be known all the same. */
static bool has_sections(const vs_scene *scene) {
  return scene && scene->setup.deck.n_files && !scene->setup.deck.lost;
}

vs_status vs_plan_read(const char *name, char *const *sets, size_t n_sets, vs_plan *plan,
                       vs_error *err) {
  const char *keys[16];
  *plan = (vs_plan){.sets = sets, .n_sets = n_sets};
  vs_status status = vs_path_find(&vs_plan_shelf, name, (vs_where){0}, plan->path, err);
  if (!status) status = vs_tree_read(plan->path, &plan->tree, err);
  for (size_t k = 0; k < n_sets && !status; k++)
    if (is_of_study(sets[k]))
      status = vs_error_carry_on(err, vs_tree_set(&plan->tree, sets[k], err));
  if (!status)
    status = vs_field_known_keys(plan->tree.root, "a study", keys, study_keys(keys), err);
  if (!status) status = vs_error_carry_on(err, read_base(plan, err));
  if (status || !has_sections(plan->base)) return status; /* axes are keys of that scene */
  status = read_parts(plan, err);
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
  for (size_t p = 0; p < plan->n_parts; p++)
    if (plan->parts[p].method->free) plan->parts[p].method->free(plan->parts[p].state);
  for (size_t k = 0; k < plan->n_axes; k++) {
    vs_axis *axis = &plan->axes[k];
    for (size_t w = 0; w < axis->n_words; w++) free(axis->word[w]);
    free(axis->word);
    free(axis->word_where);
    free(axis->value);
    free(axis->own);
  }
  free_scene(plan->base);
  free_scene(plan->first);
  free(plan->inputs);
  vs_tree_free(&plan->tree);
  *plan = (vs_plan){0};
}
