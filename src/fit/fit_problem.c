/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/fit_problem.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "study/orbit_columns.h"

static const char *const OWN[] = {"scene",   "set",    "measures",  "steady",   "data",
                                  "runs",    "free",   "seed",      "starts",   "residual",
                                  "profile", "slopes", "impedance", "core_loss"};
enum { N_OWN = sizeof OWN / sizeof *OWN };
/* Those of them that belong to one run. */
static const char *const OF_RUN[] = {"measures", "steady", "data", "impedance", "core_loss"};
enum { N_OF_RUN = sizeof OF_RUN / sizeof *OF_RUN };

/* ---- scenes ---- */

bool vs_fit_problem_owns(const char *set) {
  size_t length = strcspn(set, ".=");
  for (size_t k = 0; k < N_OWN; k++)
    if (strlen(OWN[k]) == length && !strncmp(OWN[k], set, length)) return true;
  return false;
}

/* Opens the scene that a node names: a path, which starts from the fit's folder, or the name of
 * one that comes with the program. */
static vs_status open_scene(const vs_node *node, vs_scene *scene, vs_error *err) {
  if (!node) return vs_scene_open("paper", (vs_where){0}, scene, err);
  if (node->kind != VS_NODE_TEXT || !*node->text)
    return vs_fail_at(err, node->where, "scene: a file, or the name of a scene, is wanted");
  return vs_scene_open(node->text, node->where, scene, err);
}

static vs_status put_set(const vs_node *set, vs_scene *scene, vs_error *err) {
  if (set && (set->kind == VS_NODE_LIST || (set->kind == VS_NODE_TEXT && *set->text)))
    return vs_fail_at(err, set->where, "set: a map of keys is wanted: {run.until: 0.1 s, ...}");
  vs_status status = VS_OK;
  for (const vs_node *n = set ? set->child : NULL; n && !status; n = n->next)
    status = vs_tree_graft(&scene->tree, n->key, n, err);
  return status;
}

/* Reads the scene of a run. own: the run's map; NULL: the fit has one run. */
static vs_status read_scene_of_run(const vs_fit_problem *q, const vs_node *own, vs_scene *scene,
                                   vs_error *err) {
  const vs_node *name = vs_tree_child(own, "scene"), *root = q->tree.root;
  vs_status status = open_scene(name ? name : vs_tree_child(root, "scene"), scene, err);
  if (!status) status = put_set(vs_tree_child(root, "set"), scene, err);
  if (!status && own) status = put_set(vs_tree_child(own, "set"), scene, err);
  for (size_t k = 0; k < q->n_sets && !status; k++)
    if (!vs_fit_problem_owns(q->sets[k])) status = vs_tree_set(&scene->tree, q->sets[k], err);
  return status ? status : vs_scene_read_sections(scene, NULL, err);
}

/* ---- runs ---- */

/* A run that is only sampled ends with its last sample. */
static vs_status shorten_run(vs_fit_problem_run *run, vs_error *err) {
  char text[VS_NAME_SIZE];
  const vs_recording *r = &run->recording;
  double last_s = r->samples[r->n_samples - 1].t_s;
  if (run->aims.count || !(last_s > 0) || last_s >= run->scene->setup.run.until_s) return VS_OK;
  snprintf(text, sizeof text, "%.17g s", last_s);
  vs_tree_put(&run->scene->tree, "run.until", text, (vs_where){r->path, 1, 1});
  return vs_scene_reread(run->scene, err);
}

/* Reads whether the run is one period of an orbit, and whether its scene can have one. */
static vs_status read_steady(vs_fit_problem_run *run, const vs_node *holder, vs_error *err) {
  vs_error why = {0};
  const vs_node *steady = vs_tree_child(holder, "steady"), *data = vs_tree_child(holder, "data");
  vs_status status = vs_orbit_columns_read(holder, &run->periods, err);
  if (status || !run->periods) return status;
  if (data)
    return vs_fail_at(
        err, data->key_where,
        "data stands beside steady, and a period of an orbit is not sampled: record a "
        "run that begins on it, by set: {start: steady}");
  vs_scene_disable_control(run->scene);
  if (!vs_steady_check(run->scene, run->periods, &why)) return VS_OK;
  return vs_fail_at(err, steady->where, "%s", why.text + why.place_size);
}

