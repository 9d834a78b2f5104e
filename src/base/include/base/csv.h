/* SPDX-License-Identifier: GPL-3.0-or-later
 * Rows of comma-separated values, as RFC 4180 has them: a cell in double quotes may hold commas,
 * line breaks and quotes, of which each is written twice. */
#pragma once

#include <stdbool.h>
#include <stdio.h>

#include "base/error.h"
#include "base/text.h"

/* The longest row, in bytes. A run of thirty thousand probes has such rows. */
enum { VS_CSV_LONGEST = 1 << 20 };

/* A file of rows that is being read. Fill the first group, leave the rest 0; vs_csv_free it. */
typedef struct vs_csv {
  const char *file; /* its name, for errors; borrowed */
  FILE *stream;     /* borrowed, open for reading */
  bool trim;        /* blanks around cells do not belong to them */
  bool comments;    /* blank lines, and lines whose first character is '#', are no rows */
  bool guess;       /* where the first row has no comma, semicolons stand between cells, or tabs */

  /* The present row. It lasts until the next is read. */
  char **cell;
  vs_where *where; /* of each cell: its line, and the byte at which it begins, from 1 */
  size_t count;    /* of cells; an empty line is one empty cell; 0: the file has ended */
  int line;        /* on which the row begins, from 1; at the file's end the last one's, or 1 */

  /* The reader's own. */
  char separator; /* what stands between cells; 0 before the first row: a comma */
  char *text;     /* the row's bytes */
  size_t *begins; /* where in text each of the row's n_lines lines begins */
  size_t n_lines, room, most;
} vs_csv;

/* Reads the next row. A byte order mark before the first is passed over. Errors, with
 * file:line:column: a quoted cell that does not end, or is followed by something else than a comma;
 * a zero byte; a row that is too long; a file that cannot be read. */
vs_status vs_csv_next(vs_csv *csv, vs_error *err);
void vs_csv_free(vs_csv *csv);

/* True if the row holds nothing but blanks. */
bool vs_csv_is_blank(const vs_csv *csv);

/* What is wrong with a row. */
typedef struct vs_csv_flaw {
  const char *why; /* NULL: nothing is */
  size_t at;       /* where in the row, from 0 */
} vs_csv_flaw;

/* Cuts a row that is in memory, and has no line end, into its cells; quotes are taken off in place.
 * Returns how many there are, at most `most`. *flaw is the first thing that is wrong with them, as
 * vs_csv_next refuses it, or a line end, which another reader would take for the row's; NULL: it
 * does not matter. */
size_t vs_csv_split(char *row, char **cells, size_t most, vs_csv_flaw *flaw);

/* Adds one cell, in quotes where a comma, a quote or a line break asks for them. A line break is
 * written as a blank, so that each row of ours is one line. */
void vs_csv_cell(vs_text *row, const char *word);
