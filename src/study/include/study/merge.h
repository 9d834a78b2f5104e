/* SPDX-License-Identifier: GPL-3.0-or-later
 * Shards of a study: which of its cases one process runs, and how the shards become one (the
 * command `merge`). */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/error.h"
#include "study/format.h"

/* Reads "I/N", or "auto", which stands for the variables of a Slurm job array; I counts from 1.
 * Error: the text is neither. */
vs_status vs_merge_shard_read(const char *text, uint64_t *shard, uint64_t *shards, vs_error *err);

typedef struct vs_merge_options {
  char *const *folders; /* of shards, or that hold such */
  size_t count;
  const char *folder;      /* where the result goes; NULL: the one folder named */
  const vs_format *format; /* of the result */
  bool overwrite;          /* another study's result there is replaced; else it is refused */
  bool quiet;
} vs_merge_options;

/* Joins the shards in the folders to one result. Errors: VS_INPUT, a case is missing or done twice,
 * the shards are of different studies, another study's result is where this one's shall go; VS_RUN,
 * a case had failed, or a file could not be written; VS_RATING, in some a rating is violated. */
vs_status vs_merge_command(const vs_merge_options *options, vs_error *err);
