/* SPDX-License-Identifier: GPL-3.0-or-later
 * Compares two runs: the keys of their scenes that differ, measures, verdicts, curves. */
#pragma once

#include "base/text.h"
#include "base/tree.h"
#include "traces.h"

/* Begins as {0}; vs_run_pair_close is due even after an error. Index 0 is run A, 1 is run B. */
typedef struct vs_run_pair {
  const char *folder[2];
  vs_tree summary[2];
  vs_traces traces[2];
} vs_run_pair;

/* Reads both runs. Errors, VS_INPUT: summary.json or run.csv is missing or broken. */
vs_status vs_run_pair_open(vs_run_pair *pair, const char *a, const char *b, vs_error *err);
void vs_run_pair_close(vs_run_pair *pair);

/* Returns the word of a line of summary.json's verdict; and the word of the whole, which is that of
 * its worst line. */
const char *vs_run_pair_word(const vs_node *line);
const char *vs_run_pair_whole(const vs_node *verdict);

/* The first adds the table for people, the second the same as one JSON object. */
void vs_run_pair_table(const vs_run_pair *pair, vs_text *out);
void vs_run_pair_json(const vs_run_pair *pair, vs_text *out);
