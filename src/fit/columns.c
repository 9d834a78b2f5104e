/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/columns.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fit/unknown.h"
#include "base/units.h"

/* How a column of an instrument's ends. */
static const char ENDING[] = "_meas";

/* ---- the map in the fit file ---- */

static vs_status no_such_column(const vs_node *node, const vs_scene *scene, vs_error *err) {
  const char *names[VS_CH_MOST + VS_INSTRUMENT_MOST];
  int numbers[VS_CH_MOST], n = vs_channel_listed(&scene->frame, numbers);
  size_t length = strlen(node->key), ending = strlen(ENDING);
  for (int k = 0; k < n; k++) names[k] = vs_channel_at(&scene->frame, numbers[k]).name;
  if (!scene->instruments.count && length > ending && !strcmp(node->key + length - ending, ENDING))
    return vs_fail_at(err, node->key_where,
                      "columns: '%s' is an instrument's, and the scene has none; write "
                      "set: {instruments: {}} for the machine's own",
                      node->key);
  for (int k = 0; k < scene->instruments.count; k++) names[n++] = scene->instruments.item[k].column;
  const char *nearest = vs_text_nearest(node->key, names, (size_t)n);
  return vs_fail_at(err, node->key_where, "columns: a run on tier %s has no '%s'%s%s%s",
                    scene->tier->name, node->key, nearest ? "; did you mean '" : "",
                    nearest ? nearest : "", nearest ? "'?" : "; see 'vibrospice list probes'");
}

/* An A/D of the step s is off by anything up to s/2 either way: s/sqrt(12) in the root of the mean
 * square. A value half a step from its last code, or from its first, is that code's. */
static void take_instrument(vs_recorded *c, const vs_instrument *i) {
  double step = i->v.bits ? ldexp(i->v.range[1] - i->v.range[0], -i->v.bits) : 0;
  c->channel = i->channel;
  c->rate_hz = i->v.rate_hz;
  c->error = hypot(i->v.noise, step / sqrt(12));
  c->own = c->error > 0;
  if (!c->own) c->error = NAN;
  if (!i->v.bits) return;
  c->ends[0] = i->v.range[0] + step / 2;
  c->ends[1] = i->v.range[1] - 1.5 * step;
}

static vs_status find_quantity(vs_recorded *c, const vs_scene *scene, const vs_node *node,
                               vs_error *err) {
  snprintf(c->name, sizeof c->name, "%.250s", node->key);
  for (int k = 0; k < scene->instruments.count && c->instrument < 0; k++)
    if (!strcmp(node->key, scene->instruments.item[k].column)) c->instrument = k;
  if (c->instrument >= 0)
    take_instrument(c, &scene->instruments.item[c->instrument]);
  else
    c->channel = vs_channel_find(&scene->frame, node->key);
  if (c->channel < 0) return no_such_column(node, scene, err);
  c->unit = vs_channel_at(&scene->frame, c->channel).unit;
  c->si = vs_units_factor(c->unit);
  return VS_OK;
}

static vs_status read_error(vs_recorded *c, const vs_node *node, vs_error *err) {
  static const char *const KEYS[] = {"error"};
  bool relative = false;
  const vs_node *error = node;
  if (node->kind == VS_NODE_MAP) {
    vs_status status = vs_field_known_keys(node, node->key, KEYS, 1, err);
    if (status) return status;
    error = vs_tree_child(node, "error");
  }
  if (!error || (error->kind == VS_NODE_TEXT && !*error->text)) return VS_OK;
  c->own = false;
  vs_status status = vs_unknown_error(error, c->name, c->unit, &c->error, &relative, err);
  if (!status && relative && *c->unit)
    status = vs_fail_at(err, error->where,
                        "%s: a sample's error is an amount, in %s: a share of a value that passes "
                        "through 0 is none",
                        c->name, c->unit);
  return status;
}

vs_status vs_columns_read(vs_columns *all, const vs_node *map, const vs_scene *scene,
                          vs_error *err) {
  vs_status status = VS_OK;
  *all = (vs_columns){.item = vs_alloc(VS_COLUMNS_MOST, sizeof *all->item)};
  for (const vs_node *n = map->child; n && !status; n = n->next) {
    if (all->count == VS_COLUMNS_MOST)
      return vs_fail_at(err, n->key_where, "columns: more than %d", VS_COLUMNS_MOST);
    vs_recorded *c = &all->item[all->count++];
    *c = (vs_recorded){.channel = -1,
                       .instrument = -1,
                       .ends = {-INFINITY, INFINITY},
                       .where = n->key_where,
                       .error = NAN,
                       .cell = -1,
                       .cell_of_error = -1,
                       .last_s = -INFINITY};
    status = find_quantity(c, scene, n, err);
    if (!status) status = read_error(c, n, err);
  }
  return status;
}

void vs_columns_free(vs_columns *all) {
  free(all->item);
  vs_text_free(&all->unused);
}

/* ---- the header ---- */

/* Returns the factor to SI if the cell is the column `name` with a unit of that kind; NaN with
 * *named set: it has the name, and no such unit. "p_mm", "p [mm]"; a pure number: "p". */
