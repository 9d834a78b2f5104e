/* SPDX-License-Identifier: GPL-3.0-or-later
 * One case of a study, run in this process: its point is put, as keys, over the scene, the scene is
 * run once, and a row for study.csv or failures.csv comes of it. What is constant from case to case
 * is kept: the scene's tree, and the deck's text as long as neither deck nor parts change. */
#pragma once

#include "study/plan.h"

/* How a case ended. */
enum {
  VS_CASE_DONE = 0,
  VS_CASE_FAILED = 1,
  VS_CASE_VIOLATED = 3 /* it is done, and a rating is violated or undecided */
};

/* Runs cases, one after the other. */
typedef struct vs_case vs_case;

/* The plan is borrowed. keep is the folder in which each case's run.csv is stored, in a folder
 * named by the case's number; NULL: no run.csv is stored. */
vs_case *vs_case_new(const vs_plan *plan, const char *keep);
/* Frees it; for tools and tests, as a worker ends with its process. */
void vs_case_free(vs_case *c);

/* Error: a run.csv that is stored for the scene would have more bytes than its limits.csv, or that
 * many of them more than its limits.kept. */
vs_status vs_case_check_csv(const vs_scene *scene, uint64_t cases, vs_error *err);

/* Reads back a row that vs_case_run has added; the row's text is cut up. values[1 + n_columns] are
 * the least margin and the plan's columns, NaN where the row has none; *status is the case's.
 * words[VS_RESULT_WORDS], copies, are NULL where the cell is empty. Returns false, and sets
 * nothing, where the row is not as long as a row of the plan. */
bool vs_case_values(const vs_plan *plan, char *row, double *values, int *status, char **words);

/* Returns why the case failed, by its row, whose text is cut up: a copy. */
char *vs_case_why(char *row);

/* Is this row, whose text is cut up, the one of case `index`, by its id and its axes? failed: it is
 * a row of failures.csv. If not, why says what they are. It reads the case's scene, for its id. */
bool vs_case_is_row(vs_case *c, uint64_t index, const double *point, bool failed, char *row,
                    char *why, size_t size);

/* Runs case `index`, whose point is point[plan->n_axes], and adds its row without a newline:
 *
 *   case, id, the axes, the plan's columns, then those of study/folder.h from the least margin on
 *   case, id, the axes, 1, why               where it failed
 *
 * id is vs_identity's; it is empty where the case's scene is refused. margin_error is empty unless
 * the scene says run.verify: always, or the run shows that its sequence of firings is on edge. rung
 * is the ladder's. leaving_bound bounds the error by having left ngspice, relative to each probe's
 * peak. happened has what happened, or did not though it was expected, and not_judged what the
 * verdict could not judge; both are empty where nothing is rated. Returns how the case ended;
 * *circuit tells whether ngspice was used. */
int vs_case_run(vs_case *c, uint64_t index, const double *point, vs_text *row, bool *circuit);

/* ---- vs_case_run in its parts, for cases that share their past (study/workers/shared_prefix.h)
 * ----
 */

/* Reads the scene of case `index` and makes its id. Errors: the scene is refused. */
vs_status vs_case_begin(vs_case *c, uint64_t index, const double *point, vs_error *err);
/* The scene of the case that was begun; whoever changes it before the run answers for the row. */
vs_scene *vs_case_scene(vs_case *c);
/* Runs the case that was begun, unless begun, with err, says that it was refused. The rest is as of
 * vs_case_run. */
int vs_case_end(vs_case *c, vs_status begun, vs_text *row, bool *circuit, vs_error *err);
/* In the middle of c's run: from here on it is the run of the case that `other` has begun, whose
 * scene differs from c's in the keys of events alone. Error: a load that an event sets cannot be;
 * the run is then of no use. */
vs_status vs_case_become(vs_case *c, vs_case *other);

/* Adds the row of a case whose worker died. It reads the case's scene, to know its id, and so takes
 * as long as that. */
void vs_case_failure(const vs_plan *plan, uint64_t index, const double *point, const char *why,
                     vs_text *row);

/* Add the header rows of study.csv and failures.csv, without a newline. */
void vs_case_header(const vs_plan *plan, vs_text *row);
void vs_case_failure_header(const vs_plan *plan, vs_text *row);
