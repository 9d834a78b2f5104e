/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is shown of a linear model and of the averaged one that follows from it: the table, the
 * member "linear" of JSON, and files. All numbers are in SI, and per radian of the angle, but for
 * those whose names say "per_deg". */
#pragma once

#include "base/json.h"
#include "orbit/averaged.h"

typedef struct vs_linear_report {
  vs_linear linear;
  vs_averaged averaged;
  int travel;  /* the output that is the gap's travel */
  char *notes; /* what is to be said of them: lines, each with a line break behind it; owned */
} vs_linear_report;

/* Finds the models about the orbit, with the usual outputs, and what is to be said of them. Errors:
 * those of vs_linear_find and of vs_averaged_find. vs_linear_report_free also after an error. */
vs_status vs_linear_report_find(vs_linear_report *matrices, const vs_scene *scene,
                                const vs_orbit *orbit, vs_error *err);
void vs_linear_report_free(vs_linear_report *matrices);

/* Prints a table of the poles and the gains. */
void vs_linear_report_print(const vs_linear_report *matrices, FILE *out);
/* Adds the member "linear". */
void vs_linear_report_json(const vs_linear_report *matrices, vs_json *json);

/* Writes linear.json, linear_poles.csv and a CSV file for each matrix into a folder that is there.
 * A CSV file's header row has NAME_UNIT of each column; its rows are in the order of the states, or
 * of the outputs. Errors: those of vs_file_open and vs_file_commit. */
vs_status vs_linear_report_write(const vs_linear_report *matrices, const char *folder,
                                 vs_error *err);
/* The names of these files, as a list in words. */
const char *vs_linear_report_files(void);
/* Removes such files of an older run. */
void vs_linear_report_remove(const char *folder);
