/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "grid.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/text.h"
#include "base/units.h"

enum { LEAST = 4, MOST = 1000 }; /* of gaps and of currents, 0 included */

/* ---- the file ---- */

enum { Z, I, LAMBDA, FORCE, COLUMNS };
static const struct {
  const char *name, *unit, *example;
} COLUMN[COLUMNS] = {
    {"z", "m", "z_m"}, {"i", "A", "i_a"}, {"lambda", "Wb", "lambda_wb"}, {"force", "N", "force_n"}};

typedef struct row {
  double value[COLUMNS]; /* SI */
  int line;
} row;

typedef struct rows {
  row *item; /* owned */
  size_t count, room;
  int column[COLUMNS]; /* where in a line; -1: it is not there */
  double factor[COLUMNS];
} rows;

/* Finds out which column is which. */
static vs_status read_head(vs_csv *csv, rows *r, vs_error *err) {
  for (int c = 0; c < COLUMNS; c++) r->column[c] = -1;
  for (size_t k = 0; k < csv->count; k++) {
    const char *word = csv->cell[k], *bar = strchr(word, '_');
    size_t length = bar ? (size_t)(bar - word) : strlen(word);
    int c = 0;
    while (c < COLUMNS &&
           (strlen(COLUMN[c].name) != length || strncmp(COLUMN[c].name, word, length) != 0))
      c++;
    double factor = c < COLUMNS && bar ? vs_units_suffix_factor(bar + 1, COLUMN[c].unit) : NAN;
    if (isnan(factor))
      return vs_fail_at(err, csv->where[k],
                        "column '%s' is not known in a table of an actuator; there are: z_m, i_a, "
                        "lambda_wb and force_n",
                        word);
    if (r->column[c] >= 0)
      return vs_fail_at(err, csv->where[k], "column %s stands here a second time; leave one out",
                        word);
    r->column[c] = (int)k;
    r->factor[c] = factor;
  }
  for (int c = 0; c < FORCE; c++)
    if (r->column[c] < 0)
      return vs_fail_at(err, (vs_where){csv->file, csv->line, 1},
                        "there is no column %s; a table of an actuator has z_m, i_a, lambda_wb "
                        "and, if wanted, force_n",
                        COLUMN[c].example);
  return VS_OK;
}

static vs_status read_row(const vs_csv *csv, const rows *r, row *out, vs_error *err) {
  *out = (row){.line = csv->line};
  for (int c = 0; c < COLUMNS; c++) {
    char *end;
    if (r->column[c] < 0) continue;
    size_t k = (size_t)r->column[c];
    if (k >= csv->count)
      return vs_fail_at(err, (vs_where){csv->file, csv->line, 1},
                        "the row has %zu cells, and its column %s is the %zu.", csv->count,
                        COLUMN[c].example, k + 1);
    double value = vs_text_to_number(csv->cell[k], &end);
    if (vs_text_beyond(csv->cell[k]))
      return vs_fail_at(err, csv->where[k], "'%s': %s", csv->cell[k], vs_text_beyond(csv->cell[k]));
    if (end == csv->cell[k] || *end || !isfinite(value))
      return vs_fail_at(err, csv->where[k], "'%s' is not a number; write one as 1.5e-3",
                        csv->cell[k]);
    out->value[c] = value * r->factor[c];
    bool low = c == Z ? value <= 0 : c == I && value < 0;
    if (low)
      return vs_fail_at(err, csv->where[k],
                        c == Z ? "%s: a gap must be above 0"
                               : "%s: a current must not be below 0; the table is taken as "
                                 "symmetric, lambda as odd in i",
                        csv->cell[k]);
  }
  return VS_OK;
}

static vs_status read_rows(vs_csv *csv, rows *r, vs_error *err) {
  vs_status s = vs_csv_next(csv, err);
  if (!s && !csv->count)
    s = vs_fail_at(err, (vs_where){csv->file, 1, 1},
                   "the table is empty; its first line names its "
                   "columns: z_m,i_a,lambda_wb,force_n");
  if (!s) s = read_head(csv, r, err);
  while (!s) {
    s = vs_csv_next(csv, err);
    if (s || !csv->count) break;
    if (r->count == (size_t)MOST * MOST)
      return vs_fail_at(err, (vs_where){csv->file, csv->line, 1}, "more than %d rows", MOST * MOST);
    if (r->count == r->room) {
      r->room = 2 * r->room + 64;
      r->item = vs_resize(r->item, r->room, sizeof *r->item);
    }
    s = read_row(csv, r, &r->item[r->count], err);
    r->count++;
  }
  return s;
}

/* ---- the grid ---- */

static int by_gap_and_current(const void *a, const void *b) {
  const row *x = a, *y = b;
  for (int c = Z; c <= I; c++)
    if (x->value[c] != y->value[c]) return x->value[c] < y->value[c] ? -1 : 1;
  return x->line - y->line;
}

