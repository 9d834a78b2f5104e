/* SPDX-License-Identifier: GPL-3.0-or-later
 * Columns of a recording that are fitted, and where a CSV file has them. A column is a channel of a
 * run, as p, or what an instrument shows of one, as p_meas (measure/instruments.h). In the file
 * its name has its unit, as p_mm or p [mm]. */
#ifndef VS_FIT_COLUMNS_H
#define VS_FIT_COLUMNS_H

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

/* Reads the map `columns` of a fit file, NAME: ERROR, NAME: {error: ERROR} or NAME alone. An
 * instrument without a stated error has that of its noise and its A/D together. Errors: no such
 * channel or instrument; an error that is not above 0, or a share. vs_columns_free even then. */
vs_status vs_columns_read(vs_columns *columns, const vs_node *map, const vs_scene *scene,
                          vs_error *err);
void vs_columns_free(vs_columns *columns);

/* Finds the columns in a file's header; *time_s becomes the unit of its first column. Errors: a
 * column that is wanted is not there or is there twice, or has no unit of its kind; there is no
 * error for it. */
vs_status vs_columns_find(vs_columns *columns, const vs_csv *header, double *time_s, vs_error *err);

#endif
