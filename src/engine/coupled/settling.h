/* SPDX-License-Identifier: GPL-3.0-or-later
 * The settling of a run that is steered (vs_orbit_search, engine/sim.h): the solver's run begins
 * with firing periods that only the pilot sees. In each of them the run's time goes from 0 to the
 * period, while the solver's own time goes on. The setup is the run's own with its events silent.
 */
#pragma once

#include "coupled/trajectory.h"

/* Begins with vs_settling_begin, all zero without a pilot, and ends with vs_settling_end. It stays
 * where it is made. */
typedef struct vs_settling {
  const vs_run_order *order;
  const vs_setup *setup;       /* of the run */
  const vs_observer *observer; /* of the run */
  vs_setup *calm;              /* of the settling; owned */
  vs_observer watcher;         /* of the settling */
  bool on;                     /* it has begun, and not ended */
  bool refused;  /* the pilot has found that an orbit of another period is to be asked for */
  long parts;    /* how many have ended */
  double edge_s; /* the run's time at the next edge that the solver was told */
} vs_settling;

/* Begins the settling where the order has a pilot. All must outlive it. */
void vs_settling_begin(vs_settling *settling, const vs_setup *setup, const vs_run_order *order,
                       const vs_observer *observer);

/* What a run's trajectory begins with: those of the settling, or of the run. */
const vs_setup *vs_settling_setup(const vs_settling *settling);
const vs_observer *vs_settling_observer(const vs_settling *settling);

/* How long the solver's run may be, s, until the end of the run. */
double vs_settling_until(const vs_settling *settling);

/* The voltage, V, that the pilot adds to the mains. */
double vs_settling_extra_voltage(const vs_settling *settling, double t_s);

/* Takes the run's next edge behind now_s, and returns the one that the solver is to be told. The
 * ends of the pilot's periods are edges in the settling, and in the run too: so that the solver,
 * whose rule begins anew at an edge, does there what it did when the orbit was found. */
double vs_settling_edge(vs_settling *settling, double now_s, double next_s);

/* The run's time, s, with the solver at solver_s: exactly an edge's where it is one but for
 * rounding. shift_s: the run's time less the solver's. */
double vs_settling_time(const vs_settling *settling, double solver_s, double shift_s);

/* Takes in that the trajectory has come to another knot. At a part's end the pilot has its turn,
 * and *shift_s changes with the clock. Errors: the pilot's; VS_SIGNAL. */
vs_status vs_settling_follow(vs_settling *settling, vs_trajectory *trajectory, double *shift_s,
                             vs_error *err);

/* The run has ended. An error in the settling gets words that say so. */
vs_status vs_settling_end(vs_settling *settling, vs_status status, vs_error *err);
