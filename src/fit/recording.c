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

#include "base/jail.h"
#include "base/text.h"
#include "run/axis.h"
#include "base/units.h"

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

/* Beside the fit file, or as it stands. */
static vs_status find_file(vs_recording *r, const vs_node *file, const char *beside,
                           vs_error *err) {
  const char *slash = strrchr(beside, '/');
  if (!file || file->kind != VS_NODE_TEXT || !*file->text)
    return vs_fail_at(err, file ? file->where : (vs_where){beside, 1, 1},
                      "data: file: the name of a CSV file is wanted");
  snprintf(r->path, sizeof r->path, "%.*s%s",
           slash && *file->text != '/' ? (int)(slash - beside + 1) : 0, beside, file->text);
  if (access(r->path, R_OK) && !access(file->text, R_OK))
    snprintf(r->path, sizeof r->path, "%s", file->text);
  struct stat s;
  vs_status status = vs_jail_check(r->path, file->where, err);
  if (status) return status;
  if (!stat(r->path, &s) && S_ISREG(s.st_mode) && !access(r->path, R_OK)) return VS_OK;
  return vs_fail_at(err, file->where, "data: file: %s cannot be opened: %s", r->path,
                    access(r->path, R_OK) ? strerror(errno) : "not a plain file");
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
static void point(const vs_csv *csv, char *text) {
  char *comma = strchr(text, ',');
  if (comma && csv->separator != ',' && !strchr(text, '.')) *comma = '.';
}

static vs_status read_number(const vs_csv *csv, size_t cell, double *value, vs_error *err) {
  char *text = csv->cell[cell], *end = text;
  point(csv, text);
  *value = text[strspn(text, "0123456789+-.eE")] ? NAN : vs_text_to_number(text, &end);
  if (isfinite(*value) && *text && !*end) return VS_OK;
  if (vs_text_beyond(text) && !*end)
    return vs_fail_at(err, csv->where[cell], "'%s': %s", text, vs_text_beyond(text));
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

static vs_status read_error(const vs_csv *csv, const vs_recorded *c, double *error, vs_error *err) {
  if (c->cell_of_error < 0) return VS_OK;
  const size_t cell = (size_t)c->cell_of_error;
  vs_status status = read_number(csv, cell, error, err);
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
  status = read_number(csv, cell, &sample.value, err);
  if (!status) status = read_error(csv, c, &sample.error, err);
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

static vs_status read_rows(rows *f, vs_error *err) {
  vs_recording *r = f->r;
  vs_status status = VS_OK;
  while (!status && !(status = vs_csv_next(&f->csv, err)) && f->csv.count) {
    if (f->columns) {
      status = read_row(f, err);
    } else {
      f->columns = f->csv.count;
      status = vs_columns_find(&r->columns, &f->csv, &f->time_s, err);
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
  if (!status) status = find_file(r, vs_tree_child(data, "file"), beside, err);
  if (!status && (!columns || columns->kind != VS_NODE_MAP || !columns->child))
    status = vs_fail_at(err, columns ? columns->where : data->where,
                        "data: columns: a map is wanted: {p: 4 um, i: 3 mA}");
  if (!status) status = vs_columns_read(&r->columns, columns, scene, err);
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
  status = read_rows(&all, err);
  vs_csv_free(&all.csv);
  fclose(f);
  if (!status) qsort(r->samples, r->n_samples, sizeof *r->samples, by_instant);
  return status;
}

void vs_recording_free(vs_recording *r) {
  vs_columns_free(&r->columns);
  free(r->samples);
}
