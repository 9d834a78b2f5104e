/* SPDX-License-Identifier: GPL-3.0-or-later
 * A sim lets time pass for a scene through one tier, and shows every accepted step to an observer.
 * This is the seam between the tiers (ideal/, coupled/) and those who run them (run/). */
#pragma once

#include <signal.h>
#include <stdio.h>

#include "engine/budget.h"
#include "engine/propagator.h"
#include "engine/setup.h"
#include "engine/step.h"
#include "ngspice/circuit.h"

/* How far a coordinate goes from a value to either side. */
typedef struct vs_range {
  double middle, way;
} vs_range;

/* What is known of the rest of a run in which nothing happens any more: the machine swings freely,
 * without flux and outside of all stops. */
typedef struct vs_swing_rest {
  double from_s, to_s;
  vs_range q[VS_MOST_DOF]; /* of the coordinates, and of the travel c.q */
  vs_range travel;
  double rate2[VS_MOST_DOF]; /* the largest |q"| */
} vs_swing_rest;

/* Someone who is shown the steps, in order of time. A status other than VS_OK ends the run, which
 * then returns it. */
typedef struct vs_observer {
  void *ctx;
  vs_status (*accept)(void *ctx, const vs_step *step, vs_error *err);
} vs_observer;

/* Someone who knows what the observer of a run needs. */
typedef struct vs_early_end {
  void *ctx;
  /* Returns true if no more of the run is needed than its last state and its energies, so that the
   * tier may go on to rest->to_s in one step (vs_step.glides). */
  bool (*leaves)(void *ctx, const vs_swing_rest *rest);
} vs_early_end;

/* Someone who may make another run of this one on the way (study/workers/shared_prefix.h). */
typedef struct vs_fork_point {
  void *ctx;
  /* Called with the end t_s of each of the solver's steps, before the run is told of the step. It
   * may change the events of the run's setup, from t_s on. A status other than VS_OK ends the run,
   * which then returns it. */
  vs_status (*reach)(void *ctx, double t_s, vs_error *err);
} vs_fork_point;

/* A listener that is shown voltages and currents of the circuit that no probe has. */
typedef struct vs_circuit_look {
  void *ctx;
  /* Called with the netlist of each run that begins. Gives the further signals that are wanted, in
   * the form of vs_circuit_job.signals; the value of a missing one is NaN. Borrowed until the run's
   * end. */
  void (*begin)(void *ctx, const vs_circuit_job *job, const char *const **signals, size_t *count);
  /* Is shown these signals at the end of each step that the solver makes of the run. */
  void (*take)(void *ctx, double t_s, const double *signals);
} vs_circuit_look;

/* Who steers a run of tier "circuit" before it begins. The circuit's hidden state cannot be set,
 * but the machine's can. So a run that is to begin on a periodic orbit settles first: firing
 * periods without the scene's events, each of which goes from t = 0 to the period's end. At each
 * end the pilot puts the machine into another state, while the solver goes on. Once the pilot says
 * so, t = 0 is the beginning of the run that the observer sees.
 *
 * orbit/picard.h is one. */
typedef struct vs_orbit_search {
  void *self;
  double period_s;          /* of the settling's parts, a number of whole cycles of the mains */
  int of_orbit;             /* so many of them make a period of the orbit */
  int most;                 /* so many of them there may be; then `turn` must end the run */
  double x[VS_MOST_STATES]; /* q, q' at the beginning of each part, and then of the run */
  /* A run of this setup begins: sets x. */
  void (*begin)(void *self, const vs_setup *setup);
  /* Is shown the steps of the settling. */
  void (*accept)(void *self, const vs_step *step);
  /* A part of the settling has ended, with this knot: sets x. *begins: the run begins. An error
   * ends the run with VS_RUN. VS_INPUT: an orbit of another period is to be asked for. */
  vs_status (*turn)(void *self, const vs_knot *end, bool *begins, vs_error *err);
  /* The voltage, V, that is added to the mains at t_s of this part of the settling. */
  double (*push)(void *self, double t_s);
  /* The run has come to its end, or has failed. */
  void (*end)(void *self);
  bool found;          /* the orbit is: what fails behind that is not the search */
  double late_rad;     /* by which the firings of the next part are later; 0 but for `turn` */
  vs_circuit_map *map; /* for `turn`, from a solver that can set the circuit's hidden state; NULL:
                          nobody wants it */
} vs_orbit_search;

/* How a winding's temperature changes the run: an observer follows it in *heat, and wherever a
 * thyristor fires, an ideal tier makes the resistance in *model of it. Filled from the setup's own
 * model, that goes in the frame of all steps and lasts as long as the observer looks at it. */
typedef struct vs_warming {
  const vs_winding_state *heat;
  vs_model *model;
} vs_warming;

/* What one run has besides its setup. Only a tier with a circuit looks at it, but for early_end,
 * memo and warming. */
