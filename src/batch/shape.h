/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a row of a study's journal must look like, by the header rows that stand at its head: how
 * many cells, and what each may hold. A sum that is right does not say that. */
#ifndef VS_BATCH_SHAPE_H
#define VS_BATCH_SHAPE_H

#include <stdbool.h>
#include <stddef.h>

typedef struct vs_shape vs_shape;

/* columns, failures: header rows of study.csv and failures.csv; manifest: that part of it which
 * names the axes, with their units. All are copied from. vs_shape_free; NULL is nothing. */
vs_shape *vs_shape_new(const char *columns, const char *failures, const char *manifest);
void vs_shape_free(vs_shape *shape);

/* Is it one? failed: a row of failures.csv. If not, why says what is wrong and what would be right,
 * and *at where in the row, from 0. */
bool vs_shape_fits(const vs_shape *shape, bool failed, const char *row, size_t *at, char *why,
                   size_t size);

#endif
