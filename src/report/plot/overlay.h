/* SPDX-License-Identifier: GPL-3.0-or-later
 * Measured curves to draw over those of a run. They come from a CSV file. Its first column is the
 * time; the others are named as those of run.csv, in the same unit or one of its kind. */
#pragma once

#include <stddef.h>

#include "base/error.h"

enum { VS_OVERLAY_NAME = 96 };

typedef struct vs_overlay_curve {
  char name[VS_OVERLAY_NAME];  /* of the column in run.csv that the curve belongs to */
  char label[VS_OVERLAY_NAME]; /* for an axis: "v_ak / V" */
  int column;                  /* number in the measured file, from 1 */
  double factor;               /* from the curve's unit to that of the column in run.csv */
} vs_overlay_curve;

typedef struct vs_overlay {
  const char *path;         /* borrowed; NULL: there is no overlay */
  double time_s;            /* unit of the first column, s */
  long rows;                /* how many lie within the run */
  vs_overlay_curve *curves; /* owned */
  size_t count;
} vs_overlay;

/* The run that the curves are drawn over. */
typedef struct vs_overlay_run {
  const char *folder;        /* whose summary.json knows the units of the deck's probes */
  const char *path, *header; /* of run.csv; its first line */
  double until_s;            /* time of run.csv's last row */
} vs_overlay_run;

/* Reads the whole file and fills the overlay; vs_overlay_free is due even after an error. Errors,
 * each with its place: a column that run.csv does not have (the nearest is named) or whose unit is
 * not of its kind, a cell that is no number, a row of another length, a time that does not
 * increase; no row lies within the run. */
vs_status vs_overlay_read(const char *path, const vs_overlay_run *run, vs_overlay *overlay,
                          vs_error *err);
void vs_overlay_free(vs_overlay *overlay);

/* The curve to draw over this column of run.csv; NULL: there is none. */
const vs_overlay_curve *vs_overlay_find(const vs_overlay *overlay, const char *name);
