/* SPDX-License-Identifier: GPL-3.0-or-later
 * One case of a study, run in this process: its point, as keys, over the scene; one sim; its row.
 * What is constant from case to case is kept: the scene's tree, and the deck's text as long as
 * neither deck nor parts change. */
#ifndef VS_STUDY_CASE_H
#define VS_STUDY_CASE_H

#include "study/plan.h"

/* How a case ended. */
enum { VS_CASE_DONE = 0, VS_CASE_FAILED = 1, VS_CASE_VIOLATED = 3 };

typedef struct vs_case vs_case; /* one that runs cases, one after the other */

/* keep: a folder, where each case's run.csv is to be stored in a folder of the case's number;
 * NULL: nowhere. The plan is borrowed. */
vs_case *vs_case_new(const vs_plan *plan, const char *keep);
void vs_case_free(vs_case *c);

/* Runs the case and adds its row: "case,id,axes,columns,margin_least,margin_error,weakest,
 * rung,leaving_bound,warnings,status" (margin_error is empty unless run.verify: always; rung: of
 * the ladder; leaving_bound: on the error by having left ngspice, a part of each peak); of one that
 * failed "case,id,axes,1,why". No newline. *circuit: ngspice was used. id: study/identity.h; empty
 * where the case's scene is refused. */
int vs_case_run(vs_case *c, uint64_t index, const double *point, vs_text *row, bool *circuit);

/* The row of a case that its worker did not live to tell. Reads its scene for its id, so it takes
 * its time. */
void vs_case_failure(const vs_plan *plan, uint64_t index, const double *point, const char *why,
                     vs_text *row);

/* The columns of study.csv behind the measures, in their order. */
typedef enum vs_case_column {
  VS_CASE_MARGIN,
  VS_CASE_MARGIN_ERROR,
  VS_CASE_WEAKEST,
  VS_CASE_RUNG,
  VS_CASE_LEAVING,
  VS_CASE_WARNINGS,
  VS_CASE_STATUS,
  VS_CASE_COLUMNS /* how many they are */
} vs_case_column;
extern const char *const vs_case_titles[VS_CASE_COLUMNS];

/* Takes apart a row that vs_case_run has added, which loses its commas. values[1 + n_columns]: the
 * least margin, then the plan's columns; NaN: not known. false: it is no row of that plan's. */
bool vs_case_values(const vs_plan *plan, char *row, double *values, int *status);

/* Header rows, without a newline. */
void vs_case_header(const vs_plan *plan, vs_text *row);
void vs_case_failure_header(const vs_plan *plan, vs_text *row);

#endif
