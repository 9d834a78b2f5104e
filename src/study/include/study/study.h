/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `study`. */
#pragma once

#include <signal.h>

#include "study/format.h"
#include "study/method.h"

typedef struct vs_study_options {
  const char *name, *folder;       /* folder: NULL, then study.csv goes to standard output */
  const vs_method *const *methods; /* all there are; NULL ends them */
  const vs_method *method;         /* which the study has to ask for; NULL: any */
  char *const *sets;
  size_t n_sets;
  const vs_format *format; /* of the result */
  int jobs;                /* worker processes; 0: one for each core this process may use */
  const char *shard;       /* "I/N", "auto" (vs_merge_shard_read); NULL: all cases */
  bool resume;             /* goes on with what the folder has of this study */
  bool again;              /* with resume: runs the cases again that failed */
  bool overwrite;          /* replaces what the folder has of any study; else that is refused */
  bool alone; /* each case is run from its beginning, also where some share their past */
  bool keep_runs, progress_json, quiet;
  bool allow_code;                   /* the cases may run code of their scene's own */
  double timeout_s;                  /* of one case; 0: none */
  const volatile sig_atomic_t *stop; /* set by a signal: end, to be gone on with */
} vs_study_options;

/* Runs the study. Errors: VS_INPUT, and nothing is written; VS_RUN, a case failed, or a file could
 * not be written; VS_RATING, all cases ran, and in some a rating is violated; VS_SIGNAL. */
vs_status vs_study_command(const vs_study_options *options, vs_error *err);
