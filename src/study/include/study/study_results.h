/* SPDX-License-Identifier: GPL-3.0-or-later
 * What one reading of study.csv tells: the columns' ranges, the verdict over all cases, what is
 * weakest how often, the worst cases, why some failed. */
#pragma once

#include "study/folder.h"

/* How often a name came. */
typedef struct vs_count {
  char *name;
  long times;
} vs_count;
enum { VS_COUNTS = 64 }; /* names told apart; further ones are counted as the last, "others" */
typedef struct vs_counts {
  vs_count item[VS_COUNTS];
  size_t count;
} vs_counts;

enum {
  VS_DISTINCT = 1024, /* different values of an axis that are told apart */
  VS_WORST = 10       /* worst cases that are kept */
};

/* What is known of a column's numbers. */
typedef struct vs_extent {
  double least, largest; /* NAN both: nothing is known */
  const double *value;   /* its different numbers, rising; NULL: too many */
  size_t count;          /* of value */
} vs_extent;

/* What is known of one column. */
typedef struct vs_profile {
  bool is_number;        /* its cells are numbers; false: words */
  long known;            /* how many cells hold a number */
  double least, largest; /* of these; NaN: there are none */
  double *value;         /* an axis' different numbers, rising */
  char **word;           /* its different words, in the order they came */
  size_t count;          /* of value or word */
  bool many;             /* there are more than VS_DISTINCT; count has only the first ones */
} vs_profile;

/* A case that is kept: its cells, and the number it was chosen by, of which the least is worst. */
typedef struct vs_kept {
  double key;
  char **cell;
} vs_kept;

typedef struct vs_study_results {
  long rows;
  long judged;    /* cases with a least margin */
  long good;      /* those of them with status 0 whose margin is not below 0 */
  long violated;  /* cases with status 3 whose margin is below 0 by more than its error, if known */
  long undecided; /* the other cases with status 3 */
  long unverified;                      /* judged cases whose margin's error is not known */
  long climbed;                         /* cases on a rung of the ladder beyond the first */
  long warned;                          /* cases with warnings */
  vs_profile profile[VS_STUDY_COLUMNS]; /* by column */
  vs_counts weakest;                    /* what was weakest; the most frequent first */
  vs_counts doubtful;                   /* which limit is undecided; the most frequent first */
  vs_counts happened;      /* "misfire of thyristor": in how many cases; the most frequent first */
  vs_counts not_judged;    /* what was not judged, whole cells; the most frequent first */
  vs_counts why;           /* why cases failed; the most frequent first */
  long failures;           /* rows of failures.csv */
  vs_kept worst[VS_WORST]; /* by vs_folder_aim, the worst first; where it is 0, the first cases */
  size_t n_worst;
  vs_kept
      best; /* the case with the largest least margin; its cell is NULL where nothing is judged */
  vs_kept found; /* the case of vs_folder_found; its cell is NULL when there is none */
} vs_study_results;

/* Reads all rows once. Errors: those of vs_folder_each; a cell is no number where the column has a
 * unit; the rows are not as many as the manifest says. vs_study_results_free even then. */
vs_status vs_study_results_take(const vs_folder *table, vs_study_results *survey, vs_error *err);
void vs_study_results_free(const vs_folder *table, vs_study_results *survey);

/* True if `worst` is ranked, by the margin or by what is searched for. False where there is
 * neither: `worst` then holds the first cases. */
bool vs_study_results_ranked(const vs_folder *table, const vs_study_results *survey);

/* Returns the cell's index among the column's different values; -1: it is none of them. */
long vs_study_results_index(const vs_profile *profile, const char *cell);

vs_extent vs_study_results_extent(const vs_profile *profile);

/* Puts a copy of the row among kept[*count], which stand by rising key, at most `most` of them. */
void vs_study_results_keep(vs_kept *kept, size_t *count, size_t most, double key,
                           const vs_folder_row *row);
void vs_study_results_kept_free(vs_kept *kept, size_t count, size_t cells);
