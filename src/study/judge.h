/* SPDX-License-Identifier: GPL-3.0-or-later
 * The judge of a study on a tier that solves the circuit without ngspice. Some cases are run in
 * ngspice, too: a sample of them, a hundredth and at least three, and those by which the study
 * decides, the worst one and the one that a search has found. Each column of study.csv is compared.
 * Its error on either tier is how far the case differs at another run.tolerance, and the resolution
 * that a run's margins have (run/session.h). Two tiers that differ by more than the sum of their
 * errors make the study fail.
 *
 * The rows that judge stand in the study's journal. The sample hangs on the study's identity, its
 * count of cases and which of them failed, and the judged cases of a whole study are those of its
 * shards. */
#pragma once

#include <stdio.h>

#include "base/json.h"
#include "study/plan.h"
#include "workers/journal.h"

/* The runs that judge a case, as the journal numbers them. */
enum {
  VS_JUDGE_NGSPICE,       /* in ngspice */
  VS_JUDGE_NGSPICE_OTHER, /* the same at another run.tolerance */
  VS_JUDGE_OWN_OTHER,     /* on the study's tier at that run.tolerance */
  VS_JUDGE_WAYS
};

/* The largest difference of a column's. */
typedef struct vs_judged_column {
  char *name;
  double own, ngspice;     /* the cells; NaN: empty */
  double difference, told; /* |own - ngspice|, and the sum of both errors; INFINITY: one is empty */
  uint64_t index;          /* of the case */
} vs_judged_column;

typedef struct vs_judge {
  uint64_t *picked; /* cases, rising */
  size_t count;
  vs_judged_column *column; /* of those that have numbers in a judged case */
  size_t columns;
  vs_judged_column
      worst;     /* what is off by most, as a part of what is told; its name is a column's */
  size_t beyond; /* how many cases are off by more than is told */
  size_t failed; /* of how many a run that judges failed: they are not compared */
  uint64_t first_failed;
  char why[256]; /* the first of these did not */
} vs_judge;
void vs_judge_free(vs_judge *judge);

/* Is the study to be judged? */
bool vs_judge_applies(const vs_plan *plan);
/* Error: an axis is a key that the judge sets. */
vs_status vs_judge_check(const vs_plan *plan, vs_error *err);
/* Adds to the manifest's beginning that the study is judged; nothing, where it is not. */
void vs_judge_begin_json(const vs_plan *plan, vs_json *json);

/* Makes the plan of a way: a copy that borrows all, with other keys over its scene. room is for
 * these, and must last as long. */
enum { VS_JUDGE_KEYS = 2 };
typedef struct vs_judge_way {
  char key[VS_JUDGE_KEYS][64];
  char **sets; /* owned by the caller, who frees it */
} vs_judge_way;
vs_plan vs_judge_plan(const vs_plan *plan, int way, vs_judge_way *room);

/* Picks the cases that are to be judged, of those that the journals have and that did not fail.
 * found: the case that a search has found; UINT64_MAX: none. */
vs_status vs_judge_pick(const vs_journals *journals, uint64_t found, vs_judge *judge,
                        vs_error *err);
/* Picks and compares them. Picks none where the journals' study is not judged. Error: a case has
 * not been judged yet. */
vs_status vs_judge_find(const vs_journals *journals, uint64_t found, vs_judge *judge,
                        vs_error *err);

/* Adds the member "judged"; nothing where no case is. */
void vs_judge_json(const vs_judge *judge, vs_json *json);
/* Prints one line, and a warning on standard error where a run that judges failed. */
void vs_judge_say(const vs_judge *judge, uint64_t cases, FILE *out);
/* Error: VS_RUN, a case is off by more than is told. */
vs_status vs_judge_result(const vs_judge *judge, vs_error *err);

/* ---- the limits ---- */

/* Fails with VS_RATING: in how many cases a rating is violated, and in how many undecided. Errors:
 * as vs_journal_row has. */
vs_status vs_judge_ratings(const vs_journals *all, vs_error *err);