typedef struct vs_run_order {
  const vs_circuit_kind *solver; /* who solves the circuit: vs_self_test_kind, or a test's own */
  const struct vs_macromodel *stand_in; /* who may stand in for the circuit; NULL: nobody may */
  FILE *raw;          /* gets a rawfile of the run; NULL: none is written. The caller owns it */
  vs_where raw_where; /* the key to blame if the rawfile becomes too large: that of the run's end */
  bool tried; /* this deck with these parts was run in this process before, so that the solver need
                 not try first whether it survives them */
  bool unbegun; /* this process can begin anew without harm, and need not try either: a netlist that
                   it does not survive makes it do so, and try then */
  long *tries;  /* counts the steps that the solver tries, rejected ones too; NULL: nobody asks.
                   Borrowed */
  vs_circuit_steps *steps;           /* that a run on tier compiled notes, or is to take; NULL: it
                                        has its own. Borrowed */
  vs_orbit_search *pilot;            /* steers the run's settling; NULL: it has none. Borrowed */
  const volatile sig_atomic_t *stop; /* set by a signal: the settling ends with VS_SIGNAL, as the
                                        observer sees nothing of it; NULL: no signal ends it */
  vs_budget *budget; /* what the search may take that this run, or its settling, is a part of; NULL:
                        there is no limit. Borrowed */
  bool shows;        /* a search before the run shows on standard error how far it is */
  const vs_circuit_look *look;   /* NULL: nobody looks. Borrowed */
  const vs_fork_point *fork;     /* NULL: the run goes its own way to the end. Borrowed */
  const vs_early_end *early_end; /* asked on the ideal tiers; NULL: all steps are needed.
                              Borrowed */
  bool
      *spares; /* the circuit tier makes it true while it leaves the gates' sub-pulses out (coupled/
                  anode.c), which the setup's timeline reads; NULL: it never does. Borrowed */
  vs_propagator_memo *memo; /* of the runs of one machine on an ideal tier; NULL: each run makes its
                               own propagator. Borrowed */
  const vs_warming *warming; /* NULL: the resistance stays what it is. Borrowed */
} vs_run_order;

/* A key of a section that every tier reads. */
typedef struct vs_tier_key {
  const char *section, *key;
  const char *value; /* the only value that matters; NULL: any does */
} vs_tier_key;

/* One way of computing a scene. Each tier is a constant in its own file, named in VS_TIER_LIST
 * (engine/setup.h). */
typedef struct vs_tier {
  const char *name; /* vs_setup_tier_words[VS_TIER_...] */
  const char *text; /* for lists */
  double finest;    /* smallest run.tolerance it can hold */
  bool automatic;   /* run.tier: auto may take it; of several the first in VS_TIER_LIST */
  bool has_circuit; /* the scene's deck is run: this tier has its probes, obeys the section circuit
                       and all events, and can write a rawfile */
  bool by_ngspice;  /* it is ngspice that runs the deck, so that its settings and its ladder help */
  bool gap_at_rest; /* the coil's inductance stays as at rest */
  /* The keys besides, of sections that every tier reads, that this tier obeys and others ignore;
   * ends with {NULL, NULL, NULL}. NULL: there are none. */
  const vs_tier_key *keys;
  /* Runs from the start at t = 0 to run.until. Nothing here guards the model's validity; vs_sim_run
   * does. Errors name the time and the cause. */
  vs_status (*run)(const vs_setup *setup, const vs_run_order *order, const vs_observer *observer,
                   vs_error *err);
} vs_tier;
extern const vs_tier vs_analytic_tier, vs_switched_tier, vs_coupled_tier, vs_compiled_tier;

/* The frame of all steps that this tier makes of this setup. */
vs_frame vs_sim_frame(const vs_tier *tier, const vs_setup *setup);

/* For tiers: the knot at t = 0. */
vs_knot vs_sim_start(const vs_setup *setup, const vs_frame *frame);

/* For tiers: refuses, with VS_INPUT, a run that would take 1e10 steps of this length or more, as it
 * would not end. */
vs_status vs_sim_refuse_endless(const vs_setup *setup, double step_s, vs_error *err);

/* Returns VS_OK if the step is within the model's validity; VS_RUN, with what is left and when, if
 * it is not. */
vs_status vs_sim_check(const vs_step *step, vs_error *err);

/* Runs the tier, and ends the run with VS_RUN where it leaves the model's validity: a state that is
 * not finite, the armature beyond the pole cover without a stop, a closed gap (z <= 0), a current
 * beyond sense. The observer is not shown such a step. */
vs_status vs_sim_run(const vs_tier *tier, const vs_setup *setup, const vs_run_order *order,
                     const vs_observer *observer, vs_error *err);

/* Why no run of this setup may leave the circuit's solver for what may stand in for it, as the user
 * is told; NULL: one may, or the order has nothing that stands in. */
const char *vs_sim_why_stays(const vs_run_order *order, const vs_setup *setup);
