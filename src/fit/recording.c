/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/recording.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/csv.h"
#include "fit/unknown.h"
#include "syntax/units.h"

enum { MOST_SAMPLES = 1000000, MOST_CELLS = 512, MOST_COLUMNS = 64 };

/* ---- the map in the fit file ---- */

static vs_status read_column(vs_recorded *c, const vs_scene *scene, const vs_node *node,
                             vs_error *err) {
  static const char *const KEYS[] = {"error"};
  bool relative = false;
  *c = (vs_recorded){.channel = vs_channel_find(&scene->frame, node->key),
                     .where = node->key_where,
                     .error = NAN,
                     .cell = -1,
                     .cell_of_error = -1};
  snprintf(c->name, sizeof c->name, "%.250s", node->key);
  if (c->channel < 0) {
    const char *names[VS_CH_MOST];
    int numbers[VS_CH_MOST], n = vs_channel_listed(&scene->frame, numbers);
    for (int k = 0; k < n; k++) names[k] = vs_channel_at(&scene->frame, numbers[k]).name;
    const char *nearest = vs_text_nearest(node->key, names, (size_t)n);
    return vs_fail_at(err, node->key_where, "columns: a run on tier %s has no '%s'%s%s%s",
                      scene->tier->name, node->key, nearest ? "; did you mean '" : "",
                      nearest ? nearest : "", nearest ? "'?" : "; see 'vibrospice list probes'");
  }
  c->unit = vs_channel_at(&scene->frame, c->channel).unit;
  const vs_node *error = node;
  if (node->kind == VS_NODE_MAP) {
    vs_status status = vs_field_known_keys(node, node->key, KEYS, 1, err);
    if (status) return status;
    error = vs_tree_child(node, "error");
  }
  if (!error || (error->kind == VS_NODE_TEXT && !*error->text)) return VS_OK;
  vs_status status = vs_unknown_error(error, c->name, c->unit, &c->error, &relative, err);
  if (!status && relative && *c->unit)
    status = vs_fail_at(err, error->where,
                        "%s: a sample's error is an amount, in %s: a share of a value that passes "
                        "through 0 is none",
                        c->name, c->unit);
  return status;
}

static vs_status read_columns(vs_recording *r, const vs_scene *scene, const vs_node *map,
                              vs_error *err) {
  vs_status status = VS_OK;
  r->columns = vs_alloc(MOST_COLUMNS, sizeof *r->columns);
  for (const vs_node *n = map->child; n && !status; n = n->next) {
    if (r->n_columns == MOST_COLUMNS)
      return vs_fail_at(err, n->key_where, "columns: more than %d", MOST_COLUMNS);
    status = read_column(&r->columns[r->n_columns++], scene, n, err);
  }
  return status;
}

static vs_status read_time(const vs_node *map, const char *key, double *t_s, vs_error *err) {
  char why[256];
  const vs_node *node = vs_tree_child(map, key);
  if (!node) return VS_OK;
  if (node->kind == VS_NODE_TEXT && vs_units_read(node->text, "s", t_s, why, sizeof why))
    return VS_OK;
  return vs_fail_at(err, node->where, "%s: %s", key,
                    node->kind == VS_NODE_TEXT ? why : "a time is wanted, as 5 ms");
}

/* Beside the fit file, or as it stands. */
static vs_status find_file(vs_recording *r, const vs_node *file, const char *beside,
                           vs_error *err) {
  const char *slash = strrchr(beside, '/');
  if (!file || file->kind != VS_NODE_TEXT || !*file->text)
    return vs_fail_at(err, file ? file->where : (vs_where){.file = beside},
                      "data: file: the name of a CSV file is wanted");
  snprintf(r->path, sizeof r->path, "%.*s%s",
           slash && *file->text != '/' ? (int)(slash - beside + 1) : 0, beside, file->text);
  if (access(r->path, R_OK) && !access(file->text, R_OK))
    snprintf(r->path, sizeof r->path, "%s", file->text);
  struct stat s;
  if (!stat(r->path, &s) && S_ISREG(s.st_mode) && !access(r->path, R_OK)) return VS_OK;
  return vs_fail_at(err, file->where, "data: file: %s cannot be opened: %s", r->path,
                    access(r->path, R_OK) ? strerror(errno) : "not a plain file");
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
      return vs_fail_at(err, csv->where[k], "column '%s': %s stands here a second time",
                        csv->cell[k], name);
    *cell = (int)k;
    *factor = f;
  }
  return VS_OK;
}

