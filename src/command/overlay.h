/* SPDX-License-Identifier: GPL-3.0-or-later
 * Measured curves to lay over a run's: a CSV file whose columns are named as run.csv's are, in the
 * same units or other ones of the same kind. Its first column is the time. */
#ifndef VS_COMMAND_OVERLAY_H
#define VS_COMMAND_OVERLAY_H

#include <stddef.h>

#include "base/error.h"

enum { VS_OVERLAY_NAME = 96 };

typedef struct vs_overlay_curve {
  char name[VS_OVERLAY_NAME];  /* of the column in run.csv that it goes with */
  char label[VS_OVERLAY_NAME]; /* "v_ak / V", for an axis */
  int column;                  /* of the measured file, from 1 */
  double factor;               /* from its unit to the one in run.csv */
} vs_overlay_curve;

typedef struct vs_overlay {
  const char *path; /* borrowed; NULL: there is no overlay */
  double time_s;    /* what a one in the first column means */
  long rows;        /* within the run */
  vs_overlay_curve *curves;
  size_t count;
} vs_overlay;

/* What the file is held against. */
typedef struct vs_overlay_run {
  const char *folder;        /* of the run; its summary.json knows the units of the deck's probes */
  const char *path, *header; /* run.csv and its first line */
  double until_s;            /* time of its last row */
} vs_overlay_run;

/* Reads and checks the whole file, row by row. Errors, each with file:line:column: a column that
 * run.csv has not (the nearest named) or whose unit is not of its kind, a cell that is no number, a
 * row of another length, time that does not rise; no row within the run. vs_overlay_free even
 * then. */
vs_status vs_overlay_read(const char *path, const vs_overlay_run *run, vs_overlay *overlay,
                          vs_error *err);
void vs_overlay_free(vs_overlay *overlay);

/* The curve to lay over that column of run.csv; NULL: none. */
const vs_overlay_curve *vs_overlay_find(const vs_overlay *overlay, const char *name);

#endif
