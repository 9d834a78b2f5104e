/* SPDX-License-Identifier: GPL-3.0-or-later
 * Whether a run of the solver still makes progress. A circuit may have an instant that ngspice
 * neither gets past nor gives up at: it shrinks its step until one converges, doubles it until one
 * fails, and so on. */
#ifndef VS_NGSPICE_PROGRESS_H
#define VS_NGSPICE_PROGRESS_H

#include <stdbool.h>

/* Start from {0} with each run. */
typedef struct vs_progress {
  double from_s; /* where the stretch that is looked at began */
  long tries;    /* steps in that stretch, failed ones too */
} vs_progress;

/* So many steps in one stretch are too many. */
enum { VS_PROGRESS_TRIES = 100000 };

/* Counts a step that was tried, from where the run has reached reached_s. False: no progress has
 * been made since from_s. */
bool vs_progress_made(vs_progress *progress, double reached_s, double max_step_s);

#endif
