/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study's rows as the folder DIR/columns: for each column of study.csv a file COLUMN.npy, a
 * vector in the format of numpy, version 1.0 (https://numpy.org/neps/nep-0001-npy-format.html), in
 * the order of the rows. Its elements, all little-endian:
 *
 *   <i8    a whole number (case, rung, status);
 *   <f8    a number, of the 12 digits that study.csv has; NaN where the cell there is empty;
 *   |S16   the case's id;
 *   <i4    which of the column's words the cell is, from 0.
 *
 * A slash in a column's name is an underscore in its file's. columns.json lists rows, columns,
 * their files, element types, units and words. It is removed first and written last: with it the
 * folder is whole. */
#pragma once

#include <stdint.h>

#include "base/error.h"
#include "workers/row_shape.h"

#define VS_ARRAY_FOLDER "columns"
#define VS_ARRAY_LIST VS_ARRAY_FOLDER "/columns.json"

/* The columns of a study that are being written. */
typedef struct vs_npy vs_npy;

/* The shape is borrowed. vs_npy_free; NULL is nothing. Files that were not committed by then are
 * removed. */
vs_npy *vs_npy_new(const vs_row_shape *shape);
void vs_npy_free(vs_npy *array);

/* True if only the rows tell whether some column is words or numbers: then each is shown to
 * vs_npy_look before the files are opened. */
bool vs_npy_must_look(const vs_npy *array);
/* The row is cut up, here and below. It must have the shape. */
void vs_npy_look(vs_npy *array, char *row);

/* Makes the folder in `folder`, and begins the files. rows: how many will be added. Error: one
 * cannot be written. */
vs_status vs_npy_open(vs_npy *array, const char *folder, uint64_t rows, vs_error *err);
/* Error: the row's id is no id. */
vs_status vs_npy_add(vs_npy *array, char *row, vs_error *err);
/* Gives all files their names. Errors: one cannot be written; there were more or fewer rows. */
vs_status vs_npy_commit(vs_npy *array, vs_error *err);

/* Removes from the folder, which is open as `folder`, what a study with this header row has left as
 * columns, and the folder of columns if it is empty then. What is a link stays. */
void vs_npy_remove(int folder, const char *header);
