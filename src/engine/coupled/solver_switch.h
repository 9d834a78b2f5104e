/* SPDX-License-Identifier: GPL-3.0-or-later
 * The switch between the circuit's solver and its macromodel (macromodel/macromodel.h): leaving the
 * solver once the macromodel says that it may be left, stepping on without it, coming back to it.
 *
 * A solver that is left for good ends its run, and the macromodel goes on to the end. One that is
 * gone back to stands still at some phase of the mains while whole cycles pass without it. Then its
 * clock is moved on by these cycles, and it is led: sources in the EVA pull its flux linkage and
 * voltage to where the macromodel has come. While it is led the macromodel's steps are still the
 * ones shown. */
#pragma once

#include "coupled/signal_map.h"
#include "coupled/trajectory.h"
#include "macromodel/macromodel.h"

typedef struct vs_solver_switch {
  vs_trajectory *trajectory;
  const vs_signal_map *names;
  const vs_macromodel *kind;
  void *law;              /* the macromodel; NULL: the solver goes on to the end. Owned */
  bool stays;             /* a bound was missed, and the solver is not left again */
  bool ends;              /* the solver is not needed any more */
  bool follows;           /* the solver is led */
  double follows_until_s; /* while it is */
  double lead_rate_1_s;   /* how fast it is led */
  double shift_s; /* the run's time less the solver's: the cycles it was left for, less those
                     of the settling */
  double goal_s;  /* when the macromodel is at `goal`; -1: at no time */
  vs_knot goal;
} vs_solver_switch;

/* Begins in the solver. max_step_s is its longest step. The trajectory and the names must outlive
 * it; the names may be filled in later, with what vs_solver_switch_memories returns. */
void vs_solver_switch_begin(vs_solver_switch *solver_switch, const vs_run_order *order,
                            vs_trajectory *trajectory, const vs_signal_map *names,
                            double max_step_s);
void vs_solver_switch_end(vs_solver_switch *solver_switch);

/* What the solver shall show of what the circuit remembers; NULL: nothing. */
const vs_circuit_states *vs_solver_switch_memories(const vs_solver_switch *solver_switch);

/* What a port that leads the EVA (VS_PORT_...) has at t_s. 0 while the solver is not led. */
double vs_solver_switch_lead(vs_solver_switch *solver_switch, size_t port, double t_s);

/* Takes in what the solver shows at the trajectory's last knot, and leaves the solver if the
 * circuit is quiet. If it is left for some cycles, their steps are shown here. Errors: the
 * observer's; VS_RUN where the law cannot be integrated. */
vs_status vs_solver_switch_consider(vs_solver_switch *solver_switch, const double *signals,
                                    vs_error *err);

/* Takes in that the solver, which is led, has come to t_s, and shows the macromodel's step to
 * there. Errors as above. */
vs_status vs_solver_switch_follow(vs_solver_switch *solver_switch, double t_s,
                                  const double *signals, vs_error *err);

/* True if the solver's run can end: it was left for good, or the run's end has come before the
 * solver's own. */
bool vs_solver_switch_enough(const vs_solver_switch *solver_switch);

/* Goes on without the solver, which is left for good, to the run's end. Errors as above. */
vs_status vs_solver_switch_finish(vs_solver_switch *solver_switch, vs_error *err);
