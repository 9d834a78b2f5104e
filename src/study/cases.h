/* SPDX-License-Identifier: GPL-3.0-or-later
 * The cases of a study under way: which point each of them is and, of a search, which cases it has
 * asked for and what has come of them. */
#ifndef VS_STUDY_CASES_H
#define VS_STUDY_CASES_H

#include "work/journal.h"
#include "study/plan.h"

/* Begins as zeros but for plan and journal, which are borrowed. vs_cases_free. The arrays are a
 * search's, as vs_results has them. */
typedef struct vs_cases {
  const vs_plan *plan;
  const vs_journal *journal;
  double *points, *values;
  int *status;
  uint64_t room;
} vs_cases;
void vs_cases_free(vs_cases *cases);

/* Writes the point of case `index`, point[n_axes]. A search must have asked for it. */
void vs_cases_point(const vs_cases *cases, uint64_t index, double *point);

/* Error: the journal has a row of a case from `first` up to before `until` that is not that case's.
 * A journal that is gone on with may have been changed. */
vs_status vs_cases_check(const vs_cases *cases, uint64_t first, uint64_t until, vs_error *err);

/* Takes the points that a search asks for behind its first `count` cases. */
void vs_cases_ask(vs_cases *cases, uint64_t count, const vs_generation *generation);

/* Takes from the journal what has come of those cases, once they are done. Their rows tell it, not
 * their runs, so that a study that goes on has the same. */
vs_status vs_cases_answer(vs_cases *cases, uint64_t first, uint64_t until, vs_error *err);

/* The first `count` cases, as a method is shown them. */
vs_results vs_cases_results(const vs_cases *cases, uint64_t count);

#endif
