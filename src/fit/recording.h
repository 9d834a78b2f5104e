/* SPDX-License-Identifier: GPL-3.0-or-later
 * What instruments recorded: a CSV file whose first column is the time and whose other columns are
 * channels of a run, each with its unit in its name, as p_mm or p [mm]. */
#ifndef VS_FIT_RECORDING_H
#define VS_FIT_RECORDING_H

#include "scene/scene.h"

/* A column that is fitted. */
typedef struct vs_recorded {
  char name[VS_NAME_SIZE]; /* of the channel */
  int channel;
  const char *unit;               /* of the channel; borrowed from the scene */
  vs_where where;                 /* in the fit file */
  double error;                   /* SI; NaN: it stands in a column NAME_error of its own */
  int cell, cell_of_error;        /* where in a row, from 0; -1: nowhere */
  double factor, factor_of_error; /* from the file's unit to SI */
  size_t samples;
} vs_recorded;

/* One number that was recorded. */
typedef struct vs_sample {
  int column;               /* of vs_recording.columns */
  double t_s, value, error; /* SI */
  vs_where where;
} vs_sample;

typedef struct vs_recording {
  char path[VS_PATH_SIZE];
  vs_recorded *columns;
  size_t n_columns;
  vs_sample *samples; /* in the order of their times */
  size_t n_samples;
  double from_s, to_s; /* the stretch that is fitted */
  size_t outside;      /* rows that lie outside of that stretch */
  size_t empty;        /* cells of fitted columns that hold nothing */
  vs_text unused;      /* names of the file's other columns, with commas */
} vs_recording;

/* Reads the map `data` of a fit file:
 *
 *   {file: NAME, columns: {p: 4 um, i: {error: 3 mA}}, from: 5 ms, to: 0.2 s}
 *
 * A column without an error takes it from the file's column of the same name with _error. The file
 * is looked for beside the fit file `beside`. Errors, with their places: unknown keys, channels,
 * columns; a column without a unit or with one of another kind; a cell that is no number; times
 * that do not rise or lie outside of the run; an error that is not above 0; no sample at all.
 * vs_recording_free even then. */
vs_status vs_recording_read(vs_recording *recording, const vs_node *data, const char *beside,
                            const vs_scene *scene, vs_error *err);
void vs_recording_free(vs_recording *recording);

#endif
