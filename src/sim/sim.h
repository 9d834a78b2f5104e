/* SPDX-License-Identifier: GPL-3.0-or-later
 * A sim lets time pass for a model through one tier and shows every accepted step to an observer.
 */
#ifndef VS_SIM_SIM_H
#define VS_SIM_SIM_H

#include <stddef.h>

#include "sim/step.h"
#include "solver/circuit.h"

/* The words of run.ladder and run.verify, in their order. */
enum { VS_LADDER_CLIMB, VS_LADDER_IDEAL, VS_LADDER_STAY };
enum { VS_VERIFY_AUTO, VS_VERIFY_ALWAYS, VS_VERIFY_NEVER };

typedef struct vs_run_values {
  int tier; /* as chosen in the scene: 0 auto, then the order of vs_tiers_all */
  double until_s, sample_s;
  double tolerance;  /* largest error wanted, relative to each quantity's own peak */
  double max_step_s; /* 0: from the tolerance */
  double trtol;      /* ngspice's own: a factor on the truncation error a step may have */
  double pivrel;     /* ngspice's own: decides the order in which it eliminates */
  int gear;          /* the circuit's rule: 0 trapezoidal, 1 Gear's of second order */
  int ladder;        /* how far it is climbed where ngspice gives up: VS_LADDER_... */
  int verify;        /* whether a second run tells the margins' errors: VS_VERIFY_... */
  int stays;         /* in the circuit's solver to the end, also when the circuit is quiet */
} vs_run_values;
/* What means are over: from one instant to another, or the run's last cycles of the mains. */
typedef struct vs_measure_values {
  double from_s, to_s; /* to_s 0: run.until */
  double last_cycles;  /* 0: from and to hold */
} vs_measure_values;
/* The machine's state at t = 0: q, q'. The circuit always begins without current and charge. */
typedef struct vs_start_values {
  double x[VS_STATES];
} vs_start_values;
extern const vs_section vs_setup_run_section, vs_setup_start_section, vs_setup_measure_section;

/* One scene as numbers. Built once, then constant. */
typedef struct vs_setup {
  vs_model model;
  vs_timeline timeline;
  vs_run_values run;
  vs_start_values start;
  vs_measure_values measure;
  vs_span_s means; /* as that says */
  vs_deck deck;    /* the scene's, also when the tier does not use it */
  vs_circuit_values circuit_values;
  const vs_circuit_kind *solver; /* of the circuit: vs_ng_kind, or a test's own */
  FILE *raw;                     /* tier circuit: gets a rawfile of the run; NULL: none */
  bool tried; /* tier circuit: this deck with these parts was run in this process before */
} vs_setup;

/* Reads the sections machine, actuator, load, supply, firing, circuit, run, start, measure.
 * vs_setup_free
 * even after an error. */
vs_status vs_setup_build(const vs_node *scene, vs_setup *setup, vs_error *err);
void vs_setup_free(vs_setup *setup);

/* The same over a setup that was built: the numbers anew, the deck's text only when the scene names
 * another deck or other parts, or has events. What is built is the same. */
vs_status vs_setup_again(const vs_node *scene, vs_setup *setup, vs_error *err);

/* The parameters every deck may use, as the scene has them, and those of its EVA (deck/deck.h).
 */
void vs_setup_standard(const vs_setup *setup, vs_deck_value standard[VS_STANDARD]);

typedef struct vs_observer {
  void *ctx;
  vs_status (*accept)(void *ctx, const vs_step *step, vs_error *err); /* not VS_OK ends the run */
} vs_observer;

typedef struct vs_tier {
  const char *name, *text;
  double finest; /* smallest run.tolerance it can hold */
  vs_frame (*frame)(const vs_setup *setup);
  /* From the start at t = 0 to run.until; nothing guards its validity: see vs_sim_run. Errors name
   * the time and the cause. */
  vs_status (*run)(const vs_setup *setup, const vs_observer *observer, vs_error *err);
} vs_tier;

extern const vs_tier vs_analytic_tier, vs_switched_tier, vs_coupled_tier;
enum { VS_TIERS = 3 };
extern const vs_tier *const vs_tiers_all[VS_TIERS];
const vs_tier *vs_tiers_find(const char *name); /* NULL: there is none */

/* For tiers: the knot at t = 0. */
vs_knot vs_sim_start(const vs_setup *setup, const vs_frame *frame);

/* For tiers: refuses a run of so many steps that it would not end. */
vs_status vs_sim_check_steps(const vs_setup *setup, double step_s, vs_error *err);

/* The longest step that the circuit tier takes, s. */
double vs_pace_largest_step(const vs_setup *setup);

/* Runs the tier, and ends the run where it leaves the model's validity (finite, z > 0, p >= -D
 * without a stop, a current that makes sense): the observer is not shown such a step. */
vs_status vs_sim_run(const vs_tier *tier, const vs_setup *setup, const vs_observer *observer,
                     vs_error *err);

#endif
