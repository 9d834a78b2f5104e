/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `compare`: what two runs, or two studies, have in common and in what they differ. */
#pragma once

#include <stdbool.h>

#include "base/text.h"
#include "study/method.h"

typedef struct vs_compare_options {
  const char *a, *b; /* folders */
  bool json;
  const vs_method *const *methods; /* of studies; NULL ends them */
} vs_compare_options;

/* Adds the differences, as a table or as JSON. A difference is no failure, so the status is VS_OK.
 * Errors, VS_INPUT: a folder holds neither a run nor a study; one holds a run and the other a
 * study; a file in one is broken. */
vs_status vs_compare_tell(const vs_compare_options *options, vs_text *out, vs_error *err);
