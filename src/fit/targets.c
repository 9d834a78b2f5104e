/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/targets.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "fit/unknown.h"
#include "plant/mechanics.h"

/* ---- measures of the machine at rest ---- */

static double working_frequency(const vs_mode *mode) {
  return fabs(mode->im_rad_s) / (2 * M_PI);
}

static double working_decay(const vs_mode *mode) {
  return mode->time_constant_s;
}

static const struct at_rest {
  const char *name, *unit, *text;
  double (*of)(const vs_mode *mode);
} AT_REST[] = {{"working_frequency", "Hz", "of the free swing that the force drives hardest",
                working_frequency},
               {"working_decay", "s", "time in which that swing decays to 1/e", working_decay}};
enum { N_AT_REST = sizeof AT_REST / sizeof *AT_REST };

static const struct at_rest *find_at_rest(const char *name) {
  for (size_t k = 0; k < N_AT_REST; k++)
    if (!strcmp(name, AT_REST[k].name)) return &AT_REST[k];
  return NULL;
}

void vs_target_explain(vs_text *help) {
  for (size_t k = 0; k < N_AT_REST; k++)
    vs_text_add(help, "  %-18s %-3s %s\n", AT_REST[k].name, AT_REST[k].unit, AT_REST[k].text);
}

/* The mode that the force drives hardest. */
static bool find_working(const vs_model *model, vs_mode *working) {
  vs_mode modes[VS_MOST_STATES];
  if (!vs_mechanics_modes(model, modes)) return false;
  *working = modes[0];
  for (int m = 1; m < 2 * model->dof; m++)
    if (modes[m].drive > working->drive) *working = modes[m];
  return true;
}

/* ---- reading ---- */

/* All measures that there are. */
typedef struct measures {
  vs_measured_value *all;
  const char **names;
  size_t count;
} measures;

static measures all_measures(const vs_scene *scene, int periods) {
  enum { MOST = 1024 };
  const vs_orbit none = {0};
  measures m = {vs_alloc(MOST, sizeof *m.all), vs_alloc(MOST + N_AT_REST, sizeof *m.names), 0};
  vs_measured *empty = vs_alloc(1, sizeof *empty);
  vs_measured_begin(empty, scene, periods ? &none : NULL);
  empty->steady.devices = empty->result.watchers.devices;
  while (m.count < MOST && vs_measured_at(empty, (int)m.count, &m.all[m.count])) {
    m.names[m.count] = m.all[m.count].name;
    m.count++;
  }
  vs_measured_free(empty);
  free(empty);
  for (size_t k = 0; k < N_AT_REST; k++) m.names[m.count + k] = AT_REST[k].name;
  return m;
}

static vs_status find_measure(const measures *m, const vs_scene *scene, const vs_node *node,
                              vs_target *aim, vs_error *err) {
  const struct at_rest *rest = find_at_rest(node->key);
  aim->where = node->key_where;
  aim->place = -1;
  if (rest) {
    snprintf(aim->name, sizeof aim->name, "%s", rest->name);
    snprintf(aim->unit, sizeof aim->unit, "%s", rest->unit);
    return VS_OK;
  }
  for (size_t k = 0; k < m->count && aim->place < 0; k++)
    if (!strcmp(m->names[k], node->key)) aim->place = (int)k;
  if (aim->place >= 0) {
    snprintf(aim->name, sizeof aim->name, "%s", m->all[aim->place].name);
    snprintf(aim->unit, sizeof aim->unit, "%s", m->all[aim->place].unit);
    return VS_OK;
  }
  return vs_fail_at(
      err, node->key_where, "measures: no measure '%s' on tier %s%s", node->key, scene->tier->name,
      vs_text_hint(node->key, m->names, m->count + N_AT_REST, "; see 'vibrospice list measures'")
          .text);
}

static vs_status read_aim(vs_target *aim, const vs_node *node, vs_error *err) {
  static const char *const KEYS[] = {"value", "error"};
  char why[256];
  const vs_node *value = vs_tree_child(node, "value"), *error = vs_tree_child(node, "error");
  if (node->kind != VS_NODE_MAP || !value || !error)
    return vs_fail_at(err, node->where, "%s: {value: 1 %s, error: 3 %%} is wanted", aim->name,
                      aim->unit);
  vs_status status = vs_field_known_keys(node, aim->name, KEYS, 2, err);
  if (status) return status;
  if (value->kind != VS_NODE_TEXT ||
      !vs_units_read(value->text, aim->unit, &aim->value, why, sizeof why))
    return vs_fail_at(err, value->where, "%s: %s", aim->name,
                      value->kind == VS_NODE_TEXT ? why : "one value is wanted");
  status = vs_unknown_error(error, aim->name, aim->unit, &aim->error, &aim->relative, err);
  if (!status && aim->relative && aim->value == 0)
    status = vs_fail_at(err, error->where, "%s: a share of 0 is no error; write an amount in %s",
                        aim->name, aim->unit);
  return status;
}

vs_status vs_targets_read(vs_targets *aims, const vs_node *map, const vs_scene *scene, int periods,
                          vs_error *err) {
  *aims = (vs_targets){0};
  if (map->kind != VS_NODE_MAP || !map->child)
    return vs_fail_at(err, map->where,
                      "measures: a map is wanted: {i_peak: {value: 0.95 A, error: 3 %%}, ...}");
  size_t room = 0;
  for (const vs_node *n = map->child; n; n = n->next) room++;
  aims->item = vs_alloc(room, sizeof *aims->item);
  measures m = all_measures(scene, periods);
  vs_status status = VS_OK;
  for (const vs_node *n = map->child; n && !status; n = n->next) {
    vs_target *aim = &aims->item[aims->count++];
    status = find_measure(&m, scene, n, aim, err);
    if (!status) status = read_aim(aim, n, err);
  }
  free(m.all);
  free(m.names);
  return status;
}

/* ---- what a run gave ---- */

vs_status vs_target_computed(const vs_target *aim, const vs_scene *scene,
                             const vs_measured *measured, double *value, vs_error *err) {
  vs_measured_value m;
  vs_mode working;
  if (aim->place < 0) {
    if (!find_working(&scene->setup.model, &working))
      return vs_fail(err, VS_RUN, "%s: the modes of the machine cannot be found", aim->name);
    *value = find_at_rest(aim->name)->of(&working);
    return VS_OK;
  }
  bool there = vs_measured_at(measured, aim->place, &m) && m.value.known;
  if (!there || !isfinite(m.value.value))
    return vs_fail(err, VS_RUN, "the %s has no %s", measured->period ? "orbit" : "run", aim->name);
  *value = m.value.value * vs_units_factor(aim->unit);
  return VS_OK;
}
