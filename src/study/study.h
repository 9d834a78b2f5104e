/* SPDX-License-Identifier: GPL-3.0-or-later
 * The commands `study` and `merge`, and what `check` says of a study. */
#ifndef VS_STUDY_STUDY_H
#define VS_STUDY_STUDY_H

#include <signal.h>

#include "command/check.h"
#include "study/journal.h"
#include "study/plan.h"

typedef struct vs_study_options {
  const char *name, *folder; /* folder: NULL, then study.csv goes to standard output */
  char *const *sets;
  size_t n_sets;
  int jobs;          /* worker processes; 0: one for each core this process may use */
  const char *shard; /* "I/N", "auto" (Slurm's array variables); NULL: all */
  bool resume;       /* go on with what the folder has of this study */
  bool overwrite;    /* replace what the folder has of any; else it is refused */
  bool keep_runs, progress_json, quiet;
  double timeout_s;                  /* of one case; 0: none */
  const volatile sig_atomic_t *stop; /* set by a signal: end, to be gone on with */
} vs_study_options;

/* Errors: VS_INPUT, with nothing written; VS_RUN, a case failed, or a file could not be written;
 * VS_RATING, all cases ran, and in some a rating is violated; VS_SIGNAL. */
vs_status vs_study_command(const vs_study_options *options, vs_error *err);

typedef struct vs_merge_options {
  char *const *folders; /* of shards, or that hold such */
  size_t count;
  const char *folder; /* where the result goes; NULL: the one folder named */
  bool overwrite;     /* over another study's result, too; else that is refused */
  bool quiet;
} vs_merge_options;

/* Joins shards. Errors: a case missing or done twice, shards of different studies, another study's
 * result where this one's shall go. */
vs_status vs_merge_command(const vs_merge_options *options, vs_error *err);

/* Is the file a study, rather than a scene? A name: does a study of that name come with the
 * program, and no scene? */
bool vs_study_is(const char *name);
vs_status vs_study_check(const vs_check_options *options, vs_text *good, vs_error *err);

/* "I/N" or "auto". Error: it is neither. */
vs_status vs_merge_shard_read(const char *text, uint64_t *shard, uint64_t *shards, vs_error *err);

/* For the journal: what identifies the plan, and the parts of its manifest. name: as given. */
void vs_manifest_head(const vs_plan *plan, const char *name, vs_journal_head *head);

#endif
