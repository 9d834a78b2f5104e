/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a close-up shows: probes of one or several runs over a stretch of time, and what happened in
 * it. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/gnuplot.h"
#include "base/text.h"
#include "traces.h"

/* ---- what happened in a run and when, as its events.csv tells ---- */

typedef struct vs_moment {
  double at_s;
  char *what;
  bool is_event; /* an event of the scene begins */
} vs_moment;

/* Begins as {0}; vs_time_window_free_moments is due even after an error. */
typedef struct vs_moments {
  vs_moment *item;
  size_t count;
} vs_moments;

/* Reads the folder's events.csv; if there is none, nothing has happened. Errors, VS_INPUT, with the
 * line: a row does not have two cells, or its first is no number. */
vs_status vs_time_window_read_moments(const char *folder, vs_moments *moments, vs_error *err);
void vs_time_window_free_moments(vs_moments *moments);

/* When the scene's first event begins, s; NaN: none does in the run. */
double vs_time_window_first_event(const vs_moments *moments);

/* Chooses the stretch of time to show, within 0 to until_s, and returns the reason in words. It
 * lies around the first of these that exist: events of the scene; what happens once while other
 * things happen often; everything that happens, if that is little. Otherwise it is the end of the
 * run. One cycle of cycle_s is shown before, and two after. */
const char *vs_time_window_choose(const vs_moments *moments, double cycle_s, double until_s,
                                  double *from_s, double *to_s);

/* ---- probes as people name them: "v_ak" for the column v_ak_v ---- */

enum { VS_PROBES_MOST = 12, VS_PROBE_SIZE = 96 };

typedef struct vs_probe_shown {
  const vs_column *of;        /* what it is; borrowed from the traces */
  char column[VS_PROBE_SIZE]; /* its column in run.csv */
  char label[VS_PROBE_SIZE];  /* for an axis: "p / mm" */
  double scale;               /* from the column's unit to the label's */
} vs_probe_shown;

typedef struct vs_probes_shown {
  vs_probe_shown item[VS_PROBES_MOST];
  int count;
} vs_probes_shown;

/* Finds the probes that the words, separated by commas, name: columns, with or without their unit.
 * words NULL: some that every run has. Errors, VS_INPUT: the run has no such column, the nearest is
 * named; there are too many. */
vs_status vs_time_window_find_probes(const char *words, const vs_traces *traces,
                                     vs_probes_shown *probes, vs_error *err);

/* Finds the rate of a coordinate's probe, column v_m_s of m, with its label; false: the run has
 * none. */
bool vs_time_window_probe_rate(const vs_probe_shown *probe, const vs_traces *traces,
                               vs_probe_shown *rate);

/* Writes the name of the probe's column with a word before its unit: "i_rms_a" for i_a and "rms".
 */
void vs_time_window_probe_named(const vs_probe_shown *probe, const char *word, char *name,
                                size_t size);

/* ---- the stretch ---- */

enum {
  VS_TIME_WINDOW_RUNS = 8,    /* in one picture, at most */
  VS_TIME_WINDOW_HEIGHT = 210 /* of a strip, pixels */
};

typedef struct vs_time_window_run {
  const char *folder; /* borrowed */
  vs_traces traces;
  vs_moments moments;
  double cycle_s; /* of its mains */
} vs_time_window_run;

/* Begins as {0}. */
typedef struct vs_time_window {
  vs_time_window_run run[VS_TIME_WINDOW_RUNS];
  size_t runs;
  vs_probes_shown probes;
  double from_s, to_s; /* what is shown */
} vs_time_window;

/* Adds the style that all pictures of a close-up share. */
void vs_time_window_begin(vs_script *script);
/* Sets where the names of the runs stand; a single run has none. */
void vs_time_window_legend(const vs_time_window *stretch, vs_script *script);
/* The colour of this run's curves. */
const char *vs_time_window_colour(size_t run);
