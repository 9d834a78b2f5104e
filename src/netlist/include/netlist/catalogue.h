/* SPDX-License-Identifier: GPL-3.0-or-later
 * Parts that stand in a table: one law, and a row of numbers for each part. A table is a file
 * NAME.tab. It begins as a part's file does, with @COLUMN@ where a number of the row goes; behind a
 * line "*$ rows NAME COLUMN..." each line is a part. Such a part has the path TABLE.tab#NAME, and
 * is read as if it were a file of its own.
 *
 *   @NAME@, @SUBCKT@   the part's name, as written and in lower case
 *   @COLUMN@           the cell's number
 *   @COLUMN?@          the word assumed where a '?' stands behind the cell's number, typical where
 *                      it is a '~', else nothing
 *   a cell '-'         the source says nothing: lines "*$" that ask for it are left out */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/hash.h"
#include "base/path.h"
#include "netlist/source.h"

/* A part's lines. Begin with {0}; vs_catalogue_free is due also after an error. */
typedef struct vs_catalogue_part {
  vs_source source; /* without the table's comments */
  int *line;        /* for each line: the number, from 1, of the table's line that it stands for */
  int *column; /* for each byte of source.text: the column of the cell that it stands for; 0: the
                  line has no cell, and its columns are its own */
} vs_catalogue_part;

/* True for a path of the form TABLE.tab#NAME, be there such a row or not. */
bool vs_catalogue_is_row(const char *path);

/* Writes the path of the file: that of the table for a row, else the path itself. */
void vs_catalogue_file(const char *path, char file[VS_PATH_SIZE]);

/* Returns where the part's name begins in the path of a row or of a file, and its length without
 * the ending. */
const char *vs_catalogue_name(const char *path, size_t *length);

/* Reads a row as the lines of a part. Errors with the place in the table: there is no such row, it
 * stands there twice, cells are too few or too many, a cell is no number, a column is not known. */
vs_status vs_catalogue_read(const char *path, vs_catalogue_part *part, vs_error *err);
void vs_catalogue_free(vs_catalogue_part *part);

/* Finds the part that comes with the program: the file of that name on the shelf, or a row of a
 * table there, or one of these whose name differs in capitals alone. False: there is none. */
bool vs_catalogue_shipped(const vs_shelf *shelf, const char *name, char path[VS_PATH_SIZE]);

/* As vs_path_find, for files and rows. */
vs_status vs_catalogue_find(const vs_shelf *shelf, const char *name, vs_where where,
                            char path[VS_PATH_SIZE], vs_error *err);

/* Calls each(ctx, path) for every file on the shelf, as vs_path_list, then for every row of the
 * tables there. A table that cannot be read has no rows. */
void vs_catalogue_list(const vs_shelf *shelf, void (*each)(void *ctx, const char *path), void *ctx);

/* The SHA-256 of a file's contents, or of the lines that a row makes: another row may change
 * without changing it. Error: it cannot be read. */
vs_status vs_catalogue_hash(const char *path, char text[VS_HASH_TEXT], vs_error *err);
