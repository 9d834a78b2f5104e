/* SPDX-License-Identifier: GPL-3.0-or-later
 * The curves that a run has recorded: run.csv of its folder, read into memory. If the curves have
 * peaks between the rows of run.csv, peaks.csv beside it has the same rows and more (run/table.h);
 * that is the file to draw. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/path.h"
#include "engine/channel.h"

/* Begins as {0}; vs_traces_free is due even after an error. */
typedef struct vs_traces {
  char path[VS_PATH_SIZE];  /* of run.csv */
  char drawn[VS_PATH_SIZE]; /* of the file to draw, with the same columns */
  size_t drawn_rows;        /* at least as many as run.csv has */
  char **name;              /* [columns]; the first is "t_s" */
  vs_column *column;        /* [columns], what they are */
  double *value;            /* [rows * columns], row by row; NaN: the cell is empty */
  size_t columns, rows;     /* at least one row */
} vs_traces;

/* True if the folder has a run's files: run.csv, run.partial.csv or summary.json, and no
 * manifest.json of a study. */
bool vs_traces_here(const char *folder);

/* Says why a folder has no run.csv, which could not be opened for `why`: a run that did not end
 * well, a study that was broken off, or nothing. */
vs_status vs_traces_none(const char *folder, int why, vs_error *err);

/* Reads the file. Errors, VS_INPUT, with their line: there is no file, or only that of a run that
 * failed; the first column is not t_s; a row has more or fewer cells than the header, a cell is no
 * number, the time decreases. */
vs_status vs_traces_read(const char *folder, vs_traces *traces, vs_error *err);
/* Finds the file to draw of a run: peaks.csv if there is one, else run.csv, whose first line is
 * `header`, without its line break. rows: how many rows peaks.csv has; 0: there is none. Errors,
 * VS_INPUT: peaks.csv cannot be read, or has other columns. */
vs_status vs_traces_drawn(const char *folder, const char *header, char drawn[VS_PATH_SIZE],
                          size_t *rows, vs_error *err);
void vs_traces_free(vs_traces *traces);

/* Returns the meaning of the columns in this header, for the caller to free(), as the folder's
 * summary.json has it. A case that a study has stored, and a run of an older version, have no such
 * entry. Then the columns' names tell which are coordinates with a rate and an acceleration, what
 * belongs to a control, and some units; the other roles stay unknown. */
vs_column *vs_traces_columns(const char *folder, const char *header, size_t *count);

/* Returns the column's number from 0; -1: there is none of that name. */
int vs_traces_find(const vs_traces *traces, const char *name);
/* The same for a column that also has the other column's unit and role, where both are known. */
int vs_traces_like(const vs_traces *traces, const vs_column *other);

/* Return the value of a column in that row, and the row's time, s. */
double vs_trace_value(const vs_traces *traces, size_t row, int column);
double vs_trace_time(const vs_traces *traces, size_t row);
