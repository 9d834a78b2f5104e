/* SPDX-License-Identifier: GPL-3.0-or-later
 * The measures of one run, or of one period of an orbit, under the names that `run` and `steady`
 * show them by. */
#pragma once

#include "orbit/steady.h"
#include "run/listed_measure.h"
#include "run/session.h"

/* Start from {0} and free with vs_measured_free. Not to be copied. */
typedef struct vs_measured {
  vs_result result;
  vs_steady steady; /* where `period` */
  bool period;
  struct vs_alike *alike; /* by which its run comes to its orbit; NULL: by a search; borrowed */
} vs_measured;

/* Begins with a settled scene, which must outlive this; orbit: the measures are those of a period
 * of it, and the scene's setup is that of a run along it; NULL: those of a run. */
void vs_measured_begin(vs_measured *measured, const vs_scene *scene, const vs_orbit *orbit);
/* Takes a step of the run, and completes the measures at its end. */
void vs_measured_accept(vs_measured *measured, const vs_step *step);
void vs_measured_finish(vs_measured *measured);
void vs_measured_free(vs_measured *measured);

/* Runs a scene and takes its measures: those of its run, which finds its own orbit where it begins
 * on one; or, with periods above 0, those of one period of its orbit of so many firing periods. The
 * scene is altered: give a copy, which may borrow. session: its guest is only asked into a run.
 * Fill *measured with {0} before. It counts on the budget of
 * the scene's order. Errors: those of vs_steady_run, vs_session_charge_budget and vs_steady_begin.
 */
vs_status vs_measured_run(vs_measured *measured, vs_scene *scene, int periods,
                          const vs_session *session, vs_error *err);

/* One of them, in its unit. Behind the measures come margin_least and the numbers of the verdict's
 * lines (vs_listed_line_at). */
typedef struct vs_measured_value {
  char name[VS_JUDGED_NAME], unit[24];
  vs_value value; /* of which at_s is an instant of the run */
} vs_measured_value;

/* Fills `value` with the k-th, from 0, and returns true; false: there are no more. */
bool vs_measured_at(const vs_measured *measured, int k, vs_measured_value *value);
/* The number of the one of that name; -1: there is none. */
int vs_measured_find(const vs_measured *measured, const char *name);