static vs_status read_run(vs_fit_problem *q, const vs_node *own, const vs_node *holder,
                          vs_error *err) {
  vs_fit_problem_run *run = &q->runs[q->n_runs++];
  const vs_node *measures = vs_tree_child(holder, "measures"),
                *data = vs_tree_child(holder, "data"),
                *impedance = vs_tree_child(holder, "impedance"),
                *losses = vs_tree_child(holder, "core_loss");
  run->scene = vs_alloc(1, sizeof *run->scene);
  vs_status status = read_scene_of_run(q, own, run->scene, err);
  if (!status && !measures && !data && !impedance && !losses)
    status = vs_fail_at(err, own ? own->where : (vs_where){q->tree.name, 1, 1},
                        "nothing was measured: measures, data, impedance or core_loss is wanted");
  if (!status) status = read_steady(run, holder, err);
  if (!status && measures)
    status = vs_targets_read(&run->aims, measures, run->scene, run->periods, err);
  if (!status && impedance) status = vs_targets_read_impedance(&run->aims, impedance, q->path, err);
  if (!status && losses) status = vs_targets_read_core_loss(&run->aims, losses, q->path, err);
  if (!status && data) {
    run->recorded = true;
    status = vs_recording_read(&run->recording, data, q->path, run->scene, err);
    if (!status) status = shorten_run(run, err);
  }
  return status;
}

static vs_status read_runs(vs_fit_problem *q, vs_error *err) {
  static const char *const KEYS[] = {"scene",  "set",  "free",      "measures",
                                     "steady", "data", "impedance", "core_loss"};
  const vs_node *root = q->tree.root, *runs = vs_tree_child(root, "runs");
  if (!runs) return read_run(q, NULL, root, err);
  for (size_t k = 0; k < N_OF_RUN; k++) {
    const vs_node *twice = vs_tree_child(root, OF_RUN[k]);
    if (twice)
      return vs_fail_at(err, twice->key_where, "%s stands beside runs: move it into one of them",
                        OF_RUN[k]);
  }
  if (runs->kind != VS_NODE_LIST || !runs->child)
    return vs_fail_at(err, runs->where, "runs: a list is wanted: [{set: ..., measures: ...}, ...]");
  vs_status status = VS_OK;
  for (const vs_node *own = runs->child; own && !status; own = own->next) {
    if (q->n_runs == VS_INQUIRY_RUNS)
      return vs_fail_at(err, own->where, "runs: more than %d", VS_INQUIRY_RUNS);
    if (own->kind != VS_NODE_MAP)
      return vs_fail_at(err, own->where, "runs: a map is wanted: {set: ..., measures: ...}");
    status = vs_field_known_keys(own, "a run", KEYS, sizeof KEYS / sizeof *KEYS, err);
    if (!status) status = read_run(q, own, own, err);
  }
  return status;
}

/* ---- unknowns ---- */

static vs_status check_unknown(const vs_fit_problem *q, const vs_unknown *u, vs_error *err) {
  size_t n = strlen(u->axis.key);
  for (size_t k = 0; k + 1 < q->n_unknowns; k++) {
    const vs_unknown *other = &q->unknowns[k];
    bool same = other->run < 0 || u->run < 0 || other->run == u->run;
    if (same && !strcmp(other->axis.key, u->axis.key))
      return vs_fail_at(err, u->axis.where, "%s is free already, as %s", u->name, other->name);
  }
  for (size_t k = 0; k < q->n_sets; k++)
    if (!strncmp(q->sets[k], u->axis.key, n) && q->sets[k][n] == '=')
      return vs_fail_at(err, u->axis.where,
                        "%s is free, and --set %s sets it; write start here to say where to start",
                        u->axis.key, q->sets[k]);
  return VS_OK;
}

static vs_status read_free(vs_fit_problem *q, const vs_node *map, int run, vs_error *err) {
  vs_status status = VS_OK;
  if (!map) return VS_OK;
  if (map->kind != VS_NODE_MAP)
    return vs_fail_at(err, map->where,
                      "free: a map is wanted: {machine.trough_mass: {from: 0.5 kg, to: 2 kg}}");
  for (const vs_node *n = map->child; n && !status; n = n->next) {
    if (q->n_unknowns == VS_INQUIRY_UNKNOWNS)
      return vs_fail_at(err, n->key_where, "free: more than %d keys", VS_INQUIRY_UNKNOWNS);
    vs_unknown *u = &q->unknowns[q->n_unknowns++];
    status = vs_unknown_read(u, q->runs[run < 0 ? 0 : run].scene, n, run, err);
    if (!status) status = check_unknown(q, u, err);
    if (!status && !isnan(u->prior)) q->n_priors++;
  }
  return status;
}

