/* SPDX-License-Identifier: GPL-3.0-or-later
 * The curves that a run has recorded: run.csv of its folder, read back into memory. Where peaks of
 * these lie between its rows, peaks.csv beside it has the same rows and more (run/table.h); that
 * is the file to draw. */
#ifndef VS_REPORT_TRACES_H
#define VS_REPORT_TRACES_H

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/path.h"
#include "engine/channel.h"

/* Start from {0}; vs_traces_free even after an error. */
typedef struct vs_traces {
  char path[VS_PATH_SIZE];  /* of run.csv */
  char drawn[VS_PATH_SIZE]; /* of what is to be drawn, with the same columns */
  size_t drawn_rows;        /* at least as many as run.csv has */
  char **name;              /* [columns]; the first is "t_s" */
  vs_column *column;        /* [columns], what they are */
  double *value;            /* [rows * columns], row by row; NaN: the cell is empty */
  size_t columns, rows;     /* at least one row */
} vs_traces;

/* True when the folder holds what a run leaves: run.csv, run.partial.csv or summary.json, and no
 * manifest.json of a study. */
bool vs_traces_here(const char *folder);

/* Reads the file. Errors, VS_INPUT: there is none, or only that of a run that did not end well; the
 * first column is not t_s; a row has more or fewer cells than the header, a cell is no number, the
 * time falls: each with its line. */
vs_status vs_traces_read(const char *folder, vs_traces *traces, vs_error *err);
/* Finds what is to be drawn of a run: peaks.csv where it is there, else run.csv, whose first line
 * is `header`, without its end. rows: how many peaks.csv has; 0 where it is not there. Errors,
 * VS_INPUT: peaks.csv cannot be read, or has other columns. */
vs_status vs_traces_drawn(const char *folder, const char *header, char drawn[VS_PATH_SIZE],
                          size_t *rows, vs_error *err);
void vs_traces_free(vs_traces *traces);

/* Returns what the columns of that header are, for the caller to free(): as summary.json in the
 * folder tells. None tells it of a case that a study has stored, nor of a run of an older version.
 * Their names tell, then, which coordinates there are, with a rate and an acceleration each, what a
 * control has, and some units; the role of the others is not known. */
vs_column *vs_traces_columns(const char *folder, const char *header, size_t *count);

/* Returns the column's number from 0; -1: there is none of that name. */
int vs_traces_find(const vs_traces *traces, const char *name);
/* The same of a column that has the other one's unit and role besides, where both are told. */
int vs_traces_like(const vs_traces *traces, const vs_column *other);

/* Returns the value in that row of a column, and the row's time, s. */
double vs_trace_value(const vs_traces *traces, size_t row, int column);
double vs_trace_time(const vs_traces *traces, size_t row);

#endif
