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

/* ---- the core's losses ---- */

/* What the map says beside its file; hysteresis: NaN, the frequencies are to tell. */
typedef struct core {
  double mass_kg, area_m2, turns, error, hysteresis;
} core;
/* A row of the sheet. */
typedef struct loss_row {
  double hz, tesla, w_kg;
  vs_where where;
} loss_row;

static vs_status read_positive(const vs_node *map, const char *key, const char *unit, double *si,
                               vs_error *err) {
  const vs_node *node = vs_tree_child(map, key);
  char why[256] = "one value is wanted";
  if (!node) return vs_fail_at(err, map->where, "core_loss: '%s' is missing", key);
  if (node->kind != VS_NODE_TEXT || !vs_units_read(node->text, unit, si, why, sizeof why))
    return vs_fail_at(err, node->where, "core_loss.%s: %s", key, why);
  return *si > 0 ? VS_OK : vs_fail_at(err, node->where, "core_loss.%s: above 0 is wanted", key);
}

static vs_status read_core(const vs_node *map, core *c, vs_error *err) {
  static const char *const KEYS[] = {"file", "error", "mass", "area", "turns", "hysteresis"};
  const vs_node *error = vs_tree_child(map, "error"), *share = vs_tree_child(map, "hysteresis");
  char why[256] = "a share is wanted";
  bool relative;
  *c = (core){.hysteresis = NAN};
  if (map->kind != VS_NODE_MAP || !error)
    return vs_fail_at(err, map->where,
                      "core_loss: {file: sheet.csv, mass: 1 kg, area: 10 cm2, turns: 500, error: "
                      "5 %%} is wanted");
  vs_status status = vs_field_known_keys(map, "core_loss", KEYS, 6, err);
  if (!status) status = read_positive(map, "mass", "kg", &c->mass_kg, err);
  if (!status) status = read_positive(map, "area", "m2", &c->area_m2, err);
  if (!status) status = read_positive(map, "turns", "", &c->turns, err);
  if (!status) status = vs_unknown_error(error, "core_loss", "W/kg", &c->error, &relative, err);
  if (!status && !relative)
    status = vs_fail_at(err, error->where, "core_loss: an error in per cent is wanted");
  if (status || !share) return status;
  if (share->kind != VS_NODE_TEXT ||
      !vs_units_read(share->text, "%", &c->hysteresis, why, sizeof why))
    return vs_fail_at(err, share->where, "core_loss.hysteresis: %s", why);
  return c->hysteresis >= 0 && c->hysteresis < 1
             ? VS_OK
             : vs_fail_at(err, share->where,
                          "core_loss.hysteresis: 0 %% to below 100 %% is wanted");
}

static vs_status read_loss_row(const vs_csv *csv, const double factor[3], loss_row *row,
                               vs_error *err) {
  double v[3] = {0};
  vs_status status = VS_OK;
  if (csv->count != 3)
    return vs_fail_at(err, csv->where[0], "%zu cells, and the header has 3", csv->count);
  for (size_t k = 0; k < 3 && !status; k++) {
    status = vs_recording_number(csv, k, &v[k], err);
    v[k] *= factor[k];
    if (!status && !(v[k] > 0)) status = vs_fail_at(err, csv->where[k], "above 0 is wanted");
  }
  *row = (loss_row){v[0], v[1], v[2], csv->where[0]};
  return status;
}

/* The sheet's rows; the caller frees *rows even after an error. */
static vs_status read_sheet(const char *path, loss_row **rows, size_t *count, vs_error *err) {
  static const char *const NAMES[] = {"f", "b", "loss"}, *const UNITS[] = {"Hz", "T", "W/kg"};
  vs_csv csv = {.file = path, .trim = true, .comments = true, .guess = true};
  double factor[3] = {NAN, NAN, NAN};
  bool named;
  FILE *file = csv.stream = fopen(path, "r");
  if (!file) return vs_fail(err, VS_INPUT, "%s: cannot be opened", path);
  vs_status status = vs_csv_next(&csv, err);
  for (size_t k = 0; k < 3 && csv.count == 3; k++)
    factor[k] = vs_recording_factor(csv.cell[k], NAMES[k], UNITS[k], &named);
  if (!status && !(factor[0] * factor[1] * factor[2] > 0))
    status = vs_fail(err, VS_INPUT, "%s:1:1: the columns f_hz,b_t,loss_w_kg are wanted", path);
  while (!status && !(status = vs_csv_next(&csv, err)) && csv.count) {
    *rows = vs_resize(*rows, *count + 1, sizeof **rows);
    status = read_loss_row(&csv, factor, &(*rows)[(*count)++], err);
  }
  if (!status && !*count) status = vs_fail(err, VS_INPUT, "%s: has no row below its header", path);
  vs_csv_free(&csv);
  fclose(file);
  return status;
}

