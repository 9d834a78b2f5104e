/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "method/design_cases.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const vs_inside SETTINGS = {.rows = VS_ROWS({.kind = VS_SETTING})};
static const vs_field POINTS[] = {{.kind = VS_MAP, .inside = &SETTINGS}, {0}};
const vs_inside vs_design_cases_operation = {.rows = POINTS};

/* What the axis is, in lists. Its first word is the scene as it is, which threats come to. */
static const vs_field OPERATION = {
    .key = "operation", .kind = VS_NAME, .unit = "", .text = "the machine at work"};
static const char AS_IT_IS[] = "as_it_is";

static const vs_node *point_named(const vs_design_cases *c, size_t word) {
  const vs_node *point = word ? c->points->child : NULL;
  for (size_t k = 1; k < word; k++) point = point->next;
  return point;
}

/* ---- reading ---- */

static vs_status check_key(const vs_node *point, const vs_node *key, vs_error *err) {
  if (!strncmp(key->key, "events", 6))
    return vs_fail_at(err, key->key_where,
                      "operation.%s: events are threats; under threats they have their names",
                      point->key);
  if (key->kind == VS_NODE_MAP && key->child && strcmp(key->key, "start") != 0)
    return vs_fail_at(err, key->key_where,
                      "operation.%s: a map takes the place of all of %s; write {%s.%s: ...}",
                      point->key, key->key, key->key, key->child->key);
  return VS_OK;
}

static vs_status check_point(const vs_node *point, vs_error *err) {
  vs_status status = VS_OK;
  if (point->kind != VS_NODE_MAP || !point->child)
    return vs_fail_at(err, point->where,
                      "operation.%s: keys of the scene are wanted, as {supply.voltage: 484 V}",
                      point->key);
  for (const vs_node *n = point->child; n && !status; n = n->next)
    status = vs_error_keep(err, check_key(point, n, err));
  return status;
}

static void add_word(vs_axis *axis, const char *word, vs_where where) {
  axis->word[axis->n_words] = vs_copy(word);
  axis->word_where[axis->n_words] = where;
  axis->value[axis->n_values++] = (double)axis->n_words++;
}

static void add_axis(vs_plan *plan, vs_design_cases *c) {
  const size_t n = c->n_points + 1;
  c->axis = plan->n_axes++;
  vs_axis *axis = &plan->axes[c->axis];
  *axis = (vs_axis){.key = "operation",
                    .column = "operation",
                    .field = &OPERATION,
                    .unit = "",
                    .by = "catalogue",
                    .is_word = true,
                    .nominal = NAN,
                    .where = c->points->key_where};
  axis->word = vs_alloc(n, sizeof *axis->word);
  axis->word_where = vs_alloc(n, sizeof *axis->word_where);
  axis->value = vs_alloc(n, sizeof *axis->value);
  add_word(axis, AS_IT_IS, axis->where);
  for (const vs_node *p = c->points->child; p; p = p->next) add_word(axis, p->key, p->where);
}

vs_status vs_design_cases_read(vs_plan *plan, vs_design_cases *c, vs_error *err) {
  const size_t kept = vs_error_count(err);
  vs_status status = VS_OK;
  *c =
      (vs_design_cases){.points = vs_tree_child(plan->tree.root, "operation"), .scene = plan->base};
  for (size_t p = 0; p < plan->n_stages; p++)
    if (plan->stages[p].method->draw) c->threats = &plan->stages[p];
  if (!c->points) return VS_OK;
  if (c->points->kind != VS_NODE_MAP || !c->points->child)
    return vs_fail_at(err, c->points->where,
                      "operation: points are wanted, as {high: {supply.voltage: 484 V}}");
  for (const vs_node *n = c->points->child; n && !status; n = n->next, c->n_points++)
    status = vs_error_keep(err, check_point(n, err));
  if (!status && vs_error_count(err) == kept) add_axis(plan, c);
  return status;
}

/* Error: a scene does not take the point, as a key is misspelt. */
static vs_status try_point(const vs_plan *plan, const vs_node *point, vs_error *err) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status = vs_plan_scene(plan, scene, err);
  for (const vs_node *n = point->child; n && !status; n = n->next)
    status = vs_tree_graft(&scene->tree, n->key, n, err);
  if (!status) status = vs_scene_read_sections(scene, NULL, err);
  vs_scene_free(scene);
  free(scene);
  return status;
}

