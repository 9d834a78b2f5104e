/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/study_check.h"

#include <stdlib.h>
#include <string.h>

#include "run/session.h"
#include "study_file.h"

bool vs_study_check_is_study(const char *name, const vs_method *const *methods) {
  char path[VS_PATH_SIZE];
  vs_error none = {0};
  vs_tree tree = {0};
  if (vs_path_find(&vs_scene_shelf, name, (vs_where){0}, path, &none))
    return !vs_path_find(&vs_scene_study_shelf, name, (vs_where){0}, path, &none);
  bool study = false;
  size_t n = strlen(path);
  bool yaml = (n > 5 && !strcmp(path + n - 5, ".yaml")) || (n > 4 && !strcmp(path + n - 4, ".yml"));
  if (!yaml || vs_tree_read(path, &tree, &none)) n = 0;
  if (n) study = vs_plan_has_keys(&tree, methods);
  vs_tree_free(&tree);
  return study;
}

/* The columns besides those of the verdict's lines. */
static size_t count_asked(const vs_plan *plan) {
  size_t n = 0;
  for (size_t k = 0; k < plan->n_columns; k++) n += !plan->columns[k].line;
  return n;
}

/* Adds what the first case's scene has for each axis: "circuit.across_switch 1N4744". */
static void add_first_case(const vs_plan *plan, vs_text *text) {
  const char *between = "";
  for (size_t k = 0; k < plan->n_axes; k++) {
    const vs_node *own = vs_tree_find(plan->first->tree.root, plan->axes[k].key);
    if (!own || own->kind != VS_NODE_TEXT) continue;
    vs_text_add(text, "%s%s %s", between, own->key, own->text);
    between = ", ";
  }
}

vs_status vs_study_check_read(const vs_check_options *o, const vs_method *const *methods,
                              vs_text *good, vs_error *err) {
  vs_plan *plan = vs_alloc(1, sizeof *plan);
  char method[128];
  vs_error why = {0};
  vs_status status = vs_study_file_read(o->name, methods, o->sets, o->n_sets, plan, err);
  bool rests = true;
  if (!status && !vs_error_count(err)) {
    status = vs_session_try(plan->first->tier, &plan->first->setup, &why);
    rests = !status || !why.conducts;
    why.findings = err->findings;
    if (status && rests) *err = why;
    if (!rests) status = VS_OK; /* others of its cases may begin */
  }
  if (!status && !vs_error_count(err)) {
    vs_plan_method(plan, method, sizeof method);
    vs_text_add(good, "a good study: %s, %s%llu cases of %zu %s, %zu columns; tier %s (%s)", method,
                plan->adaptive ? "at most " : "", (unsigned long long)plan->count, plan->n_axes,
                plan->n_axes == 1 ? "axis" : "axes", count_asked(plan), plan->first->tier->name,
                plan->first->why);
    vs_control_describe(&plan->first->control, good);
    if (!rests) {
      vs_text_add(good, "; its first case (");
      add_first_case(plan, good);
      vs_text_add(good, ") cannot begin: %s", why.text);
    }
  }
  vs_plan_free(plan);
  free(plan);
  return status;
}