/* The row before this one with its flux density and the lowest frequency; NULL: there is none. */
static const loss_row *lowest(const loss_row *rows, size_t count, const loss_row *of) {
  const loss_row *found = NULL;
  for (const loss_row *r = rows; r < rows + count; r++)
    if (r != of && r->tesla == of->tesla && r->hz < of->hz && (!found || r->hz < found->hz))
      found = r;
  return found;
}
static bool has_another(const loss_row *rows, size_t count, const loss_row *of) {
  for (const loss_row *r = rows; r < rows + count; r++)
    if (r->tesla == of->tesla && r->hz != of->hz) return true;
  return false;
}

/* With a share: the loss that it leaves, W. Else the loss in a cycle, J, above that at the lowest
 * frequency, whose own row is none. */
static void add_loss(vs_targets *aims, const core *c, const loss_row *row, const loss_row *low) {
  const bool shared = !isnan(c->hysteresis);
  const double j = c->mass_kg * row->w_kg / row->hz,
               low_j = low ? c->mass_kg * low->w_kg / low->hz : 0;
  aims->item = vs_resize(aims->item, aims->count + 1, sizeof *aims->item);
  vs_target *aim = &aims->item[aims->count++];
  *aim = (vs_target){.where = row->where,
                     .value = shared ? c->mass_kg * row->w_kg * (1 - c->hysteresis) : j - low_j,
                     .error = shared ? c->error : c->error * hypot(j, low_j),
                     .relative = shared,
                     .place = -1,
                     .at_hz = row->hz,
                     .flux_wb = c->turns * c->area_m2 * row->tesla,
                     .from_hz = shared ? 0 : low->hz};
  snprintf(aim->name, sizeof aim->name, "core loss%s at %.6g Hz, %.6g T",
           shared ? "" : " in a cycle", row->hz, row->tesla);
  snprintf(aim->unit, sizeof aim->unit, "%s", shared ? "W" : "J");
}

/* Error: a row before this one has its frequency and flux density, and may say another loss. */
static vs_status check_row_is_new(const loss_row *rows, const loss_row *of, vs_error *err) {
  for (const loss_row *r = rows; r < of; r++)
    if (r->hz == of->hz && r->tesla == of->tesla)
      return vs_fail_at(err, of->where,
                        "%.6g Hz and %.6g T stand in line %d already; leave one of the two out",
                        of->hz, of->tesla, r->where.line);
  return VS_OK;
}

vs_status vs_targets_read_core_loss(vs_targets *aims, const vs_node *map, const char *beside,
                                    vs_error *err) {
  char path[VS_PATH_SIZE];
  core c;
  loss_row *rows = NULL;
  size_t count = 0;
  vs_status status = read_core(map, &c, err);
  if (!status)
    status = vs_recording_file(path, "core_loss", vs_tree_child(map, "file"), beside, err);
  if (!status) status = read_sheet(path, &rows, &count, err);
  for (const loss_row *r = rows; r < rows + count && !status; r++) {
    const loss_row *low = isnan(c.hysteresis) ? lowest(rows, count, r) : NULL;
    status = check_row_is_new(rows, r, err);
    if (!status && isnan(c.hysteresis) && !has_another(rows, count, r))
      status = vs_fail_at(err, r->where,
                          "%.6g T at one frequency alone does not tell which part of the loss is "
                          "hysteresis, which the secondaries have not; add a row at another "
                          "frequency, or core_loss.hysteresis: 70 %%",
                          r->tesla);
    else if (!status && (low || !isnan(c.hysteresis)))
      add_loss(aims, &c, r, low);
  }
  free(rows);
  return status;
}

static double loss_computed(const vs_target *aim, const vs_coil *coil) {
  const double w = vs_coil_core_loss(coil, aim->flux_wb, 2 * M_PI * aim->at_hz);
  if (!(aim->from_hz > 0)) return w;
  return w / aim->at_hz -
         vs_coil_core_loss(coil, aim->flux_wb, 2 * M_PI * aim->from_hz) / aim->from_hz;
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
  if (aim->flux_wb > 0) {
    *value = loss_computed(aim, &scene->setup.model.coil);
    return VS_OK;
  }
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