static vs_status find_column(vs_recording *r, vs_recorded *c, const vs_csv *csv, vs_error *err) {
  char name[VS_NAME_SIZE + 16];
  vs_status status = find_cell(csv, c->name, c->unit, &c->cell, &c->factor, err);
  snprintf(name, sizeof name, "%s_error", c->name);
  if (!status) status = find_cell(csv, name, c->unit, &c->cell_of_error, &c->factor_of_error, err);
  if (status) return status;
  for (size_t k = 0, n = strlen(c->name); k < csv->count && c->cell < 0; k++)
    if (!strncmp(csv->cell[k], c->name, n) && csv->cell[k][n] == '_' && (int)k != c->cell_of_error)
      return vs_fail_at(err, csv->where[k], "column '%s': '%s' is no unit of %s, in which %s is",
                        csv->cell[k], csv->cell[k] + n + 1, *c->unit ? c->unit : "a pure number",
                        c->name);
  if (c->cell < 0) {
    const char *nearest = vs_text_nearest(c->name, (const char *const *)csv->cell, csv->count);
    return vs_fail_at(err, c->where, "columns: %s has no column %s with a unit of %s%s%s%s",
                      r->path, c->name, *c->unit ? c->unit : "a pure number",
                      nearest ? "; there is '" : "", nearest ? nearest : "", nearest ? "'" : "");
  }
  if (isnan(c->error) && c->cell_of_error < 0)
    return vs_fail_at(err, c->where,
                      "%s has no error: write one in %s, or give the file a column %s_error_...",
                      c->name, *c->unit ? c->unit : "numbers", c->name);
  if (!isnan(c->error)) c->cell_of_error = -1;
  return VS_OK;
}

static bool is_used(const vs_recording *r, int cell) {
  for (size_t k = 0; k < r->n_columns; k++)
    if (r->columns[k].cell == cell || r->columns[k].cell_of_error == cell) return true;
  return false;
}

static vs_status read_header(vs_recording *r, const vs_csv *csv, double *time_s, vs_error *err) {
  bool named;
  if (csv->count > MOST_CELLS)
    return vs_fail_at(err, csv->where[0], "more than %d columns", MOST_CELLS);
  *time_s = factor_of(csv->cell[0], "t", "s", &named);
  if (isnan(*time_s))
    return vs_fail_at(err, csv->where[0],
                      "the first column is the time with its unit: t_s, t_ms or t_us, not '%s'",
                      csv->cell[0]);
  vs_status status = VS_OK;
  for (size_t k = 0; k < r->n_columns && !status; k++)
    status = find_column(r, &r->columns[k], csv, err);
  for (size_t k = 1; k < csv->count && !status; k++)
    if (!is_used(r, (int)k))
      vs_text_add(&r->unused, "%s%s", r->unused.length ? ", " : "", csv->cell[k]);
  return status;
}

/* ---- the rows ---- */

/* A file that is being read. */
typedef struct rows {
  vs_recording *r;
  vs_csv csv;
  size_t columns;  /* of the header; 0: it is not read yet */
  double time_s;   /* unit of the first column */
  double before_s; /* time of the row before */
  double until_s;  /* where the run ends */
} rows;

static vs_status read_number(const vs_csv *csv, size_t cell, double *value, vs_error *err) {
  const char *text = csv->cell[cell];
  char *end;
  *value = text[strspn(text, "0123456789+-.eE")] ? NAN : strtod(text, &end);
  if (isfinite(*value) && *text && !*end) return VS_OK;
  return vs_fail_at(err, csv->where[cell], "'%s' is not a finite number", text);
}

static vs_status read_sample(vs_recording *r, size_t column, const vs_csv *csv, double t_s,
                             vs_error *err) {
  vs_recorded *c = &r->columns[column];
  const size_t cell = (size_t)c->cell;
  vs_sample sample = {.column = (int)column,
                      .t_s = t_s,
                      .error = c->error,
                      .where = {r->path, csv->where[cell].line, csv->where[cell].column}};
  if (!*csv->cell[cell]) {
    r->empty++;
    return VS_OK;
  }
  vs_status status = read_number(csv, cell, &sample.value, err);
  if (!status && c->cell_of_error >= 0) {
    const size_t of_error = (size_t)c->cell_of_error;
    status = read_number(csv, of_error, &sample.error, err);
    sample.error *= c->factor_of_error;
    if (!status && !(sample.error > 0))
      status = vs_fail_at(err, csv->where[of_error], "the error '%s' is not above 0",
                          csv->cell[of_error]);
  }
  if (status) return status;
  if (r->n_samples == MOST_SAMPLES)
    return vs_fail_at(err, csv->where[cell], "more than %d samples; take fewer by from and to",
                      MOST_SAMPLES);
  sample.value *= c->factor;
  if (!(r->n_samples & (r->n_samples - 1))) {
    size_t room = r->n_samples ? 2 * r->n_samples : 1;
    r->samples = realloc(r->samples, room * sizeof *r->samples);
    if (!r->samples) vs_out_of_memory();
  }
  r->samples[r->n_samples++] = sample;
  c->samples++;
  return VS_OK;
}

