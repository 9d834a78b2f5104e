/* SPDX-License-Identifier: GPL-3.0-or-later
 * A study's folder as it is read. manifest.json says what was asked, study.csv, or study.csv.zst,
 * holds a row for each case, failures.csv one for each case that failed. Rows are shown one by one
 * and are never in memory all at once. */
#pragma once

#include "base/path.h"
#include "base/tree.h"
#include "study/method.h"

/* What a column of study.csv is. Those from VS_ROLE_MARGIN to VS_ROLE_STATUS stand behind the
 * measures, in this order. To add one: its role here, its row in vs_folder_kinds, and in
 * workers/case.c the function that adds its cell. Header, resuming, reports, manifest, npy and
 * Python take the row from there; test_columns counts them. */
typedef enum vs_folder_role {
  VS_ROLE_CASE,   /* the case's number */
  VS_ROLE_ID,     /* the case's id (study/workers/identity.h); the column may be missing */
  VS_ROLE_AXIS,   /* what was varied */
  VS_ROLE_REPORT, /* what was measured */
  VS_ROLE_LINE, /* a number of a line of the verdict: its margin, the error of that, its instant */
  VS_ROLE_MARGIN,  /* the least margin of the verdict, relative to its limit */
  VS_ROLE_ERROR,   /* the numerical error of that margin; empty: it was not computed */
  VS_ROLE_WEAKEST, /* what has that margin */
  VS_ROLE_RUNG,    /* the rung of the ladder on which the case's run ended; 0: the scene as it is */
  VS_ROLE_LEAVING, /* a bound on the error by having left ngspice while the circuit was quiet */
  VS_ROLE_HAPPENED,   /* what happened, and what did not though it was expected */
  VS_ROLE_NOT_JUDGED, /* what the verdict could not judge */
  VS_ROLE_WARNINGS,
  VS_ROLE_STATUS, /* 0, or 3 where a rating is violated or undecided */
  VS_ROLE_WHY,    /* why the case failed; behind the status, in failures.csv alone */
  VS_ROLES        /* how many they are */
} vs_folder_role;

/* What the cells of a column hold. */
typedef enum vs_folder_cells {
  VS_CELLS_TEXT,   /* anything */
  VS_CELLS_EITHER, /* a word or a number: an axis without a unit may be a choice or a file's name */
  VS_CELLS_NUMBER,
  VS_CELLS_VALUE, /* a number or nothing */
  VS_CELLS_LINE,  /* a number, "inf", "nan" or nothing */
  VS_CELLS_COUNT, /* a whole number */
  VS_CELLS_STATUS /* 0 or 3; 1 in failures.csv */
} vs_folder_cells;
/* Their words in the manifest. */
extern const char *const vs_folder_cell_words[];

typedef struct vs_folder_kind {
  const char *word; /* its title in study.csv; axes and measures have their own */
  vs_folder_cells cells;
} vs_folder_kind;
extern const vs_folder_kind vs_folder_kinds[VS_ROLES];
/* Returns the role of the column of that title; VS_ROLE_REPORT: it is an axis or a measure. A
 * line's begins with "margin.", "error." or "at.", and no device has one of these names
 * (report_columns.c). */
vs_folder_role vs_folder_role_of(const char *title);

/* What the cells of an axis hold: a number where it has a unit, else a word or a number. One of a
 * threat's range, threat.KEY or with.KEY, may be empty. */
vs_folder_cells vs_folder_axis_cells(const char *title, bool no_unit);

/* What a line's margin is, in manifest.json, by 1 + its sense (vs_listed_measure). NULL: neither.
 */
extern const char *const vs_folder_margins[3];

typedef struct vs_folder_column {
  char *title; /* as in study.csv: "circuit.r1_ohm" */
  char *name;  /* of the key or measure: "circuit.r1" */
  char *unit;  /* "" for none */
  char *text;  /* what it means, as the manifest says; "" where that says nothing */
  vs_folder_role role;
  double rating;       /* its limit, in the unit; NaN: there is none */
  const vs_node *node; /* its entry in the manifest; NULL: there is none */
} vs_folder_column;

enum { VS_STUDY_COLUMNS = 640 }; /* at most */

/* A study's folder that is open. It owns what its members point to, but for the methods. */
typedef struct vs_folder {
  char folder[VS_PATH_SIZE], path[VS_PATH_SIZE], manifest_path[VS_PATH_SIZE];
  vs_tree manifest;
  const char *method;        /* as the manifest names it: "grid", "grid x sobol", ... */
  const vs_method **methods; /* those of it that this program has, in that order */
  size_t n_methods;
  const vs_method *search; /* the one of them that searches; NULL: none */
  long cases;              /* how many the study has */
  long done;               /* those with a row in study.csv */
  long failed;             /* those in failures.csv */
  vs_folder_column column[VS_STUDY_COLUMNS];
  size_t count; /* of columns */
  /* Which columns have these roles; -1: none has. There is always one for status. */
  int margin, error, weakest, rung, happened, not_judged, warnings, status;
} vs_folder;

/* Reads the manifest and the header of study.csv. methods: all there are; NULL ends them; borrowed.
 * Errors: a file is missing or broken; the columns are not those that the manifest names.
 * vs_folder_close even then. */
vs_status vs_folder_open(vs_folder *table, const char *folder, const vs_method *const *methods,
                         vs_error *err);
void vs_folder_close(vs_folder *table);

/* Returns the column by which cases are judged: what a search aims at (vs_method_report.aim), else
 * the least margin; 0: there is none. *largest tells whether its largest value is the worst. */
size_t vs_folder_aim(const vs_folder *table, bool *largest);

/* Returns the member of the manifest in which the search says what it was asked and what it found;
 * NULL: no method searches, or the manifest has no such member. */
const vs_node *vs_folder_search(const vs_folder *table);

/* True if the cases are random samples, so that a share of them is a yield. */
bool vs_folder_is_sampled(const vs_folder *table);

/* Returns the number of the case that is the search's answer; -1: there is none. */
long vs_folder_found(const vs_folder *table);

/* True when the folder holds manifest.json, study.csv or study.csv.zst. */
bool vs_folder_here(const char *folder);

typedef struct vs_folder_row {
  long number; /* the case's */
  long line;   /* of the file, from 1 */
  char **cell; /* [count] */
  size_t count;
} vs_folder_row;

/* Calls visit for every row of study.csv, in order. Errors: a row has not as many cells as the
 * header; the cases are out of order; what visit returns. */
typedef vs_status (*vs_folder_visit)(void *ctx, const vs_folder_row *row, vs_error *err);
vs_status vs_folder_each(const vs_folder *table, vs_folder_visit visit, void *ctx, vs_error *err);

/* The same for failures.csv, whose rows are case, id, axes, status and, last, why. Where there is
 * no such file there are no rows. */
vs_status vs_folder_each_failure(const vs_folder *table, vs_folder_visit visit, void *ctx,
                                 vs_error *err);

/* Reads the number in a cell; NaN where the cell is empty, "nan" or infinite. false: the cell holds
 * something else. */
bool vs_folder_number(const char *cell, double *value);
