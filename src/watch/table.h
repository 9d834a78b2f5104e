/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that writes channels at fixed instants as CSV, while the run goes on, and beside them
 * what instruments show of them, and what a control does. */
#ifndef VS_WATCH_TABLE_H
#define VS_WATCH_TABLE_H

#include <stdio.h>

#include "control/loop.h"

/* All but `next` is set by the caller, who owns what it points to. */
typedef struct vs_table {
  FILE *stream;
  const vs_frame *frame;
  int channels[VS_CH_MOST], count;   /* which channels, in the order of the columns */
  const vs_instruments *instruments; /* whose columns stand behind; NULL: none */
  vs_meter *meters; /* theirs, in the same order, which the table asks before whoever else takes
                       them on to the step's end */
  const vs_control *control; /* whose columns stand behind those; NULL: there is none */
  vs_loop *loop;             /* of the run, which the table asks as it does the meters */
  int digits;                /* significant ones, 1..17 */
  double sample_s;           /* from row to row */
  double until_s;            /* end of the run */
  double next;               /* number of the next row, from 0; its instant is next * sample_s */
} vs_table;

/* Returns how many bytes the file will have at most; that is a little more than it will have. */
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

#endif
