/* SPDX-License-Identifier: GPL-3.0-or-later
 * What stands under sensitivity: each case of the study, of which there may be one alone, gets the
 * logarithmic derivatives of its measures with respect to keys as columns, and their errors
 * (orbit/sensitivity.h). In a study with `steady` they are those of the orbit.
 *
 *   sensitivity:
 *     of: [p_min, power_in]                        or one measure
 *     to: [firing.angle, actuator.gap]             or one key
 */
#include "study/methods.h"

#include <stdlib.h>

#include "report_columns.h"

enum { MOST = VS_PLAN_REPORT / 2 };

/* The order, and the names it is made of, which belong to the study's tree. */
typedef struct derivatives {
  vs_asked of[MOST], to[MOST];
  vs_sensitivity_order order;
} derivatives;

static const vs_inside NAMES = {.rows = VS_ROWS({.kind = VS_TEXT})};
static const vs_inside KEYS = {
    .rows = VS_ROWS({"of", VS_NEEDED | VS_TEXT | VS_LIST, .inside = &NAMES},
                    {"to", VS_NEEDED | VS_TEXT | VS_LIST, .inside = &NAMES})};
static const vs_field SENSITIVITY = {"sensitivity", VS_MAP, .inside = &KEYS};

/* Reads one name or a list of them. */
static vs_status read_names(const vs_node *section, const char *key, vs_asked names[MOST],
                            size_t *count, vs_error *err) {
  const vs_node *node = vs_tree_child(section, key);
  const vs_node *item = node && node->kind == VS_NODE_LIST ? node->child : node;
  for (*count = 0; item; item = node->kind == VS_NODE_LIST ? item->next : NULL) {
    if (item->kind != VS_NODE_TEXT || !*item->text || *count == MOST)
      return vs_fail_at(err, item->where, "sensitivity.%s: up to %d names are wanted", key, MOST);
    names[(*count)++] = (vs_asked){item->text, item->where};
  }
  if (*count) return VS_OK;
  return vs_fail_at(err, node ? node->where : section->where,
                    "sensitivity: {of: [MEASURE, ...], to: [KEY, ...]} is wanted");
}

static vs_status read_derivatives(vs_plan *plan, const vs_node *section, void **state,
                                  vs_error *err) {
  derivatives *d = *state = vs_alloc(1, sizeof *d);
  d->order = (vs_sensitivity_order){.of = d->of, .to = d->to, .periods = plan->periods};
  vs_status status = vs_field_map_keys(section, "sensitivity", &KEYS, err);
  if (!status) status = read_names(section, "of", d->of, &d->order.n_of, err);
  if (!status) status = read_names(section, "to", d->to, &d->order.n_to, err);
  if (!status) status = vs_sensitivity_check(plan->base, &d->order, err);
  return status ? status : vs_report_columns_derive(plan, &d->order, section->where, err);
}

static uint64_t count_one(const vs_plan *plan, const vs_plan_stage *stage) {
  (void)plan, (void)stage;
  return 1;
}

static void no_axis(const vs_plan *plan, const vs_plan_stage *stage, uint64_t index,
                    double *value) {
  (void)plan, (void)stage, (void)index, (void)value;
}

const vs_method vs_derivative_method = {
    .name = "sensitivity",
    .key = "sensitivity",
    .keys = &SENSITIVITY,
    .text = "no cases of its own: derivatives of each case's measures to keys, as columns",
    .read = read_derivatives,
    .free = free,
    .count = count_one,
    .point = no_axis};