static double factor_of(const char *cell, const char *name, const char *unit, bool *named) {
  size_t n = strlen(name);
  *named = false;
  if (strncmp(cell, name, n)) return NAN;
  const char *rest = cell + n + strspn(cell + n, " ");
  *named = !*rest || *rest == '[';
  if (!*rest) return *unit ? NAN : 1;
  if (*rest == '[') {
    char text[64], why[256];
    double si;
    int length = (int)strcspn(rest + 1, "]");
    snprintf(text, sizeof text, "1 %.*s", length < 40 ? length : 40, rest + 1);
    return vs_units_read(text, unit, &si, why, sizeof why) ? si : NAN;
  }
  return *rest == '_' && rest == cell + n ? vs_units_suffix_factor(rest + 1, unit) : NAN;
}

/* Finds the cell that holds the quantity; -1: there is none. */
static vs_status find_cell(const vs_csv *csv, const char *name, const char *unit, int *cell,
                           double *factor, vs_error *err) {
  *cell = -1;
  for (size_t k = 0; k < csv->count; k++) {
    bool named;
    double f = factor_of(csv->cell[k], name, unit, &named);
    if (isnan(f) && named)
      return vs_fail_at(err, csv->where[k],
                        "column '%s' has no unit of %s: name it as %s_%s or %s [%s]", csv->cell[k],
                        *unit ? unit : "a pure number", name, *unit ? unit : "", name, unit);
    if (isnan(f)) continue;
    if (*cell >= 0)
      return vs_fail_at(err, csv->where[k],
                        "column '%s': %s stands here a second time; leave one out", csv->cell[k],
                        name);
    *cell = (int)k;
    *factor = f;
  }
  return VS_OK;
}

/* Something may begin with the column's name, and what follows be no unit of its kind. */
static vs_status no_unit(const vs_recorded *c, const vs_csv *csv, vs_error *err) {
  size_t n = strlen(c->name);
  for (size_t k = 0; k < csv->count; k++)
    if (!strncmp(csv->cell[k], c->name, n) && !strncmp(csv->cell[k] + n, ENDING, strlen(ENDING)))
      return vs_fail_at(err, c->where,
                        "columns: %s has %s%s, which an instrument showed, and no %s; write %s%s, "
                        "with set: {instruments: {}} if the scene has none",
                        csv->file, c->name, ENDING, c->name, c->name, ENDING);
  for (size_t k = 0; k < csv->count; k++)
    if (!strncmp(csv->cell[k], c->name, n) && csv->cell[k][n] == '_' && (int)k != c->cell_of_error)
      return vs_fail_at(err, csv->where[k], "column '%s': '%s' is no unit of %s, in which %s is",
                        csv->cell[k], csv->cell[k] + n + 1, *c->unit ? c->unit : "a pure number",
                        c->name);
  const char *nearest = vs_text_nearest(c->name, (const char *const *)csv->cell, csv->count);
  return vs_fail_at(err, c->where, "columns: %s has no column %s with a unit of %s%s%s%s",
                    csv->file, c->name, *c->unit ? c->unit : "a pure number",
                    nearest ? "; there is '" : "", nearest ? nearest : "", nearest ? "'" : "");
}

static vs_status find_column(vs_recorded *c, const vs_csv *csv, vs_error *err) {
  char name[VS_NAME_SIZE + 16];
  vs_status status = find_cell(csv, c->name, c->unit, &c->cell, &c->factor, err);
  snprintf(name, sizeof name, "%s_error", c->name);
  if (!status) status = find_cell(csv, name, c->unit, &c->cell_of_error, &c->factor_of_error, err);
  if (status) return status;
  if (c->cell < 0) return no_unit(c, csv, err);
  if (isnan(c->error) && c->cell_of_error < 0)
    return vs_fail_at(err, c->where,
                      "%s has no error: write one in %s, or give the file a column %s_error_...",
                      c->name, *c->unit ? c->unit : "numbers", c->name);
  if (c->own && c->cell_of_error >= 0) c->own = false, c->error = NAN;
  if (!isnan(c->error)) c->cell_of_error = -1;
  return VS_OK;
}

static bool is_used(const vs_columns *all, int cell) {
  for (size_t k = 0; k < all->count; k++)
    if (all->item[k].cell == cell || all->item[k].cell_of_error == cell) return true;
  return false;
}

vs_status vs_columns_find(vs_columns *all, const vs_csv *csv, double *time_s, vs_error *err) {
  bool named;
  if (csv->count > VS_COLUMNS_CELLS)
    return vs_fail_at(err, csv->where[0], "more than %d columns", VS_COLUMNS_CELLS);
  *time_s = factor_of(csv->cell[0], "t", "s", &named);
  if (isnan(*time_s))
    return vs_fail_at(err, csv->where[0],
                      "the first column is the time with its unit: t_s, t_ms or t_us, not '%s'",
                      csv->cell[0]);
  vs_status status = VS_OK;
  for (size_t k = 0; k < all->count && !status; k++) status = find_column(&all->item[k], csv, err);
  for (size_t k = 1; k < csv->count && !status; k++)
    if (!is_used(all, (int)k))
      vs_text_add(&all->unused, "%s%s", all->unused.length ? ", " : "", csv->cell[k]);
  return status;
}
