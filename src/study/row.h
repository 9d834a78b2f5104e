/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a row of a study's journal must look like, by the header rows that stand at its head: how
 * many cells, and what each may hold. A sum that is right does not say that. */
#ifndef VS_STUDY_ROW_H
#define VS_STUDY_ROW_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

typedef struct vs_row vs_row;

/* columns, failures: header rows of study.csv and failures.csv; manifest: that part of it which
 * names the axes, with their units. All are copied from. vs_row_free; NULL is nothing. */
vs_row *vs_row_new(const char *columns, const char *failures, const char *manifest);
void vs_row_free(vs_row *shape);

/* What a row says by which it is counted, whether its cells stand in quotes or not. */
typedef struct vs_row_counts {
  uint64_t index; /* the case's; UINT64_MAX: too large for any */
  bool violated;  /* status 3 */
} vs_row_counts;

/* Is it one? failed: a row of failures.csv. If not, why says what is wrong and what would be right,
 * and *at where in the row, from 0. */
bool vs_row_read(const vs_row *shape, bool failed, const char *row, vs_row_counts *counts,
                 size_t *at, char *why, size_t size);

#endif
