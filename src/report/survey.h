/* SPDX-License-Identifier: GPL-3.0-or-later
 * What one reading of study.csv tells: ranges, the verdict over all cases, which part is weakest
 * how often, the worst cases, why some failed. */
#ifndef VS_REPORT_SURVEY_H
#define VS_REPORT_SURVEY_H

#include "report/scale.h"
#include "report/study_table.h"

typedef struct vs_count {
  char *name;
  long times;
} vs_count;
enum { VS_COUNTS = 64 }; /* the names told apart; what is more goes to the last one, "others" */
typedef struct vs_counts {
  vs_count item[VS_COUNTS];
  size_t count;
} vs_counts;

enum { VS_DISTINCT = 1024, VS_WORST = 10 };

/* Of one column. */
typedef struct vs_profile {
  bool is_number;        /* else its cells are words */
  long known;            /* cells that hold a number */
  double least, largest; /* NAN: none known */
  double *value;         /* an axis' different numbers, rising; NULL: more than VS_DISTINCT */
  char **word;           /* its different words, in the order they came */
  size_t count;          /* of value or word */
  bool many;             /* more than VS_DISTINCT */
} vs_profile;

/* A case kept: its cells. key: what it was chosen by. */
typedef struct vs_kept {
  double key;
  char **cell;
} vs_kept;

typedef struct vs_survey {
  long rows;
  long judged;     /* with a least margin */
  long good;       /* of those: status 0, not below 0 */
  long violated;   /* status 3, and below 0 by more than its error, if that is known */
  long undecided;  /* status 3 otherwise */
  long unverified; /* judged, and without an error of the margin */
  long climbed;    /* on a rung of the ladder beyond the first */
  long warned;
  vs_profile profile[VS_STUDY_COLUMNS]; /* by column */
  vs_counts weakest, why;               /* falling */
  vs_counts doubtful;                   /* which limit is undecided where a case is; falling */
  long failures;                        /* rows of failures.csv */
  vs_kept worst[VS_WORST]; /* by vs_study_aim, the worst first; without it the first cases */
  size_t n_worst;
  vs_kept found; /* the case of vs_study_found; its cell NULL: none */
} vs_survey;

/* Errors: those of vs_study_each; a cell that is no number where the column has a unit; rows that
 * are not as many as the manifest says. vs_survey_free even then. */
vs_status vs_survey_take(const vs_study_table *table, vs_survey *survey, vs_error *err);
void vs_survey_free(const vs_study_table *table, vs_survey *survey);

/* Are its worst cases told by something? Not where no rating is judged and nothing is looked for.
 */
bool vs_survey_ranked(const vs_study_table *table, const vs_survey *survey);

/* Where the cell stands among the column's different values: 0 to count - 1. -1: nowhere. */
long vs_profile_index(const vs_profile *profile, const char *cell);

vs_extent vs_profile_extent(const vs_profile *profile);

/* One kept case more among the first `most` by rising key. */
void vs_keep(vs_kept *kept, size_t *count, size_t most, double key, const vs_study_row *row);
void vs_kept_free(vs_kept *kept, size_t count, size_t cells);

#endif
