/* SPDX-License-Identifier: GPL-3.0-or-later
 * What was recorded of a run: a CSV file whose first column is the time and whose other columns are
 * the columns that are fitted (vs_recorded).
 *
 * An instrument shows a sample until it takes the next one, at 0, 1/rate, 2/rate, ... A row at
 * another instant either shows the sample before (`rows: held`, as the program's own run.csv does),
 * or its time is the instant of a sample that was taken there (`rows: taken`). */
#pragma once

#include "base/csv.h"
#include "run/scene.h"

/* At most. */
enum { VS_COLUMNS_MOST = 64, VS_COLUMNS_CELLS = 512 };

/* A column that is fitted. */
typedef struct vs_recorded {
  char name[VS_NAME_SIZE]; /* of the channel, or of the instrument's column */
  int channel;
  int instrument;   /* place among the scene's instruments; -1: the channel itself was recorded */
  double rate_hz;   /* of that instrument */
  double ends[2];   /* SI; a sample beyond them tells only that its A/D was at an end of its range;
                       infinite: there is no A/D */
  const char *unit; /* of the channel; borrowed from the scene */
  double si;        /* the value of one such unit */
  vs_where where;   /* in the fit file */
  double error;     /* SI; NaN: it stands in a column NAME_error of its own */
  bool own;         /* the error is that of the instrument */
  int cell, cell_of_error;        /* where in a row, from 0; -1: nowhere */
  double factor, factor_of_error; /* from the file's unit to SI */
  size_t samples;
  double last_s; /* instant of the last sample; -INFINITY before it */
} vs_recorded;

typedef struct vs_columns {
  vs_recorded *item; /* [count]; owned */
  size_t count;
  vs_text unused; /* names of the file's other columns, with commas; owned */
} vs_columns;

/* One number that was recorded. */
typedef struct vs_sample {
  int column;               /* of vs_recording.columns */
  double t_s, value, error; /* SI; the instant at which it was taken */
  vs_where where;
} vs_sample;

/* What a row at an instant at which its instrument takes no sample shows. */
typedef enum vs_rows_word { VS_ROWS_UNSAID = -1, VS_ROWS_TAKEN, VS_ROWS_HELD } vs_rows_word;

typedef struct vs_recording {
  char path[VS_PATH_SIZE];
  vs_columns columns;
  vs_rows_word rows;
  vs_sample *samples; /* in the order of their instants; owned */
  size_t n_samples;
  double from_s, to_s; /* the stretch that is fitted */
  size_t outside;      /* rows that lie outside of that stretch */
  size_t empty;        /* cells of fitted columns that hold nothing, or nan */
  size_t again;        /* cells that show a sample which an earlier row has shown */
  size_t at_end;       /* samples at an end of their A/D's range */
} vs_recording;

/* Reads the map `data` of a fit file:
 *
 *   {file: NAME, columns: {p: 4 um, i: {error: 3 mA}}, from: 5 ms, to: 0.2 s, rows: held}
 *
 * A column without an error takes it from the file's column of the same name with _error. The file
 * is looked for beside the fit file `beside`. Cells stand apart by commas; or, where the header has
 * none, by semicolons or tabs, and then a decimal comma is as good as a point. Errors, with their
 * places: unknown keys, channels, columns; a column without a unit or with one of another kind; a
 * cell that is no number; times that do not rise or lie outside of the run; an instant at which the
 * instrument takes no sample, where `rows` does not say what it shows; an error that is not above
 * 0; no sample at all. vs_recording_free even then. */
vs_status vs_recording_read(vs_recording *recording, const vs_node *data, const char *beside,
                            const vs_scene *scene, vs_error *err);
void vs_recording_free(vs_recording *recording);

/* For other CSV files that a fit names. The path of one: beside the fit file, or as it stands; key:
 * where it is named, for errors. The factor to SI if the cell is the column `name` with a unit of
 * that kind, as p_mm, p [mm], of a pure number p; NaN with *named set: it has the name, and no such
 * unit. The number in a cell. */
vs_status vs_recording_file(char path[VS_PATH_SIZE], const char *key, const vs_node *file,
                            const char *beside, vs_error *err);
double vs_recording_factor(const char *cell, const char *name, const char *unit, bool *named);
vs_status vs_recording_number(const vs_csv *csv, size_t cell, double *value, vs_error *err);
