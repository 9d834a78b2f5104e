/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/recording.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/csv.h"
#include "base/jail.h"
#include "base/text.h"
#include "base/units.h"
#include "fit/unknown.h"
#include "run/axis.h"
#include "run/scene.h"

/* ---- columns: the map in the fit file ---- */

/* Columns of a recording that are fitted, and where a CSV file has them. A column is a channel of a
 * run, as p, or what an instrument shows of one, as p_meas (measure/instruments.h). In the file
 * its name has its unit, as p_mm or p [mm]. */

/* How a column of an instrument's ends. */
static const char ENDING[] = "_meas";

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
  return vs_fail_at(
      err, node->key_where, "columns: a run on tier %s has no '%s'%s", scene->tier->name, node->key,
      vs_text_hint(node->key, names, (size_t)n, "; see 'vibrospice list probes'").text);
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

static vs_status read_error_of_column(vs_recorded *c, const vs_node *node, vs_error *err) {
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

/* Reads the map `columns` of a fit file, NAME: ERROR, NAME: {error: ERROR} or NAME alone. An
 * instrument without a stated error has that of its noise and its A/D together. Errors: no such
 * channel or instrument; an error that is not above 0, or a share. columns_free even then. */
static vs_status columns_read(vs_columns *all, const vs_node *map, const vs_scene *scene,
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
    if (!status) status = read_error_of_column(c, n, err);
  }
  return status;
}

static void columns_free(vs_columns *all) {
  free(all->item);
  vs_text_free(&all->unused);
}

/* ---- the header ---- */