/* The keys that are common to all runs must be keys of each, of the same unit. */
static vs_status check_common(const vs_fit_problem *q, vs_error *err) {
  for (size_t k = 0; k < q->n_unknowns; k++) {
    const vs_unknown *u = &q->unknowns[k];
    for (size_t r = 1; r < q->n_runs && u->run < 0; r++) {
      vs_axis other;
      vs_node node = vs_tree_word(u->axis.key, "", u->axis.where);
      node.key_where = u->axis.where;
      vs_status status = vs_axis_init(&other, q->runs[r].scene, &node, "free", err);
      if (status) return status;
      bool same = vs_field_is_real(other.field) && !strcmp(other.unit, u->axis.unit);
      vs_axis_free(&other);
      if (!same)
        return vs_fail_at(err, u->axis.where, "%s is another key in run %zu", u->name, r + 1);
    }
  }
  return VS_OK;
}

/* Puts the starts into the scenes: a key that only a circuit has makes tier auto take one. */
static vs_status begin_at_starts(vs_fit_problem *q, vs_error *err) {
  vs_status status = VS_OK;
  for (size_t r = 0; r < q->n_runs && !status; r++) {
    for (size_t k = 0; k < q->n_unknowns; k++) {
      const vs_unknown *u = &q->unknowns[k];
      if (u->run < 0 || u->run == (int)r)
        vs_unknown_put(u, vs_unknown_natural(u, u->start), &q->runs[r].scene->tree);
    }
    status = vs_scene_reread(q->runs[r].scene, err);
  }
  return status;
}

static vs_status read_unknowns(vs_fit_problem *q, vs_error *err) {
  const vs_node *root = q->tree.root, *runs = vs_tree_child(root, "runs");
  vs_status status = read_free(q, vs_tree_child(root, "free"), -1, err);
  int run = 0;
  for (const vs_node *own = runs ? runs->child : NULL; own && !status; own = own->next)
    status = read_free(q, vs_tree_child(own, "free"), run++, err);
  if (!status && !q->n_unknowns)
    status = vs_fail_at(err, (vs_where){q->tree.name, 1, 1},
                        "nothing is free: free: {KEY: {from: A, to: B}} is wanted");
  if (!status) status = check_common(q, err);
  return status ? status : begin_at_starts(q, err);
}

/* ---- data ---- */

static void add_data(vs_fit_problem *q, int number) {
  vs_fit_problem_run *run = &q->runs[number];
  run->datum = q->n_data;
  for (size_t k = 0; k < run->aims.count; k++) {
    const vs_target *a = &run->aims.item[k];
    q->data[q->n_data++] = (vs_datum){.run = number,
                                      .aim = (int)k,
                                      .value = a->value,
                                      .error = a->error,
                                      .relative = a->relative,
                                      .where = a->where};
  }
  for (size_t k = 0; k < run->recording.n_samples; k++) {
    const vs_sample *s = &run->recording.samples[k];
    q->data[q->n_data++] = (vs_datum){.run = number,
                                      .aim = -1,
                                      .sample = k,
                                      .value = s->value,
                                      .error = s->error,
                                      .where = s->where};
  }
  run->data = q->n_data - run->datum;
}

static vs_status gather_data(vs_fit_problem *q, vs_error *err) {
  size_t count = 0;
  for (size_t r = 0; r < q->n_runs; r++)
    count += q->runs[r].aims.count + q->runs[r].recording.n_samples;
  q->data = vs_alloc(count, sizeof *q->data);
  for (size_t r = 0; r < q->n_runs; r++) add_data(q, (int)r);
  if (q->n_unknowns <= vs_fit_problem_residuals(q)) return VS_OK;
  return vs_fail_at(
      err, q->unknowns[vs_fit_problem_residuals(q)].axis.where,
      "free keys: %zu; numbers to find them from: %zu; measure more, free less, or add a "
      "prior",
      q->n_unknowns, vs_fit_problem_residuals(q));
}

size_t vs_fit_problem_residuals(const vs_fit_problem *q) {
  return q->n_data + q->n_priors;
}

static const vs_recorded *column_of(const vs_fit_problem *q, const vs_datum *d) {
  const vs_recording *r = &q->runs[d->run].recording;
  return &r->columns.item[r->samples[d->sample].column];
}

const char *vs_fit_problem_name(const vs_fit_problem *q, const vs_datum *d) {
  return d->aim < 0 ? column_of(q, d)->name : q->runs[d->run].aims.item[d->aim].name;
}

const char *vs_fit_problem_unit(const vs_fit_problem *q, const vs_datum *d) {
  return d->aim < 0 ? column_of(q, d)->unit : q->runs[d->run].aims.item[d->aim].unit;
}

/* ---- the other keys ---- */

