/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plot/overlay.h"

#include <errno.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "base/csv.h"
#include "base/text.h"
#include "base/units.h"
#include "traces.h"

enum { MOST_COLUMNS = VS_CH_MOST + 1, LONGEST_UNIT = 8 };

typedef struct reader {
  vs_overlay *overlay;
  const vs_overlay_run *run;
  vs_column *known; /* the columns of run.csv after the time; one without a known unit can only be
                       named in full */
  size_t n_known;
  size_t columns; /* of the measured file; 0: its header is not read yet */
  vs_where at;
} reader;

/* ---- the measured file ---- */

static bool has_unit(const vs_column *c) {
  return *c->unit && vs_units_known(c->unit);
}

/* The column of the probe whose name begins this one, followed by a unit at most; NULL: none. */
static const vs_column *find_stem(const reader *r, const char *name) {
  const vs_column *longest = NULL;
  for (size_t k = 0; k < r->n_known; k++) {
    const vs_column *c = &r->known[k];
    size_t n = strlen(c->quantity);
    if (has_unit(c) && !strncmp(name, c->quantity, n) && (!name[n] || name[n] == '_') &&
        strlen(name + n) < LONGEST_UNIT && (!longest || n > strlen(longest->quantity)))
      longest = c;
  }
  return longest;
}

static vs_status unknown_column(const reader *r, const char *name, vs_error *err) {
  const vs_column *stem = find_stem(r, name);
  if (stem) {
    const char *unit = name + strlen(stem->quantity);
    return vs_fail_at(err, r->at, "column '%s': '%s' is no unit of %s; did you mean '%s'?", name,
                      unit + (*unit == '_'), stem->quantity, stem->name);
  }
  const char **names = vs_alloc(r->n_known + 1, sizeof *names);
  for (size_t k = 0; k < r->n_known; k++) names[k] = r->known[k].name;
  vs_fail_at(err, r->at, "%s has no column '%s'%s", r->run->path, name,
             vs_text_hint(name, names, r->n_known, "").text);
  free(names);
  return VS_INPUT;
}

static vs_status take_curve(reader *r, const char *name, int column, vs_error *err) {
  const vs_column *c = NULL;
  double factor = NAN;
  for (size_t k = 0; k < r->n_known && !c; k++)
    if (!strcmp(name, r->known[k].name)) c = &r->known[k], factor = 1;
  for (size_t k = 0; k < r->n_known && !c; k++) {
    size_t n = strlen(r->known[k].quantity);
    if (!has_unit(&r->known[k]) || strncmp(name, r->known[k].quantity, n) || name[n] != '_')
      continue;
    factor =
        vs_units_suffix_factor(name + n + 1, r->known[k].unit) / vs_units_factor(r->known[k].unit);
    if (!isnan(factor)) c = &r->known[k];
  }
  if (!c) return unknown_column(r, name, err);
  if (vs_overlay_find(r->overlay, c->name))
    return vs_fail_at(err, r->at, "column '%s': %s stands here a second time; leave one out", name,
                      c->name);
  vs_overlay_curve *curve = &r->overlay->curves[r->overlay->count++];
  *curve = (vs_overlay_curve){.column = column, .factor = factor};
  snprintf(curve->name, sizeof curve->name, "%.95s", c->name);
  if (*c->unit)
    snprintf(curve->label, sizeof curve->label, "%.60s / %.30s", c->quantity, c->unit);
  else
    snprintf(curve->label, sizeof curve->label, "%.95s", c->name);
  return VS_OK;
}

static vs_status read_header(reader *r, const vs_csv *csv, vs_error *err) {
  const char *name = csv->cell[0];
  r->at = csv->where[0];
  r->overlay->time_s = strncmp(name, "t_", 2) ? NAN : vs_units_suffix_factor(name + 2, "s");
  const char *other = csv->count == 1 ? strpbrk(name, ";\t") : NULL;
  if (other)
    return vs_fail_at(err, r->at,
                      "the file is cut at commas, and this line has %s in their place; write "
                      "'t_ms,p_mm', with decimal points",
                      *other == ';' ? "';'" : "tabs");
  if (isnan(r->overlay->time_s))
    return vs_fail_at(err, r->at, "the first column is the time: t_s, t_ms or t_us, not '%s'",
                      name);
  vs_status status = VS_OK;
  for (size_t k = 1; !status && k < csv->count; k++) {
    r->at = csv->where[k];
    if (k >= MOST_COLUMNS) return vs_fail_at(err, r->at, "too many columns");
    status = take_curve(r, csv->cell[k], (int)k + 1, err);
  }
  r->columns = csv->count;
  if (!status && r->columns == 1)
    status = vs_fail_at(err, r->at,
                        "no column follows the time: name them as in %s, for example "
                        "'p_m' or 'p_mm'",
                        r->run->path);
  return status;
}

