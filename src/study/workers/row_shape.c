/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/row_shape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/text.h"
#include "workers/case.h"

/* What a cell has to be. */
static const char *const WANTED[] = {[VS_CELLS_TEXT] = "anything",
                                     [VS_CELLS_EITHER] = "a word",
                                     [VS_CELLS_NUMBER] = "a number",
                                     [VS_CELLS_VALUE] = "a number or nothing",
                                     [VS_CELLS_LINE] = "a number, inf, nan or nothing",
                                     [VS_CELLS_COUNT] = "a whole number",
                                     [VS_CELLS_STATUS] = "status 0 or 3"};

/* Of one header row. */
typedef struct header {
  char *text, **name; /* cut up; name points into text */
  char **unit;        /* as JSON; only of study.csv */
  vs_folder_role *role;
  vs_folder_cells *cells;
  size_t count;
} header;

struct vs_row_shape {
  header done, failed;
};

static header cut_header(const char *row) {
  header h = {.text = vs_copy(row)};
  size_t most = 1;
  for (const char *s = row; *s; s++) most += *s == ',';
  h.name = vs_alloc(most, sizeof *h.name);
  h.role = vs_alloc(most, sizeof *h.role);
  h.cells = vs_alloc(most, sizeof *h.cells);
  h.unit = vs_alloc(most, sizeof *h.unit);
  h.count = vs_csv_split(h.text, h.name, most, NULL);
  return h;
}

static void free_header(header *h) {
  for (size_t k = 0; k < h->count; k++) free(h->unit[k]);
  free(h->unit);
  free(h->text);
  free(h->name);
  free(h->role);
  free(h->cells);
}

/* Returns a column's unit as the manifest has it, in quotes; "" in quotes where that says nothing.
 * free() it. */
static char *find_unit(const char *column, const char *manifest) {
  vs_text wanted = {0};
  vs_text_add(&wanted, "\"column\": ");
  vs_json_string(&wanted, column);
  vs_text_add(&wanted, ", \"unit\": ");
  const char *found = strstr(manifest, wanted.text);
  if (found) found += wanted.length;
  const char *end = found ? vs_json_string_end(found) : NULL;
  char *unit = end ? vs_alloc_part(found, (size_t)(end - found)) : vs_copy("\"\"");
  vs_text_free(&wanted);
  return unit;
}

static vs_folder_cells cells_of_axis(const char *column, const char *manifest) {
  char *unit = find_unit(column, manifest);
  const bool none = unit[1] == '"';
  free(unit);
  return vs_folder_axis_cells(column, none);
}

/* The case comes first. The axes stand behind it and its id, in both headers. */
static void find_roles(header *h, const header *other, const char *manifest) {
  bool alike = true;
  for (size_t k = 0; k < h->count; k++) {
    alike = alike && k < other->count && !strcmp(h->name[k], other->name[k]);
    h->role[k] = k == 0           ? VS_ROLE_CASE
                 : k > 1 && alike ? VS_ROLE_AXIS
                                  : vs_folder_role_of(h->name[k]);
    h->cells[k] = h->role[k] == VS_ROLE_AXIS ? cells_of_axis(h->name[k], manifest)
                                             : vs_folder_kinds[h->role[k]].cells;
  }
}

vs_row_shape *vs_row_shape_new(const char *columns, const char *failures, const char *manifest) {
  vs_row_shape *shape = vs_alloc(1, sizeof *shape);
  shape->done = cut_header(columns);
  shape->failed = cut_header(failures);
  find_roles(&shape->done, &shape->failed, manifest);
  find_roles(&shape->failed, &shape->done, manifest);
  for (size_t k = 0; k < shape->done.count; k++)
    shape->done.unit[k] = find_unit(shape->done.name[k], manifest);
  return shape;
}

void vs_row_shape_free(vs_row_shape *shape) {
  if (!shape) return;
  free_header(&shape->done);
  free_header(&shape->failed);
  free(shape);
}

size_t vs_row_shape_first_measure(const vs_row_shape *shape) {
  size_t k = 0;
  while (k < shape->done.count && k < shape->failed.count &&
         !strcmp(shape->done.name[k], shape->failed.name[k]))
    k++;
  return k;
}

size_t vs_row_shape_columns(const vs_row_shape *shape) {
  return shape->done.count;
}

vs_row_shape_column vs_row_shape_column_at(const vs_row_shape *shape, size_t k) {
  const header *h = &shape->done;
  return (vs_row_shape_column){h->name[k], h->unit[k], h->cells[k], h->role[k]};
}

bool vs_row_shape_is_number(const char *cell) {
  char *end;
  return *cell && !cell[strspn(cell, "0123456789.eE+-")] && isfinite(strtod(cell, &end)) && !*end;
}

static bool is_count(const char *cell) {
  return *cell && !cell[strspn(cell, "0123456789")] && (*cell != '0' || !cell[1]);
}

static bool cell_holds(const char *cell, vs_folder_cells cells, bool failed) {
  switch (cells) {
  case VS_CELLS_EITHER:
    return *cell;
  case VS_CELLS_NUMBER:
    return vs_row_shape_is_number(cell);
  case VS_CELLS_VALUE:
    return !*cell || vs_row_shape_is_number(cell);
  case VS_CELLS_LINE:
    return !*cell || !strcmp(cell, "inf") || !strcmp(cell, "nan") || vs_row_shape_is_number(cell);
  case VS_CELLS_COUNT:
    return is_count(cell);
  case VS_CELLS_STATUS:
    return failed ? !strcmp(cell, "1") : !strcmp(cell, "0") || !strcmp(cell, "3");
  default:
    return true;
  }
}

static void count_row_cells(const header *h, char *const *cell, vs_row_shape_counts *counts) {
  *counts = (vs_row_shape_counts){0};
  for (size_t k = 0; k < h->count; k++)
    if (k == 0)
      counts->index = strtoull(cell[k], NULL, 10); /* UINT64_MAX where it is too large */
    else if (h->role[k] == VS_ROLE_STATUS)
      counts->violated = atoi(cell[k]) == VS_CASE_VIOLATED;
}

bool vs_row_shape_read(const vs_row_shape *shape, bool failed, const char *row,
                       vs_row_shape_counts *counts, size_t *at, char *why, size_t size) {
  const header *h = failed ? &shape->failed : &shape->done;
  char *copy = vs_copy(row), **cell = vs_alloc(h->count + 1, sizeof *cell);
  vs_csv_flaw flaw;
  size_t n = vs_csv_split(copy, cell, h->count + 1, &flaw), k = 0;
  bool fits = !flaw.why && n == h->count;
  *at = flaw.why ? flaw.at : 0;
  if (flaw.why)
    snprintf(why, size, "%s", flaw.why);
  else if (!fits)
    snprintf(why, size, "cells in this row: %s%zu; columns in its header: %zu",
             n > h->count ? "at least " : "", n, h->count);
  while (fits && k < n && cell_holds(cell[k], h->cells[k], failed)) k++;
  if (fits && k < n) {
    fits = false;
    *at = (size_t)(cell[k] - copy);
    snprintf(why, size, "column %.64s holds '%.64s'; %s is wanted there", h->name[k], cell[k],
             failed && h->role[k] == VS_ROLE_STATUS ? "status 1" : WANTED[h->cells[k]]);
  }
  if (fits) count_row_cells(h, cell, counts);
  free(cell);
  free(copy);
  return fits;
}

/* The case comes first, in quotes or not. */
bool vs_row_shape_is_of(const char *row, uint64_t index) {
  const char *number = row + (*row == '"');
  char *after;
  return strtoull(number, &after, 10) == index && after > number;
}
