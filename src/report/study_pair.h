/* SPDX-License-Identifier: GPL-3.0-or-later
 * Two studies side by side: how many cases hold in each, which cases changed their verdict, and how
 * far the reported columns lie apart. */
#ifndef VS_REPORT_STUDY_PAIR_H
#define VS_REPORT_STUDY_PAIR_H

#include "base/text.h"
#include "study/folder.h"

enum { VS_STUDY_PAIR_LISTED = 10 }; /* cases that are listed with another verdict */

/* What is known of a column that both studies report. */
typedef struct vs_study_pair_column {
  size_t at[2];                /* its number in either study */
  double least[2], largest[2]; /* of all rows of that study; NaN: none has a number */
  double apart;                /* B less A, where its size is largest; NaN: in no joined row */
  long apart_case[2];          /* the cases of that row */
  double sum;                  /* of B less A over the joined rows with both */
  long joined;                 /* these */
  long alone[2];               /* joined rows in which A, or B, alone has a number */
} vs_study_pair_column;

/* A joined row whose verdict is not the same. */
typedef struct vs_study_pair_change {
  long number[2]; /* its cases */
  char word[2][12];
} vs_study_pair_change;

/* Start from {0}; vs_study_pair_close even after an error. Index 0 is study A, 1 is study B. */
typedef struct vs_study_pair {
  vs_folder folder[2];
  bool by_axes; /* rows are joined by the values of their axes; false: by their number */
  long rows[2], held[2], judged[2], joined;
  vs_study_pair_column column[VS_STUDY_COLUMNS];
  size_t columns;
  vs_study_pair_change change[VS_STUDY_PAIR_LISTED];
  long changes;                  /* all of them */
  struct vs_study_pair_row *row; /* the rows of A, sorted by key; owned */
} vs_study_pair;

/* Reads both studies and joins their rows: by the values of the axes where both have the same axes
 * and no two rows of A have the same values, else by the number of the case. Errors, VS_INPUT: a
 * folder is not that of a study, or a file in it is broken. */
vs_status vs_study_pair_open(vs_study_pair *pair, const char *a, const char *b,
                             const vs_method *const *methods, vs_error *err);
void vs_study_pair_close(vs_study_pair *pair);

/* Adds the table for people, and the same as one JSON object. */
void vs_study_pair_table(const vs_study_pair *pair, vs_text *out);
void vs_study_pair_json(const vs_study_pair *pair, vs_text *out);

#endif