static bool is_number(const char *cell, double *value) {
  char *end;
  if (cell[strspn(cell, "0123456789+-.eE")]) return false;
  *value = vs_text_to_number(cell, &end);
  return end != cell && !*end && isfinite(*value);
}

static vs_status read_row(reader *r, const vs_csv *csv, double *t, vs_error *err) {
  double before = *t, value = NAN;
  if (csv->count != r->columns)
    return vs_fail_at(err, r->at, "cells in this row: %zu; columns in the header: %zu", csv->count,
                      r->columns);
  for (size_t k = 0; k < csv->count; k++) {
    if (!is_number(csv->cell[k], &value))
      return vs_fail_at(err, csv->where[k], "'%s' is not a finite number%s; write one as 1.5e-3",
                        csv->cell[k], isfinite(value) ? "" : ", or too small");
    if (k == 0) *t = value;
  }
  if (*t <= before)
    return vs_fail_at(
        err, r->at,
        "the time does not rise: %.9g after %.9g; rows come in the order of their times", *t,
        before);
  double t_s = *t * r->overlay->time_s;
  if (t_s >= 0 && t_s <= r->run->until_s) r->overlay->rows++;
  return VS_OK;
}

/* Reads the rows, one after the other; blank lines may stand only at the end. */
static vs_status read_rows(reader *r, vs_csv *csv, vs_error *err) {
  double t = -INFINITY;
  vs_where blank = {0};
  vs_status status = VS_OK;
  while (!status && !(status = vs_csv_next(csv, err)) && csv->count) {
    r->at = (vs_where){csv->file, csv->line, 1};
    if (!r->columns)
      status = read_header(r, csv, err);
    else if (vs_csv_is_blank(csv)) {
      if (!blank.line) blank = r->at;
    } else if (blank.line)
      status = vs_fail_at(err, blank, "a blank line between rows");
    else
      status = read_row(r, csv, &t, err);
  }
  r->at = (vs_where){csv->file, csv->line, 1};
  if (!status && isinf(t))
    status = vs_fail_at(err, r->at,
                        r->columns ? "no row of numbers follows the header" : "the file is empty");
  if (!status && !r->overlay->rows)
    status =
        vs_fail_at(err, r->at, "no row lies within the run, which is 0 to %.9g s", r->run->until_s);
  return status;
}

vs_status vs_overlay_read(const char *path, const vs_overlay_run *run, vs_overlay *overlay,
                          vs_error *err) {
  reader r = {.overlay = overlay, .run = run, .at = {.file = path}};
  struct stat s;
  *overlay = (vs_overlay){.path = path};
  errno = 0;
  FILE *f = stat(path, &s) || !S_ISREG(s.st_mode) ? NULL : fopen(path, "r");
  if (!f)
    return vs_fail(err, VS_INPUT, "%s: cannot be opened: %s", path,
                   errno ? strerror(errno) : "not a plain file");
  overlay->curves = vs_alloc(MOST_COLUMNS, sizeof *overlay->curves);
  vs_column *columns = vs_traces_columns(run->folder, run->header, &r.n_known);
  r.known = columns + 1;
  r.n_known--;
  vs_csv csv = {.file = path, .stream = f, .trim = true};
  vs_status status = read_rows(&r, &csv, err);
  vs_csv_free(&csv);
  fclose(f);
  free(columns);
  return status;
}

void vs_overlay_free(vs_overlay *overlay) {
  free(overlay->curves);
  *overlay = (vs_overlay){0};
}

const vs_overlay_curve *vs_overlay_find(const vs_overlay *overlay, const char *name) {
  for (size_t k = 0; k < overlay->count; k++)
    if (!strcmp(overlay->curves[k].name, name)) return &overlay->curves[k];
  return NULL;
}
