/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/price_list.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/jail.h"
#include "netlist/kinds.h"

/* ---- the file ---- */

size_t vs_price_list_column(const vs_price_list *l, const char *title) {
  for (size_t c = 0; c < l->columns; c++)
    if (!strcmp(l->title[c], title)) return c;
  return SIZE_MAX;
}

const vs_price_cell *vs_price_list_cell(const vs_price_list *l, size_t row, size_t column) {
  return &l->cell[row * l->columns + column];
}

static vs_status take_titles(vs_price_list *l, const vs_csv *csv, vs_error *err) {
  l->title = vs_alloc(csv->count ? csv->count : 1, sizeof *l->title);
  for (size_t c = 0; c < csv->count; c++) {
    if (vs_price_list_column(l, csv->cell[c]) != SIZE_MAX)
      return vs_fail_at(err, csv->where[c], "column '%s' stands here twice", csv->cell[c]);
    l->title[l->columns++] = vs_copy(csv->cell[c]);
  }
  l->part = vs_price_list_column(l, "part");
  l->kind = vs_price_list_column(l, "kind");
  l->value = vs_price_list_column(l, "value");
  const char *missing = l->part == SIZE_MAX ? "part" : l->kind == SIZE_MAX ? "kind" : NULL;
  if (!missing) return VS_OK;
  return vs_fail_at(err, (vs_where){l->path, csv->line, 1},
                    "there is no column '%s'; a list of prices begins with a row of titles: "
                    "part,kind,value,price_eur, ...",
                    missing);
}

static vs_status check_row(const vs_price_list *l, size_t row, vs_error *err) {
  const vs_price_cell *part = vs_price_list_cell(l, row, l->part),
                      *kind = vs_price_list_cell(l, row, l->kind);
  if (!*part->text) return vs_fail_at(err, part->where, "a part's name is wanted");
  const size_t before = vs_price_list_find(l, part->text);
  if (before < row)
    return vs_fail_at(err, part->where, "%s stands in row %d already; a part has one row",
                      part->text, vs_price_list_cell(l, before, 0)->where.line);
  if (vs_kinds_find(kind->text)) return VS_OK;
  const char *names[64];
  size_t n = 0;
  for (const vs_kind *k = vs_kinds_all; k->name && n < 64; k++) names[n++] = k->name;
  return vs_fail_at(err, kind->where, "there is no kind of part '%s'%s", kind->text,
                    vs_text_hint(kind->text, names, n, "; `vibrospice list kinds` has them").text);
}

static vs_status take_row(vs_price_list *l, const vs_csv *csv, vs_error *err) {
  if (csv->count != l->columns)
    return vs_fail_at(err, csv->where[csv->count < l->columns ? csv->count - 1 : l->columns],
                      "%zu cells, where the first row has %zu titles", csv->count, l->columns);
  l->cell = vs_resize(l->cell, (l->rows + 1) * l->columns, sizeof *l->cell);
  for (size_t c = 0; c < l->columns; c++)
    l->cell[l->rows * l->columns + c] =
        (vs_price_cell){vs_copy(csv->cell[c]), {l->path, csv->where[c].line, csv->where[c].column}};
  return check_row(l, l->rows++, err);
}

vs_status vs_price_list_read(const char *path, vs_where where, vs_price_list *l, vs_error *err) {
  *l = (vs_price_list){0};
  snprintf(l->path, sizeof l->path, "%s", path);
  vs_status status = vs_jail_check(path, where, err);
  if (status) return status;
  FILE *f = fopen(path, "r");
  if (!f) return vs_fail_at(err, where, "%s cannot be opened: %s", path, strerror(errno));
  vs_csv csv = {.file = l->path, .stream = f, .trim = true, .comments = true, .guess = true};
  status = vs_csv_next(&csv, err);
  if (!status) status = take_titles(l, &csv, err);
  while (!status && !(status = vs_csv_next(&csv, err)) && csv.count)
    status = vs_error_keep(err, take_row(l, &csv, err));
  vs_csv_free(&csv);
  fclose(f);
  return status;
}

