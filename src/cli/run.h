/* SPDX-License-Identifier: GPL-3.0-or-later
 * A run of one scene as the command `run` does it, for other commands too. */
#pragma once

#include "options.h"
#include "run/summary.h"
#include "run/table.h"

/* What another command makes of a run of its own. Members may be NULL. */
typedef struct vs_run_more {
  void *ctx;
  void (*begin)(void *ctx, vs_scene *scene);          /* an attempt at the run begins */
  void (*accept)(void *ctx, const vs_step *step);     /* is shown every step */
  void (*finish)(void *ctx, const vs_result *result); /* the run is whole; nothing is written */
  void (*show)(const void *ctx, FILE *out);           /* prints what stands before the table */
  vs_summary_more summary;                            /* what is added to summary.json */
  const vs_table_reader *reader; /* of the rows; then one run alone has the process */
} vs_run_more;

/* Runs a scene that was read, writes its files and prints its table. more: what another command
 * adds; NULL: nothing. Errors: VS_INPUT, with nothing written; VS_RUN and VS_SIGNAL, which leave
 * run.partial.csv (and run.partial.raw) in the folder; VS_RATING, all is written and a line of the
 * verdict is violated or undecided. */
vs_status vs_run_scene(const vs_run_options *options, const vs_run_more *more, vs_scene *scene,
                       vs_error *err);

/* For a reader that makes a copy of the process on the way: writes out what the files have, before;
 * and goes on with files of its own, in the copy. Error: as vs_file_part. */
void vs_run_flush(void);
vs_status vs_run_part(vs_error *err);
