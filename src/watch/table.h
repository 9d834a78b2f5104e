/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that writes channels at fixed instants as CSV, while the run goes on. */
#ifndef VS_WATCH_TABLE_H
#define VS_WATCH_TABLE_H

#include <stdio.h>

#include "sim/step.h"

/* All but `next` is set by the caller, who owns stream and frame. */
typedef struct vs_table {
  FILE *stream;
  const vs_frame *frame;
  int channels[VS_CH_MOST], count; /* which channels, in the order of the columns */
  int digits;                      /* significant ones, 1..17 */
  double sample_s;                 /* from row to row */
  double until_s;                  /* end of the run */
  double next; /* number of the next row, from 0; its instant is next * sample_s */
} vs_table;

/* Writes the header row: t_s, then name_unit of each channel. */
void vs_table_begin(vs_table *table);
/* Writes the rows that fall into the step. The first step also brings the row at its beginning.
 * Error: VS_RUN, the stream cannot be written. */
vs_status vs_table_accept(vs_table *table, const vs_step *step, vs_error *err);

#endif
