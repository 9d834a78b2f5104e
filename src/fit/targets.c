/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/targets.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/units.h"
#include "fit/recording.h"
#include "fit/unknown.h"
#include "plant/coil.h"
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

/* ---- the coil's impedance ---- */

static double part_r(const double ohm[2], double omega) {
  (void)omega;
  return ohm[0];
}
static double part_x(const double ohm[2], double omega) {
  (void)omega;
  return ohm[1];
}
static double part_z(const double ohm[2], double omega) {
  (void)omega;
  return hypot(ohm[0], ohm[1]);
}
static double part_l(const double ohm[2], double omega) {
  return ohm[1] / omega;
}
static const struct part {
  const char *name, *unit;
  double (*of)(const double ohm[2], double omega);
} PARTS[] = {{"r", "ohm", part_r}, {"x", "ohm", part_x}, {"z", "ohm", part_z}, {"l", "H", part_l}};
enum { N_PARTS = sizeof PARTS / sizeof *PARTS };

/* What the header says: the unit of the frequency, and of each other column its part and unit. */
typedef struct spectrum_columns {
  double hz, factor[VS_COLUMNS_MOST];
  int part[VS_COLUMNS_MOST];
  size_t count;
} spectrum_columns;

static vs_status read_spectrum_header(const vs_csv *csv, spectrum_columns *c, vs_error *err) {
  bool named;
  c->count = csv->count;
  c->hz = vs_recording_factor(csv->cell[0], "f", "Hz", &named);
  if (isnan(c->hz) || csv->count < 2 || csv->count > VS_COLUMNS_MOST)
    return vs_fail_at(err, csv->where[0],
                      "the first column is the frequency with its unit, f_hz, and others follow: "
                      "r_ohm, x_ohm, z_ohm, l_H");
  for (size_t k = 1; k < csv->count; k++) {
    c->part[k] = -1;
    for (int p = 0; p < N_PARTS && c->part[k] < 0; p++) {
      c->factor[k] = vs_recording_factor(csv->cell[k], PARTS[p].name, PARTS[p].unit, &named);
      if (!isnan(c->factor[k])) c->part[k] = p;
    }
    if (c->part[k] < 0)
      return vs_fail_at(err, csv->where[k],
                        "column '%s' is no part of an impedance with its unit; there are r_ohm, "
                        "x_ohm, z_ohm and l_H",
                        csv->cell[k]);
  }
  return VS_OK;
}

static vs_status read_spectrum_row(vs_targets *aims, const vs_csv *csv, const spectrum_columns *c,
                                   double error, vs_error *err) {
  double hz, value;
  if (csv->count != c->count)
    return vs_fail_at(err, csv->where[0], "%zu cells, and the header has %zu", csv->count,
                      c->count);
  vs_status status = vs_recording_number(csv, 0, &hz, err);
  if (!status && !(hz * c->hz > 0))
    status = vs_fail_at(err, csv->where[0], "a frequency is above 0");
  for (size_t k = 1; k < csv->count && !status; k++) {
    status = vs_recording_number(csv, k, &value, err);
    if (!status && value == 0)
      status = vs_fail_at(err, csv->where[k], "a share of 0 is no error; leave the row out");
    if (status) return status;
    const struct part *part = &PARTS[c->part[k]];
    aims->item = vs_resize(aims->item, aims->count + 1, sizeof *aims->item);
    vs_target *aim = &aims->item[aims->count++];
    *aim = (vs_target){.where = csv->where[k],
                       .value = value * c->factor[k],
                       .error = error,
                       .relative = true,
                       .place = -1,
                       .at_hz = hz * c->hz,
                       .part = c->part[k]};
    snprintf(aim->name, sizeof aim->name, "%s at %.6g Hz", part->name, aim->at_hz);
    snprintf(aim->unit, sizeof aim->unit, "%s", part->unit);
  }
  return status;
}

static vs_status read_spectrum(vs_targets *aims, const char *path, double error, vs_error *err) {
  vs_csv csv = {.file = path, .trim = true, .comments = true, .guess = true};
  spectrum_columns columns = {0};
  FILE *file = csv.stream = fopen(path, "r");
  if (!file) return vs_fail(err, VS_INPUT, "%s: cannot be opened", path);
  vs_status status = vs_csv_next(&csv, err);
  if (!status && !csv.count) status = vs_fail(err, VS_INPUT, "%s: has no header", path);
  if (!status) status = read_spectrum_header(&csv, &columns, err);
  const size_t before = aims->count;
  while (!status && !(status = vs_csv_next(&csv, err)) && csv.count)
    status = read_spectrum_row(aims, &csv, &columns, error, err);
  if (!status && aims->count == before)
    status = vs_fail(err, VS_INPUT, "%s: has no row below its header", path);
  vs_csv_free(&csv);
  fclose(file);
  return status;
}

vs_status vs_targets_read_impedance(vs_targets *aims, const vs_node *map, const char *beside,
                                    vs_error *err) {
  static const char *const KEYS[] = {"file", "error"};
  char path[VS_PATH_SIZE];
  double error;
  bool relative;
  if (map->kind != VS_NODE_MAP || !vs_tree_child(map, "error"))
    return vs_fail_at(err, map->where, "impedance: {file: z.csv, error: 2 %%} is wanted");
  const vs_node *of = vs_tree_child(map, "error");
  vs_status status = vs_field_known_keys(map, "impedance", KEYS, 2, err);
  if (!status) status = vs_unknown_error(of, "impedance", "ohm", &error, &relative, err);
  if (!status && !relative)
    status = vs_fail_at(err, of->where, "impedance: an error in per cent is wanted");
  if (!status)
    status = vs_recording_file(path, "impedance", vs_tree_child(map, "file"), beside, err);
  return status ? status : read_spectrum(aims, path, error, err);
}

bool vs_targets_rest(const vs_targets *aims) {
  for (size_t k = 0; k < aims->count; k++)
    if (aims->item[k].place >= 0) return false;
  return aims->count > 0;
}

/* ---- what a run gave ---- */

vs_status vs_target_computed(const vs_target *aim, const vs_scene *scene,
                             const vs_measured *measured, double *value, vs_error *err) {
  vs_measured_value m;
  vs_mode working;
  if (aim->at_hz > 0) {
    const vs_setup *setup = &scene->setup;
    const double omega = 2 * M_PI * aim->at_hz;
    double ohm[2];
    vs_coil_impedance(&setup->model.coil, vs_mechanics_gap(&setup->model, setup->start.x), omega,
                      ohm);
    *value = PARTS[aim->part].of(ohm, omega);
    return VS_OK;
  }
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
