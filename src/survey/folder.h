/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study's folder as it is read: manifest.json says what was asked, study.csv holds a row a case,
 * failures.csv the cases that have none. Rows are shown one by one and never held all at once. */
#ifndef VS_SURVEY_FOLDER_H
#define VS_SURVEY_FOLDER_H

#include "base/path.h"
#include "base/tree.h"
#include "study/method.h"

typedef enum vs_folder_role {
  VS_ROLE_CASE,    /* its number */
  VS_ROLE_ID,      /* what it is told by in any study; may be missing */
  VS_ROLE_AXIS,    /* what was varied */
  VS_ROLE_REPORT,  /* what was measured */
  VS_ROLE_MARGIN,  /* the least margin of the verdict, a part of its limit */
  VS_ROLE_ERROR,   /* its numerical error; empty: not computed */
  VS_ROLE_WEAKEST, /* whose margin that is */
  VS_ROLE_RUNG,    /* of the ladder on which the case's run ended; 0: the scene as it is */
  VS_ROLE_LEAVING, /* bound on the error by having left ngspice while the circuit was quiet */
  VS_ROLE_WARNINGS,
  VS_ROLE_STATUS /* 0, or 3 where a rating is violated or undecided */
} vs_folder_role;

typedef struct vs_folder_column {
  char *title; /* as in study.csv: "circuit.r1_ohm" */
  char *name;  /* of the key or measure: "circuit.r1" */
  char *unit;  /* "" for none */
  char *text;  /* of a report column, what it is; "" */
  vs_folder_role role;
  double rating;       /* in the unit; NAN: there is none */
  const vs_node *node; /* its entry in manifest.json; NULL */
} vs_folder_column;

enum { VS_STUDY_COLUMNS = 256 };
typedef struct vs_folder {
  char folder[VS_PATH_SIZE], path[VS_PATH_SIZE], manifest_path[VS_PATH_SIZE];
  vs_tree manifest;
  const char *method;        /* as the manifest names it: "grid", "grid x sobol", ... */
  const vs_method **methods; /* those of it that this program has, in that order */
  size_t n_methods;
  const vs_method *search;  /* the one of them that searches; NULL: none */
  long cases, done, failed; /* asked for; with a row; without one, in failures.csv */
  vs_folder_column column[VS_STUDY_COLUMNS];
  size_t count;
  int margin, error, weakest, rung, warnings,
      status; /* which column; all but status -1: not there */
} vs_folder;

/* Errors: a file missing or broken, columns that are not those the manifest names. */
vs_status vs_folder_open(vs_folder *table, const char *folder, const vs_method *const *methods,
                         vs_error *err);
void vs_folder_close(vs_folder *table);

/* The column that says how bad a case is, and whether the worst is the largest: what a worst-case
 * search looks for ("find": "max thyristor.v_reverse"), else the least margin. 0: there is none. */
size_t vs_folder_aim(const vs_folder *table, bool *largest);

/* The member of the manifest in which the search says what it was asked and what it found; NULL:
 * nothing searched, or the manifest has no such member. */
const vs_node *vs_folder_search(const vs_folder *table);

/* True if the cases are random samples, so that a share of them is a yield. */
bool vs_folder_is_sampled(const vs_folder *table);

/* The case that a search gives as its answer; -1: none. */
long vs_folder_found(const vs_folder *table);

/* True when the folder holds manifest.json or study.csv. */
bool vs_folder_here(const char *folder);

typedef struct vs_folder_row {
  long number; /* the case's */
  long line;   /* of the file, from 1 */
  char **cell; /* as many as columns */
  size_t count;
} vs_folder_row;

/* Shows every row in turn. Errors: cells that are not as many as the header's, cases out of order;
 * what visit says. */
typedef vs_status (*vs_folder_visit)(void *ctx, const vs_folder_row *row, vs_error *err);
vs_status vs_folder_each(const vs_folder *table, vs_folder_visit visit, void *ctx, vs_error *err);

/* The same for failures.csv, of which the last cell says why. Not there: no rows. */
vs_status vs_folder_each_failure(const vs_folder *table, vs_folder_visit visit, void *ctx,
                                 vs_error *err);

/* The number in a cell. NAN: empty, "nan" or infinite. false: it is no number. */
bool vs_folder_number(const char *cell, double *value);

#endif
