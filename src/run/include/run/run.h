/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `run`: runs one scene, writes its files and prints its table. */
#ifndef VS_RUN_RUN_H
#define VS_RUN_RUN_H

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>

#include "run/summary.h"

/* The names, without .png or .svg, of the pictures that `plot` draws into a run's folder; NULL ends
 * them. A run over an older one removes them. */
extern const char *const vs_run_pictures[];

typedef struct vs_run_options {
  const char *scene, *tier; /* as for vs_scene_read */
  const char *folder;       /* for the files; NULL: none are written */
  char *const *sets;        /* KEY=VALUE of each --set */
  size_t n_sets;
  bool json;         /* prints JSON instead of the table */
  bool all;          /* the table leaves nothing out */
  bool quiet;        /* no table, no warnings, no progress */
  bool reproducible; /* leaves the cost out of summary.json */
  bool raw;          /* writes run.raw, too, which wants a folder and the circuit tier */
  bool allow_code;   /* the scene may run code of its own */
  bool corners;      /* runs the corners of the scene's key spread besides */
  const vs_corners
      *judged; /* what these came to; NULL: they were not run. vs_run_command sets it */
  vs_status (*steady)(vs_scene *scene, vs_error *err); /* as in vs_session */
  int digits;                                          /* significant ones in CSV files, 1..17 */
  const volatile sig_atomic_t *stop; /* set by a signal: the run ends and keeps what there is */
} vs_run_options;

/* What another command makes of a run of its own. Members may be NULL. */
typedef struct vs_run_more {
  void *ctx;
  void (*begin)(void *ctx, vs_scene *scene);          /* an attempt at the run begins */
  void (*accept)(void *ctx, const vs_step *step);     /* is shown every step */
  void (*finish)(void *ctx, const vs_result *result); /* the run is whole; nothing is written */
  void (*show)(const void *ctx, FILE *out);           /* prints what stands before the table */
  vs_summary_more summary;                            /* what is added to summary.json */
} vs_run_more;

/* Runs a scene that was read, writes its files and prints its table, as `run` does. more: what
 * another command adds; NULL: nothing. Errors: as of vs_run_command. */
vs_status vs_run_scene(const vs_run_options *options, const vs_run_more *more, vs_scene *scene,
                       vs_error *err);

/* Errors: VS_INPUT, with nothing written; VS_RUN and VS_SIGNAL, which leave run.partial.csv (and
 * run.partial.raw) in the folder; VS_RATING, all is written and a line of the verdict is violated
 * or undecided. */
vs_status vs_run_command(const vs_run_options *options, vs_error *err);

#endif
