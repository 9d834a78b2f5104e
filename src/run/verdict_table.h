/* SPDX-License-Identifier: GPL-3.0-or-later
 * The verdict of a run as a table for people. Limits and stresses are shown in the unit that the
 * rating's or the limit's line was written in. */
#pragma once

#include <stdio.h>

#include "run/result.h"

/* Prints all of the verdict: its word, the weakest line, the first to fail, every line. */
void vs_verdict_table_whole(const vs_result *result, FILE *out);

/* ---- its parts, for a table in short ---- */

/* The word of the whole, that of the worst corner where corners were run. It is coloured where
 * people look. */
void vs_verdict_table_word(const vs_result *result, FILE *out);
/* What happened, the weakest line, the first to fail, what is undecided, and the worst corner. */
void vs_verdict_table_head(const vs_result *result, FILE *out);
/* The weakest lines and the tightest one of each other device, as far as `room` lines go. */
void vs_verdict_table_tightest(const vs_verdict *verdict, int room, FILE *out);
/* What is not judged, the first few by name. */
void vs_verdict_table_not_judged(const vs_result *result, FILE *out);
/* What was varied: nothing, or the corners, with the worst line of each. */
void vs_verdict_table_corners(const vs_result *result, FILE *out);
/* How the errors of the margins were found, and what would decide those that are not. */
void vs_verdict_table_second(const vs_result *result, FILE *out);

/* Something is limited, and nothing of that is judged. */
bool vs_verdict_table_judges_nothing(const vs_result *result);
/* Why there is no verdict, and how to have one. */
void vs_verdict_table_none(const vs_result *result, FILE *out);