double vs_recording_factor(const char *cell, const char *name, const char *unit, bool *named) {
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
    double f = vs_recording_factor(csv->cell[k], name, unit, &named);
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

static vs_status find_column_in_header(vs_recorded *c, const vs_csv *csv, vs_error *err) {
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

static bool is_column_used(const vs_columns *all, int cell) {
  for (size_t k = 0; k < all->count; k++)
    if (all->item[k].cell == cell || all->item[k].cell_of_error == cell) return true;
  return false;
}

/* Finds the columns in a file's header; *time_s becomes the unit of its first column. Errors: a
 * column that is wanted is not there or is there twice, or has no unit of its kind; there is no
 * error for it. */
static vs_status columns_find(vs_columns *all, const vs_csv *csv, double *time_s, vs_error *err) {
  bool named;
  if (csv->count > VS_COLUMNS_CELLS)
    return vs_fail_at(err, csv->where[0], "more than %d columns", VS_COLUMNS_CELLS);
  *time_s = vs_recording_factor(csv->cell[0], "t", "s", &named);
  if (isnan(*time_s))
    return vs_fail_at(err, csv->where[0],
                      "the first column is the time with its unit: t_s, t_ms or t_us, not '%s'",
                      csv->cell[0]);
  vs_status status = VS_OK;
  for (size_t k = 0; k < all->count && !status; k++)
    status = find_column_in_header(&all->item[k], csv, err);
  for (size_t k = 1; k < csv->count && !status; k++)
    if (!is_column_used(all, (int)k))
      vs_text_add(&all->unused, "%s%s", all->unused.length ? ", " : "", csv->cell[k]);
  return status;
}

enum { MOST_SAMPLES = 1000000 };

/* ---- the map in the fit file ---- */

static vs_status read_time(const vs_node *map, const char *key, double *t_s, vs_error *err) {
  char why[256];
  const vs_node *node = vs_tree_child(map, key);
  if (!node) return VS_OK;
  if (node->kind == VS_NODE_TEXT && vs_units_read(node->text, "s", t_s, why, sizeof why))
    return VS_OK;
  return vs_fail_at(err, node->where, "%s: %s", key,
                    node->kind == VS_NODE_TEXT ? why : "a time is wanted, as 5 ms");
}

vs_status vs_recording_file(char path[VS_PATH_SIZE], const char *key, const vs_node *file,
                            const char *beside, vs_error *err) {
  const char *slash = strrchr(beside, '/');
  if (!file || file->kind != VS_NODE_TEXT || !*file->text)
    return vs_fail_at(err, file ? file->where : (vs_where){beside, 1, 1},
                      "%s: file: the name of a CSV file is wanted", key);
  snprintf(path, VS_PATH_SIZE, "%.*s%s",
           slash && *file->text != '/' ? (int)(slash - beside + 1) : 0, beside, file->text);
  if (access(path, R_OK) && !access(file->text, R_OK))
    snprintf(path, VS_PATH_SIZE, "%s", file->text);
  struct stat s;
  vs_status status = vs_jail_check(path, file->where, err);
  if (status) return status;
  if (!stat(path, &s) && S_ISREG(s.st_mode) && !access(path, R_OK)) return VS_OK;
  return vs_fail_at(err, file->where, "%s: file: %s cannot be opened: %s", key, path,
                    access(path, R_OK) ? strerror(errno) : "not a plain file");
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

/* Where cells stand apart by something else, a decimal comma is as good as a point. */
static void make_decimal_point(const vs_csv *csv, char *text) {
  char *comma = strchr(text, ',');
  if (comma && csv->separator != ',' && !strchr(text, '.')) *comma = '.';
}

vs_status vs_recording_number(const vs_csv *csv, size_t cell, double *value, vs_error *err) {
  char *text = csv->cell[cell], *end = text;
  make_decimal_point(csv, text);
  *value = text[strspn(text, "0123456789+-.eE")] ? NAN : vs_text_to_number(text, &end);
  if (isfinite(*value) && *text && !*end) return VS_OK;
  if (vs_text_out_of_range(text) && !*end)
    return vs_fail_at(err, csv->where[cell], "'%s': %s", text, vs_text_out_of_range(text));
  return vs_fail_at(err, csv->where[cell], "'%s' is not a finite number%s", text,
                    strchr(text, ',') ? "; a decimal comma is read where semicolons or tabs stand "
                                        "between the cells"
                                      : "");
}

/* How near to an instant at which a sample is taken another one is the same, in times between two
 * samples: times in files have nine digits, and a record some 1e4 samples. */
static const double SAME = 1e-3;

/* Finds the instant at which the sample was taken that a row at t_s shows. *again: an earlier row
 * has shown it. */
static vs_status find_instant(const vs_recording *r, const vs_recorded *c, vs_where where,
                              double *t_s, bool *again, vs_error *err) {
  *again = false;
  if (c->instrument < 0) return VS_OK;
  double n = *t_s * c->rate_hz, nearest = round(n);
  if (fabs(n - nearest) < SAME) {
    *t_s = nearest / c->rate_hz;
  } else if (r->rows == VS_ROWS_UNSAID) {
    return vs_fail_at(err, where,
                      "%.9g s is no instant at which %s is sampled, every %.9g s from 0: write "
                      "rows: held if the row shows the sample before, as in run.csv, or rows: "
                      "taken if it was taken at that time",
                      *t_s, c->name, 1 / c->rate_hz);
  } else if (r->rows == VS_ROWS_HELD) {
    *t_s = floor(n) / c->rate_hz;
  }
  *again = *t_s <= c->last_s;
  return VS_OK;
}

static void add_sample(vs_recording *r, const vs_sample *sample) {
  if (!(r->n_samples & (r->n_samples - 1))) {
    size_t room = r->n_samples ? 2 * r->n_samples : 1;
    r->samples = vs_resize(r->samples, room, sizeof *r->samples);
  }
  r->samples[r->n_samples++] = *sample;
}

static vs_status read_error_of_sample(const vs_csv *csv, const vs_recorded *c, double *error,
                                      vs_error *err) {
  if (c->cell_of_error < 0) return VS_OK;
  const size_t cell = (size_t)c->cell_of_error;
  vs_status status = vs_recording_number(csv, cell, error, err);
  *error *= c->factor_of_error;
  if (!status && !(*error > 0))
    status = vs_fail_at(err, csv->where[cell], "the error '%s' is not above 0", csv->cell[cell]);
  return status;
}

static vs_status read_sample(vs_recording *r, size_t column, const vs_csv *csv, double t_s,
                             vs_error *err) {
  vs_recorded *c = &r->columns.item[column];
  const size_t cell = (size_t)c->cell;
  const vs_where where = {r->path, csv->where[cell].line, csv->where[cell].column};
  vs_sample sample = {.column = (int)column, .t_s = t_s, .error = c->error, .where = where};
  bool again;
  if (!*csv->cell[cell] || !strcasecmp(csv->cell[cell], "nan")) {
    r->empty++;
    return VS_OK;
  }
  vs_status status = find_instant(r, c, where, &sample.t_s, &again, err);
  if (!status && again) r->again++;
  if (status || again) return status;
  status = vs_recording_number(csv, cell, &sample.value, err);
  if (!status) status = read_error_of_sample(csv, c, &sample.error, err);
  if (!status && r->n_samples == MOST_SAMPLES)
    status =
        vs_fail_at(err, where, "more than %d samples; take fewer by from and to", MOST_SAMPLES);
  if (status) return status;
  sample.value *= c->factor;
  c->last_s = sample.t_s;
  if (!(sample.value >= c->ends[0] && sample.value <= c->ends[1])) {
    r->at_end++;
    return VS_OK;
  }
  add_sample(r, &sample);
  c->samples++;
  return VS_OK;
}

static vs_status read_row_of_recording(rows *f, vs_error *err) {
  vs_recording *r = f->r;
  const vs_where where = f->csv.where[0];
  double t;
  if (f->csv.count != f->columns)
    return vs_fail_at(err, where, "cells in this row: %zu; columns in the header: %zu",
                      f->csv.count, f->columns);
  vs_status status = vs_recording_number(&f->csv, 0, &t, err);
  if (status) return status;
  double t_s = t * f->time_s;
  if (t_s <= f->before_s)
    return vs_fail_at(
        err, where,
        "the time does not rise: %.9g s after %.9g s; rows come in the order of their times", t_s,
        f->before_s);
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
  for (size_t k = 0; k < r->columns.count && !status; k++)
    status = read_sample(r, k, &f->csv, fmin(t_s, f->until_s), err);
  return status;
}

static vs_status read_rows_of_recording(rows *f, vs_error *err) {
  vs_recording *r = f->r;
  vs_status status = VS_OK;
  while (!status && !(status = vs_csv_next(&f->csv, err)) && f->csv.count) {
    if (f->columns) {
      status = read_row_of_recording(f, err);
    } else {
      f->columns = f->csv.count;
      status = columns_find(&r->columns, &f->csv, &f->time_s, err);
    }
  }
  vs_where end = {r->path, f->csv.line, 1};
  if (!status && !r->n_samples)
    status = vs_fail_at(err, end, f->columns ? "no sample is left to fit" : "the file is empty");
  for (size_t k = 0; k < r->columns.count && !status; k++)
    if (!r->columns.item[k].samples)
      status = vs_fail_at(err, r->columns.item[k].where, "%s: no sample is left to fit",
                          r->columns.item[k].name);
  return status;
}

/* Samples that are held were taken before the time of their row, each column's at its own rate. */
static int by_instant(const void *a, const void *b) {
  const vs_sample *x = a, *y = b;
  if (x->t_s != y->t_s) return x->t_s < y->t_s ? -1 : 1;
  return (x->column > y->column) - (x->column < y->column);
}

/* ---- all of it ---- */

vs_status vs_recording_read(vs_recording *r, const vs_node *data, const char *beside,
                            const vs_scene *scene, vs_error *err) {
  static const char *const KEYS[] = {"file", "columns", "from", "to", "rows"};
  const vs_node *columns = vs_tree_child(data, "columns");
  int rows_word = VS_ROWS_UNSAID;
  *r = (vs_recording){.from_s = -INFINITY, .to_s = INFINITY};
  if (data->kind != VS_NODE_MAP)
    return vs_fail_at(err, data->where,
                      "data: a map is wanted: {file: NAME.csv, columns: {p: 4 um}}");
  vs_status status = vs_field_known_keys(data, "data", KEYS, 5, err);
  if (!status)
    status = vs_recording_file(r->path, "data", vs_tree_child(data, "file"), beside, err);
  if (!status && (!columns || columns->kind != VS_NODE_MAP || !columns->child))
    status = vs_fail_at(err, columns ? columns->where : data->where,
                        "data: columns: a map is wanted: {p: 4 um, i: 3 mA}");
  if (!status) status = columns_read(&r->columns, columns, scene, err);
  if (!status) status = read_time(data, "from", &r->from_s, err);
  if (!status) status = read_time(data, "to", &r->to_s, err);
  if (!status) status = vs_axis_word(data, "data.rows", "taken|held", &rows_word, err);
  r->rows = (vs_rows_word)rows_word;
  if (status) return status;
  FILE *f = fopen(r->path, "r");
  if (!f) return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", r->path, strerror(errno));
  rows all = {.r = r,
              .csv = {.file = r->path, .stream = f, .trim = true, .comments = true, .guess = true},
              .before_s = -INFINITY,
              .until_s = scene->setup.run.until_s};
  status = read_rows_of_recording(&all, err);
  vs_csv_free(&all.csv);
  fclose(f);
  if (!status) qsort(r->samples, r->n_samples, sizeof *r->samples, by_instant);
  return status;
}

void vs_recording_free(vs_recording *r) {
  columns_free(&r->columns);
  free(r->samples);
}