/* Gives each gap a row of i = 0, lambda = 0, where the file has none; returns whether it did. */
static bool add_zeros(rows *r) {
  for (size_t k = 0; k < r->count; k++)
    if (r->item[k].value[I] == 0) return false;
  size_t old = r->count;
  row *more = vs_alloc(2 * old, sizeof *more);
  memcpy(more, r->item, old * sizeof *more);
  for (size_t k = 0; k < old; k++)
    if (!k || r->item[k].value[Z] != r->item[k - 1].value[Z])
      more[r->count++] = (row){.value = {[Z] = r->item[k].value[Z]}, .line = r->item[k].line};
  free(r->item);
  r->item = more;
  qsort(r->item, r->count, sizeof *r->item, by_gap_and_current);
  return true;
}

/* Error, with the line: the rows, which are sorted, are no grid of n_i currents at each gap. */
static vs_status check_grid(const rows *r, size_t n_i, const char *file, vs_error *err) {
  for (size_t k = 0; k < r->count; k++) {
    const row *at = &r->item[k], *first = &r->item[k % n_i], *left = k ? at - 1 : NULL;
    const vs_where where = {file, at->line, 1};
    if (left && left->value[Z] == at->value[Z] && left->value[I] == at->value[I])
      return vs_fail_at(err, where,
                        "z = %.9g m, i = %.9g A stands in line %d already; leave one out",
                        at->value[Z], at->value[I], left->line);
    bool begins = !left || left->value[Z] != at->value[Z];
    if (at->value[I] != first->value[I] || begins != (k % n_i == 0))
      return vs_fail_at(err, where,
                        "the table is no grid: at z = %.9g m the currents are not those at z = "
                        "%.9g m; give every gap the same ones",
                        begins && left ? left->value[Z] : at->value[Z], r->item[0].value[Z]);
  }
  if (r->count % n_i)
    return vs_fail_at(err, (vs_where){file, r->item[r->count - 1].line, 1},
                      "the table is no grid: at z = %.9g m currents are missing; give every gap "
                      "the same ones",
                      r->item[r->count - 1].value[Z]);
  return VS_OK;
}

/* Errors: lambda does not rise with i, or is not 0 without current. */
static vs_status check_rising(const rows *r, const char *file, vs_error *err) {
  for (size_t k = 0; k < r->count; k++) {
    const row *at = &r->item[k], *left = at - 1;
    if (at->value[I] == 0 && at->value[LAMBDA] != 0)
      return vs_fail_at(err, (vs_where){file, at->line, 1},
                        "lambda is %.9g Wb without current; it must be 0 there, as the table is "
                        "taken as symmetric",
                        at->value[LAMBDA]);
    if (at->value[I] > 0 && !(at->value[LAMBDA] > left->value[LAMBDA]))
      return vs_fail_at(err, (vs_where){file, at->line, 1},
                        "lambda does not rise with i at z = %.9g m: %.9g Wb at %.9g A and %.9g Wb "
                        "at %.9g A",
                        at->value[Z], left->value[LAMBDA], left->value[I], at->value[LAMBDA],
                        at->value[I]);
  }
  return VS_OK;
}

static vs_status check_size(const char *what, size_t n, const char *file, vs_error *err) {
  if (n >= LEAST && n <= MOST) return VS_OK;
  return vs_fail_at(err, (vs_where){file, 1, 1}, "the number of %s is %zu; a table has %d to %d",
                    what, n, LEAST, MOST);
}

/* Makes the grid of sorted rows. */
static vs_status make_grid(const rows *r, const char *file, vs_grid *g, vs_error *err) {
  size_t n_i = 0, n_z = 0;
  while (n_i < r->count && r->item[n_i].value[Z] == r->item[0].value[Z]) n_i++;
  for (size_t k = 0; k < r->count; k++) n_z += !k || r->item[k].value[Z] != r->item[k - 1].value[Z];
  vs_status s = check_size("gaps", n_z, file, err);
  if (!s) s = check_size("currents, 0 included,", n_i, file, err);
  if (!s) s = check_grid(r, n_i, file, err);
  if (!s) s = check_rising(r, file, err);
  if (s) return s;
  g->n_z = n_z;
  g->n_i = n_i;
  g->z_m = vs_alloc(n_z + n_i + 2 * r->count, sizeof *g->z_m);
  g->i_a = g->z_m + n_z;
  g->flux_wb = g->i_a + n_i;
  double *force = g->flux_wb + r->count;
  if (r->column[FORCE] >= 0) g->force_n = force;
  for (size_t k = 0; k < r->count; k++) {
    g->z_m[k / n_i] = r->item[k].value[Z];
    g->i_a[k % n_i] = r->item[k].value[I];
    g->flux_wb[k] = r->item[k].value[LAMBDA];
    force[k] = r->item[k].value[FORCE];
  }
  return VS_OK;
}

vs_status vs_grid_read(const char *file, FILE *stream, vs_grid *g, vs_error *err) {
  vs_csv csv = {.file = file, .stream = stream, .trim = true, .comments = true};
  rows r = {0};
  *g = (vs_grid){0};
  vs_status s = read_rows(&csv, &r, err);
  if (r.count) qsort(r.item, r.count, sizeof *r.item, by_gap_and_current);
  if (!s && r.count) g->added_zero = add_zeros(&r);
  if (!s) s = make_grid(&r, file, g, err);
  free(r.item);
  vs_csv_free(&csv);
  return s;
}

void vs_grid_free(vs_grid *g) {
  free(g->z_m);
  *g = (vs_grid){0};
}