static vs_status want_profile(vs_fit_problem *q, const char *name, vs_where where, vs_error *err) {
  const char *names[VS_INQUIRY_UNKNOWNS];
  bool all = !strcmp(name, "all"), found = all;
  for (size_t k = 0; k < q->n_unknowns; k++) {
    names[k] = q->unknowns[k].name;
    if (!all && strcmp(name, names[k])) continue;
    q->profiled[k] = found = true;
  }
  if (found) return VS_OK;
  const char *nearest = vs_text_nearest(name, names, q->n_unknowns);
  const char *hint = nearest ? nearest : "all";
  return where.file
             ? vs_fail_at(err, where, "profile: '%s' is not free; there is '%s'", name, hint)
             : vs_fail(err, VS_INPUT, "--profile: '%s' is not free; there is '%s'", name, hint);
}

static vs_status read_profile(vs_fit_problem *q, const char *more, vs_error *err) {
  const vs_node *node = vs_tree_child(q->tree.root, "profile");
  vs_status status = VS_OK;
  if (node && node->kind == VS_NODE_MAP)
    return vs_fail_at(err, node->where, "profile: 'all' or a list of free keys is wanted");
  if (node && node->kind == VS_NODE_TEXT && *node->text)
    status = want_profile(q, node->text, node->where, err);
  for (const vs_node *n = node ? node->child : NULL; n && !status; n = n->next)
    status = n->kind == VS_NODE_TEXT ? want_profile(q, n->text, n->where, err)
                                     : vs_fail_at(err, n->where, "profile: a key is wanted");
  char *words = vs_copy(more ? more : ""), *rest = words;
  for (char *word; !status && (word = strsep(&rest, ","));)
    if (*word) status = want_profile(q, word, (vs_where){0}, err);
  free(words);
  return status;
}

static vs_status read_settings(vs_fit_problem *q, vs_error *err) {
  int word = 0, slopes = 0;
  const vs_node *root = q->tree.root;
  q->starts = 8;
  q->seed = 1;
  vs_status status = vs_axis_whole(root, "starts", 1, 10000, &q->starts, err);
  if (!status) status = vs_axis_whole(root, "seed", 0, UINT32_MAX, &q->seed, err);
  if (!status) status = vs_axis_word(root, "fit.residual", "logarithm|difference", &word, err);
  q->difference = word == 1;
  if (!status) status = vs_axis_word(root, "fit.slopes", "auto|exact|differences", &slopes, err);
  q->slopes = (vs_jacobian_word)slopes;
  return status;
}

/* ---- all of it ---- */

vs_status vs_fit_problem_read(const char *name, char *const *sets, size_t n_sets,
                              const char *profile, vs_fit_problem *q, vs_error *err) {
  *q = (vs_fit_problem){.sets = sets, .n_sets = n_sets};
  vs_status status = vs_path_find(&vs_scene_fit_shelf, name, (vs_where){0}, q->path, err);
  if (!status) status = vs_tree_read(q->path, &q->tree, err);
  for (size_t k = 0; k < n_sets && !status; k++)
    if (vs_fit_problem_owns(sets[k])) status = vs_tree_set(&q->tree, sets[k], err);
  if (!status) status = vs_field_known_keys(q->tree.root, "a fit", OWN, N_OWN, err);
  if (!status) status = read_settings(q, err);
  if (!status) status = read_runs(q, err);
  if (!status) status = read_unknowns(q, err);
  if (!status) status = gather_data(q, err);
  return status ? status : read_profile(q, profile, err);
}

bool vs_fit_problem_is(const char *name) {
  char path[VS_PATH_SIZE];
  vs_error none = {0};
  vs_tree tree = {0};
  if (vs_path_find(&vs_scene_shelf, name, (vs_where){0}, path, &none))
    return !vs_path_find(&vs_scene_fit_shelf, name, (vs_where){0}, path, &none) &&
           vs_path_find(&vs_scene_study_shelf, name, (vs_where){0}, path, &none);
  const char *ending = strrchr(path, '.');
  bool yaml = ending && (!strcmp(ending, ".yaml") || !strcmp(ending, ".yml"));
  bool fit = yaml && !vs_tree_read(path, &tree, &none) &&
             (vs_tree_child(tree.root, "free") || vs_tree_child(tree.root, "measures") ||
              vs_tree_child(tree.root, "impedance") || vs_tree_child(tree.root, "core_loss") ||
              vs_tree_child(tree.root, "runs"));
  vs_tree_free(&tree);
  return fit;
}

void vs_fit_problem_free(vs_fit_problem *q) {
  for (size_t k = 0; k < q->n_unknowns; k++) vs_unknown_free(&q->unknowns[k]);
  for (size_t r = 0; r < q->n_runs; r++) {
    vs_scene_free(q->runs[r].scene);
    free(q->runs[r].scene);
    free(q->runs[r].aims.item);
    vs_recording_free(&q->runs[r].recording);
  }
  free(q->data);
  vs_tree_free(&q->tree);
  *q = (vs_fit_problem){0};
}
