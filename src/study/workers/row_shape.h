/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a row of a study's journal must look like, by the header rows that stand at its head: how
 * many cells, and what each may hold. A sum that is right does not say that. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "study/folder.h"

typedef struct vs_row_shape vs_row_shape;

/* columns, failures: header rows of study.csv and failures.csv; manifest: that part of it which
 * names the axes, with their units. All are copied from. vs_row_shape_free; NULL is nothing. */
vs_row_shape *vs_row_shape_new(const char *columns, const char *failures, const char *manifest);
void vs_row_shape_free(vs_row_shape *shape);

typedef struct vs_row_shape_column {
  const char *name; /* as the header has it; the shape's own */
  const char *unit; /* as JSON, in quotes; the shape's own. "" in quotes: none, or not known */
  vs_folder_cells cells;
  vs_folder_role role;
} vs_row_shape_column;
size_t vs_row_shape_columns(const vs_row_shape *shape);       /* how many columns study.csv has */
size_t vs_row_shape_first_measure(const vs_row_shape *shape); /* the first behind its axes */
vs_row_shape_column vs_row_shape_column_at(const vs_row_shape *shape, size_t k);

/* True if the program prints numbers like this one: finite, neither hexadecimal nor a blank before
 * it. */
bool vs_row_shape_is_number(const char *cell);

/* What a row says by which it is counted, whether its cells stand in quotes or not. */
typedef struct vs_row_shape_counts {
  uint64_t index; /* the case's; UINT64_MAX: too large for any */
  bool violated;  /* status 3 */
} vs_row_shape_counts;

/* Is it one? failed: a row of failures.csv. If not, why says what is wrong and what would be right,
 * and *at where in the row, from 0. */
bool vs_row_shape_read(const vs_row_shape *shape, bool failed, const char *row,
                       vs_row_shape_counts *counts, size_t *at, char *why, size_t size);

/* True for the row of that case, among those that vs_row_shape_read takes. */
bool vs_row_shape_is_of(const char *row, uint64_t index);
