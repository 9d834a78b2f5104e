/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "workers/row_shape.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/csv.h"
#include "base/text.h"
#include "workers/case.h"

/* What a cell may hold. */
typedef enum cell_kind { ANY, WORD, NUMBER, NUMBER_OR_NOTHING, COUNT, DONE, FAILED } cell_kind;
static const char *const WANTED[] = {
    [ANY] = "anything",         [WORD] = "a word",
    [NUMBER] = "a number",      [NUMBER_OR_NOTHING] = "a number or nothing",
    [COUNT] = "a whole number", [DONE] = "status 0 or 3",
    [FAILED] = "status 1"};

/* Of one header row. */
typedef struct header {
  char *text, **name; /* cut up; name points into text */
  char **unit;        /* as JSON; only of study.csv */
  cell_kind *kind;
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
  h.kind = vs_alloc(most, sizeof *h.kind);
  h.unit = vs_alloc(most, sizeof *h.unit);
  h.count = vs_csv_split(h.text, h.name, most, NULL);
  return h;
}

static void free_header(header *h) {
  for (size_t k = 0; k < h->count; k++) free(h->unit[k]);
  free(h->unit);
  free(h->text);
  free(h->name);
  free(h->kind);
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

/* An axis with a unit is a number; one without may be a choice or a file's name. */
static cell_kind kind_of_axis(const char *column, const char *manifest) {
  char *unit = find_unit(column, manifest);
  const bool none = unit[1] == '"';
  free(unit);
  return none ? WORD : NUMBER;
}

/* Of a column that is no axis. */
static cell_kind kind_of_column(const char *name, bool failed) {
  static const struct {
    const char *name;
    cell_kind kind;
  } KNOWN[] = {{"case", COUNT},   {"id", ANY},         {"rung", COUNT},   {"weakest", ANY},
               {"happened", ANY}, {"not_judged", ANY}, {"warnings", ANY}, {"why", ANY}};
  if (!strcmp(name, "status")) return failed ? FAILED : DONE;
  for (size_t k = 0; k < sizeof KNOWN / sizeof *KNOWN; k++)
    if (!strcmp(name, KNOWN[k].name)) return KNOWN[k].kind;
  return NUMBER_OR_NOTHING;
}

/* The case comes first. The axes stand behind it and its id, in both headers. */
static void find_kinds(header *h, const header *other, bool failed, const char *manifest) {
  bool alike = true;
  for (size_t k = 0; k < h->count; k++) {
    alike = alike && k < other->count && !strcmp(h->name[k], other->name[k]);
    h->kind[k] = k == 0           ? COUNT
                 : k > 1 && alike ? kind_of_axis(h->name[k], manifest)
                                  : kind_of_column(h->name[k], failed);
  }
}

vs_row_shape *vs_row_shape_new(const char *columns, const char *failures, const char *manifest) {
  vs_row_shape *shape = vs_alloc(1, sizeof *shape);
  shape->done = cut_header(columns);
  shape->failed = cut_header(failures);
  find_kinds(&shape->done, &shape->failed, false, manifest);
  find_kinds(&shape->failed, &shape->done, true, manifest);
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
  static const vs_row_shape_holds HOLDS[] = {
      [ANY] = VS_ROW_WORDS,      [WORD] = VS_ROW_EITHER,
      [NUMBER] = VS_ROW_NUMBERS, [NUMBER_OR_NOTHING] = VS_ROW_NUMBERS,
      [COUNT] = VS_ROW_WHOLE,    [DONE] = VS_ROW_WHOLE,
      [FAILED] = VS_ROW_WHOLE};
  const header *h = &shape->done;
  return (vs_row_shape_column){h->name[k], h->unit[k], HOLDS[h->kind[k]]};
}

bool vs_row_shape_is_number(const char *cell) {
  char *end;
  return *cell && !cell[strspn(cell, "0123456789.eE+-")] && isfinite(strtod(cell, &end)) && !*end;
}

static bool is_count(const char *cell) {
  return *cell && !cell[strspn(cell, "0123456789")] && (*cell != '0' || !cell[1]);
}

static bool cell_holds(const char *cell, cell_kind kind) {
  switch (kind) {
  case WORD:
    return *cell;
  case NUMBER:
    return vs_row_shape_is_number(cell);
  case NUMBER_OR_NOTHING:
    return !*cell || vs_row_shape_is_number(cell);
  case COUNT:
    return is_count(cell);
  case DONE:
    return !strcmp(cell, "0") || !strcmp(cell, "3");
  case FAILED:
    return !strcmp(cell, "1");
  default:
    return true;
  }
}

static void count_row_cells(const header *h, char *const *cell, vs_row_shape_counts *counts) {
  *counts = (vs_row_shape_counts){0};
  for (size_t k = 0; k < h->count; k++)
    if (k == 0)
      counts->index = strtoull(cell[k], NULL, 10); /* UINT64_MAX where it is too large */
    else if (h->kind[k] == DONE)
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
  while (fits && k < n && cell_holds(cell[k], h->kind[k])) k++;
  if (fits && k < n) {
    fits = false;
    *at = (size_t)(cell[k] - copy);
    snprintf(why, size, "column %.64s holds '%.64s'; %s is wanted there", h->name[k], cell[k],
             WANTED[h->kind[k]]);
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
