/* SPDX-License-Identifier: GPL-3.0-or-later
 * The numbers of the verdict's lines, as columns of a study and as what sensitivities are of. */
#pragma once

#include "run/listed_measure.h"

enum { VS_LINE_NUMBERS = 3 };
/* True for the name of such a number, or of the column that holds it. */
bool vs_listed_line_is(const char *name);
/* True if that is a number ("margin.LINE") of this line; what happened has none. */
bool vs_listed_line_is_of(const char *number, const vs_judgement *line);
/* The weakest line whose number has that name ("margin.LINE"), a waived one last; NULL: the verdict
 * has no such line. */
const vs_judgement *vs_listed_line_find(const vs_verdict *verdict, const char *number);
/* That number of the line. Not known: the line is NULL, or has no such number; a margin of NaN: the
 * line has nothing to judge. */
vs_value vs_listed_line_value(const vs_judgement *line, const char *number);
/* Fills `shown` with the k-th number of the lines, from 0, and returns true; false: there are no
 * more. Each line has three: "margin.LINE" and "error.LINE", which are parts of the limit, and
 * "at.LINE", s. LINE is its name (vs_verdict_name). The lines are those that the scene may have: of
 * its deck's ratings, of its own, and of its devices' limits. Of one that the result does not have
 * no number is known. Where a probe has several ratings, the one with the least margin counts. */
bool vs_listed_line_at(const vs_frame *frame, const vs_result *result, int k,
                       vs_listed_measure *shown);