vs_status vs_design_cases_check(const vs_plan *plan, const vs_design_cases *c, vs_error *err) {
  vs_status status = VS_OK;
  for (const vs_node *p = c->points ? c->points->child : NULL; p; p = p->next)
    for (const vs_node *n = p->child; n && !status; n = n->next)
      for (size_t k = 0; k < plan->n_axes; k++)
        if (!strcmp(plan->axes[k].key, n->key) && !status)
          status = vs_error_keep(
              err,
              vs_fail_at(err, n->key_where,
                         "operation.%s: %s stands under %s already, which says it in each case",
                         p->key, n->key, plan->axes[k].by));
  for (const vs_node *p = c->points ? c->points->child : NULL; p && !status; p = p->next)
    status = vs_error_keep(err, try_point(plan, p, err));
  return status;
}

static uint64_t count_threats(const vs_plan *plan, const vs_design_cases *c) {
  return c->threats ? c->threats->method->count(plan, c->threats) : 0;
}

/* True if draws come to something that the list does not have: a continuous range, or a spread. */
static bool is_ranged(const vs_plan *plan, const vs_design_cases *c) {
  const vs_axis *axis[VS_PLAN_AXES];
  size_t n = 0;
  for (size_t which = 0; c->threats; which++)
    if ((n = c->threats->method->ranges(plan, c->threats, which, axis))) break;
  return n && n != SIZE_MAX;
}

void vs_design_cases_count(const vs_plan *plan, vs_design_cases *c) {
  const uint64_t threats = count_threats(plan, c);
  /* the scene as it is: the last of the threats, or the only case beside points of operation */
  c->count = c->n_points + (threats ? threats : 1);
  c->ranged = is_ranged(plan, c);
}

/* ---- cases ---- */

void vs_design_cases_point(const vs_plan *plan, const vs_design_cases *c, uint64_t number,
                           double *point) {
  const bool at_work = number < c->n_points;
  const uint64_t threats = count_threats(plan, c);
  if (c->n_points) point[c->axis] = at_work ? (double)(number + 1) : 0;
  if (!c->threats) return;
  double *own = point + c->threats->axis;
  if (number < c->count)
    c->threats->method->point(plan, c->threats, at_work ? threats - 1 : number - c->n_points, own);
  else
    c->threats->method->draw(plan, c->threats, number - c->count, own);
}

void vs_design_cases_put(const vs_plan *plan, const vs_design_cases *c, const double *point,
                         vs_tree *tree) {
  vs_error never = {0}; /* the keys go through no list */
  if (!c->n_points) return;
  for (size_t w = 1; w <= c->n_points; w++)
    for (const vs_node *n = point_named(c, w)->child; n; n = n->next)
      vs_tree_put_back(tree, &c->scene->tree, n->key);
  const vs_node *own = point_named(c, (size_t)point[c->axis]);
  /* a threat, or a spread, may say one of these keys itself, as run.until */
  if (!own && c->threats) c->threats->method->put(plan, c->threats, point + c->threats->axis, tree);
  for (const vs_node *n = own ? own->child : NULL; n; n = n->next)
    vs_tree_graft(tree, n->key, n, &never);
}

void vs_design_cases_write(const vs_plan *plan, const vs_design_cases *c, const double *point,
                           vs_text *text) {
  const size_t at_work = c->n_points ? (size_t)point[c->axis] : 0;
  if (at_work || !c->threats) {
    vs_text_add(text, "%s", at_work ? point_named(c, at_work)->key : "the scene as it is");
    return;
  }
  const char *between = "";
  for (size_t k = c->threats->axis; k < c->threats->axis + c->threats->n; k++) {
    const vs_axis *axis = &plan->axes[k];
    if (isnan(point[k])) continue;
    const bool name = k == c->threats->axis, spread = !strcmp(axis->by, "spread");
    vs_text_add(text, "%s%s%s", between,
                name     ? ""
                : spread ? axis->key
                         : axis->field->key,
                name ? "" : " ");
    between = name ? ": " : ", ";
    if (axis->about)
      vs_text_add(text, "%+.3g %%", 100 * (point[k] / axis->nominal - 1));
    else if (axis->is_word) {
      const char *word = axis->word[(size_t)point[k]];
      vs_text_add(text, "%s", name && !strcmp(word, "none") ? "no threat" : word);
    } else
      vs_text_add(text, "%.6g%s%s", point[k], *axis->unit ? " " : "", axis->unit);
  }
}