static vs_status read_row(rows *f, vs_error *err) {
  vs_recording *r = f->r;
  const vs_where where = f->csv.where[0];
  double t;
  if (f->csv.count != f->columns)
    return vs_fail_at(err, where, "cells in this row: %zu; columns in the header: %zu",
                      f->csv.count, f->columns);
  vs_status status = read_number(&f->csv, 0, &t, err);
  if (status) return status;
  double t_s = t * f->time_s;
  if (t_s <= f->before_s)
    return vs_fail_at(err, where, "the time does not rise: %.9g s after %.9g s", t_s, f->before_s);
  f->before_s = t_s;
  if (t_s < r->from_s || t_s > r->to_s) {
    r->outside++;
    return VS_OK;
  }
  if (t_s < 0 || t_s > f->until_s * (1 + 1e-12))
    return vs_fail_at(err, where,
                      "%.9g s lies outside of the run, which is 0 to %.9g s: alter run.until, or "
                      "leave it out by from and to",
                      t_s, f->until_s);
  for (size_t k = 0; k < r->n_columns && !status; k++)
    status = read_sample(r, k, &f->csv, fmin(t_s, f->until_s), err);
  return status;
}

static vs_status read_rows(rows *f, vs_error *err) {
  vs_recording *r = f->r;
  vs_status status = VS_OK;
  while (!status && !(status = vs_csv_next(&f->csv, err)) && f->csv.count) {
    if (f->columns) {
      status = read_row(f, err);
    } else {
      f->columns = f->csv.count;
      status = read_header(r, &f->csv, &f->time_s, err);
    }
  }
  vs_where end = {r->path, f->csv.line, 1};
  if (!status && !r->n_samples)
    status = vs_fail_at(err, end, f->columns ? "no sample is left to fit" : "the file is empty");
  for (size_t k = 0; k < r->n_columns && !status; k++)
    if (!r->columns[k].samples)
      status =
          vs_fail_at(err, r->columns[k].where, "%s: no sample is left to fit", r->columns[k].name);
  return status;
}

/* ---- all of it ---- */

vs_status vs_recording_read(vs_recording *r, const vs_node *data, const char *beside,
                            const vs_scene *scene, vs_error *err) {
  static const char *const KEYS[] = {"file", "columns", "from", "to"};
  const vs_node *columns = vs_tree_child(data, "columns");
  *r = (vs_recording){.from_s = -INFINITY, .to_s = INFINITY};
  if (data->kind != VS_NODE_MAP)
    return vs_fail_at(err, data->where,
                      "data: a map is wanted: {file: NAME.csv, columns: {p: 4 um}}");
  vs_status status = vs_field_known_keys(data, "data", KEYS, 4, err);
  if (!status) status = find_file(r, vs_tree_child(data, "file"), beside, err);
  if (!status && (!columns || columns->kind != VS_NODE_MAP || !columns->child))
    status = vs_fail_at(err, columns ? columns->where : data->where,
                        "data: columns: a map is wanted: {p: 4 um, i: 3 mA}");
  if (!status) status = read_columns(r, scene, columns, err);
  if (!status) status = read_time(data, "from", &r->from_s, err);
  if (!status) status = read_time(data, "to", &r->to_s, err);
  if (status) return status;
  FILE *f = fopen(r->path, "r");
  if (!f) return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", r->path, strerror(errno));
  rows all = {.r = r,
              .csv = {.file = r->path, .stream = f, .trim = true, .comments = true},
              .before_s = -INFINITY,
              .until_s = scene->setup.run.until_s};
  status = read_rows(&all, err);
  vs_csv_free(&all.csv);
  fclose(f);
  return status;
}

void vs_recording_free(vs_recording *r) {
  free(r->columns);
  free(r->samples);
  vs_text_free(&r->unused);
}
