/* SPDX-License-Identifier: GPL-3.0-or-later
 * Two runs side by side: the keys of their scenes that differ, measures, verdicts, curves. */
#ifndef VS_REPORT_RUN_PAIR_H
#define VS_REPORT_RUN_PAIR_H

#include "base/text.h"
#include "base/tree.h"
#include "traces.h"

/* Start from {0}; vs_run_pair_close even after an error. Index 0 is run A, 1 is run B. */
typedef struct vs_run_pair {
  const char *folder[2];
  vs_tree summary[2];
  vs_traces traces[2];
} vs_run_pair;

/* Reads both runs. Errors, VS_INPUT: summary.json or run.csv is missing or broken. */
vs_status vs_run_pair_open(vs_run_pair *pair, const char *a, const char *b, vs_error *err);
void vs_run_pair_close(vs_run_pair *pair);

/* Returns the word of a line of summary.json's verdict, and that of the whole, which is its worst
 * line's. */
const char *vs_run_pair_word(const vs_node *line);
const char *vs_run_pair_whole(const vs_node *verdict);

/* Adds the table for people, and the same as one JSON object. */
void vs_run_pair_table(const vs_run_pair *pair, vs_text *out);
void vs_run_pair_json(const vs_run_pair *pair, vs_text *out);

#endif
