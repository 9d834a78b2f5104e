/* SPDX-License-Identifier: GPL-3.0-or-later
 * The answer of a design, for people and in files:
 *
 *   design.json   the choice, its price, the least margin of each part, neighbours, the proof
 *   design.csv    a row a candidate that was looked at, what rejected it, and its runs
 *   design.txt    the page that `design` prints
 *   bom.csv       a row a part: how many, and its row of the list of prices
 *   cases/N.yaml  the cases that decide, as scenes; N is their number in study.csv */
#pragma once

#include "study/plan.h"

extern const char *const vs_design_answer_files[];

/* vs_method.publish. Errors: VS_RATING, nothing holds; VS_BUDGET; VS_RUN, a candidate could not be
 * judged, or a file cannot be written. */
vs_status vs_design_answer_publish(const vs_plan *plan, const vs_plan_stage *stage,
                                   const vs_results *results, const char *folder, bool quiet,
                                   vs_error *err);
