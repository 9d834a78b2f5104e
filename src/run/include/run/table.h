/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that writes channels at fixed instants as CSV, while the run goes on, and beside them
 * what instruments show of them, and what a control does.
 *
 * Rows at fixed instants miss what is over between two of them. So a second file may be written: it
 * has the same columns and the same rows, and further rows between these. A further row stands
 * where a channel is largest or least between two rows, and passes both by more than 2 % of the
 * channel's range up to there. For an extreme that the run tells 0.5 % of itself is enough, and a
 * millionth of the range, as whoever reads the file is to find the run's extremes to 1 %. Two more
 * rows stand at the peak's feet, the nearest instants before and behind it at which a tenth of its
 * height is left, so that a curve through the rows is about as wide as the peak is. Instants are
 * the ends of steps, and those at which the measures have found an extreme within a step. */
#pragma once

#include <stdio.h>

#include "control/loop.h"
#include "measure/measures.h"
#include "run/scene.h"

/* The second file's name in a run's folder. */
#define VS_TABLE_PEAKS_FILE "peaks.csv"

/* What is seen from one row to the next. */
typedef struct vs_table_between vs_table_between;

struct vs_table;

/* Someone who is shown the rows, and may ask for instants between them. */
typedef struct vs_table_reader {
  void *ctx;
  /* Called where everything up to t_s is seen and what is behind it is not: before each row, and at
   * the step's end. vs_table_peek tells of instants of the step that lie behind the last row, up to
   * t_s. A status other than VS_OK ends the run. */
  vs_status (*reach)(void *ctx, const struct vs_table *table, const vs_step *step, double t_s,
                     vs_error *err);
  /* A row: cell[width]. */
  vs_status (*row)(void *ctx, const double *cell, int width, vs_error *err);
} vs_table_reader;

/* All but `next` and `between` is set by the caller, who owns what it points to. */
typedef struct vs_table {
  FILE *stream;      /* of a file that can be read, too, where `peaks` is there; NULL: the rows are
                        for the reader alone */
  FILE *peaks;       /* where the further rows stand among the others; NULL: nowhere */
  double peaks_most; /* bytes that `peaks` may have; nothing is written to it beyond them */
  const vs_frame *frame;
  int channels[VS_CH_MOST], count;   /* which channels, in the order of the columns */
  const vs_instruments *instruments; /* whose columns stand behind; NULL: none */
  vs_meter *meters; /* theirs, in the same order, which the table asks before whoever else takes
                       them on to the step's end */
  const vs_control *control;     /* whose columns stand behind those; NULL: there is none */
  vs_loop *loop;                 /* of the run, which the table asks as it does the meters */
  const vs_measures *measures;   /* of the run, which have seen the step before the table; NULL: no
                                    further row stands within a step */
  const vs_table_reader *reader; /* NULL: nobody */
  int digits;                    /* significant ones, 1..17 */
  double sample_s;               /* from row to row */
  double until_s;                /* end of the run */
  double next;               /* number of the next row, from 0; its instant is next * sample_s */
  vs_table_between *between; /* owned; vs_table_begin makes it, and vs_table_end frees it */
} vs_table;

/* Returns the table of what the scene records, to 9 digits, without files and what the run makes.
 */
vs_table vs_table_of(const vs_scene *scene);
/* Fills in the table's k-th column, from 0, by which its header is written and summary.json tells
 * what the columns are. False: there are no more. */
bool vs_table_column_at(const vs_table *table, int k, vs_column *column);

/* Returns how many bytes the file of the stream will have at most; that is a little more than it
 * will have. */
double vs_table_bytes(const vs_table *table);
/* Returns the place of the key that sets the number of rows, in the scene with that root. */
vs_where vs_table_where(const vs_node *scene);
/* Error, with its place in the scene whose root that is: the file would have more than so many
 * bytes. Its stream is not asked for. */
vs_status vs_table_check(const vs_table *table, const vs_node *scene, double most, vs_error *err);
/* Writes the header row: t_s, then name_unit of each channel, then NAME_meas_unit of each
 * instrument, then what the control has. */
void vs_table_begin(vs_table *table);
/* Writes the rows that fall into the step. The first step also brings the row at its beginning.
 * Error: VS_RUN, the stream cannot be written. */
vs_status vs_table_accept(vs_table *table, const vs_step *step, vs_error *err);

/* What the columns show at an instant, as vs_table_reader says; what a control shows is as of the
 * step's beginning. cell has room for the columns. */
void vs_table_peek(const vs_table *table, const vs_step *step, double at_s, double *cell);

/* What has become of the file `peaks`. */
typedef enum vs_table_peaks {
  VS_TABLE_NONE,  /* it has no further row: the stream's file shows every peak by itself */
  VS_TABLE_SOME,  /* it has some and is whole */
  VS_TABLE_BEYOND /* it would have more bytes than it may, and is of no use */
} vs_table_peaks;
vs_table_peaks vs_table_found(const vs_table *table);
/* Frees what vs_table_begin has made; may be called at any time. */
void vs_table_end(vs_table *table);