void vs_price_list_free(vs_price_list *l) {
  for (size_t c = 0; c < l->columns; c++) free(l->title[c]);
  for (size_t k = 0; k < l->rows * l->columns; k++) free(l->cell[k].text);
  free(l->title);
  free(l->cell);
  *l = (vs_price_list){0};
}

/* ---- rows ---- */

size_t vs_price_list_find(const vs_price_list *l, const char *part) {
  for (size_t r = 0; r < l->rows; r++)
    if (!strcmp(vs_price_list_cell(l, r, l->part)->text, part)) return r;
  return SIZE_MAX;
}

size_t vs_price_list_next(const vs_price_list *l, const char *kind, size_t from) {
  for (size_t r = from; r < l->rows; r++)
    if (!strcmp(vs_price_list_cell(l, r, l->kind)->text, kind)) return r;
  return SIZE_MAX;
}

vs_status vs_price_list_number(const vs_price_list *l, size_t row, size_t column, double *value,
                               vs_error *err) {
  const vs_price_cell *cell = vs_price_list_cell(l, row, column);
  char *end;
  *value = vs_text_to_number(cell->text, &end);
  if (end != cell->text && !*end && isfinite(*value)) return VS_OK;
  return vs_fail_at(err, cell->where, "%s of %s: '%s' is no number", l->title[column],
                    vs_price_list_cell(l, row, l->part)->text, cell->text);
}

/* ---- E series ---- */

/* The values of E24, in tenths, which are older than the rule 10^(k/n) and not all by it. E12, E6
 * and E3 are every second, fourth and eighth of them. */
static const int E24[] = {10, 11, 12, 13, 15, 16, 18, 20, 22, 24, 27, 30,
                          33, 36, 39, 43, 47, 51, 56, 62, 68, 75, 82, 91};
enum { OLD = sizeof E24 / sizeof *E24 };

/* How many values a decade has; 0: there is no such series. */
static int size_of_series(const char *series) {
  static const int SIZES[] = {3, 6, 12, 24, 48, 96, 192};
  char name[16];
  for (size_t k = 0; k < sizeof SIZES / sizeof *SIZES; k++) {
    snprintf(name, sizeof name, "E%d", SIZES[k]);
    if (!strcmp(series, name)) return SIZES[k];
  }
  return 0;
}

/* Value k of the series with n in a decade, from 1 on; k may be negative. */
static double value_of_series(int n, int k) {
  const int decade = (int)floor((double)k / n), i = k - decade * n;
  const double exact = pow(10, (double)i / n);
  double hundredths = n <= OLD ? 10. * E24[i * (OLD / n)] : round(100 * exact);
  if (n == 192 && i == 185) hundredths = 920; /* IEC 60063 has it so, where the rule gives 919 */
  return vs_text_rounded(hundredths * pow(10, decade - 2), 12);
}

/* The first k whose value is at least that. Values differ from 10^(k/n) by less than a step. */
static int first_of_series(int n, double value) {
  int k = (int)floor(n * log10(value)) - 2;
  while (value_of_series(n, k) < value) k++;
  return k;
}

size_t vs_price_list_series(const char *series, double from, double to, double *values,
                            size_t most) {
  const int n = size_of_series(series);
  size_t count = 0;
  if (!n || !(from > 0 && isfinite(to))) return 0;
  for (int k = first_of_series(n, from); value_of_series(n, k) <= to; k++, count++)
    if (count < most) values[count] = value_of_series(n, k);
  return count;
}

double vs_price_list_neighbour(const char *series, double value, int step) {
  const int n = size_of_series(series);
  if (!n || !(value > 0 && isfinite(value))) return NAN;
  int k = first_of_series(n, value);
  if (step < 0 || value_of_series(n, k) == value) k += step;
  return value_of_series(n, k);
}
