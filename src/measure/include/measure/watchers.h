/* SPDX-License-Identifier: GPL-3.0-or-later
 * All watchers of one run. Each accepted step is shown to every one of them; what they have seen is
 * read from their own structs. */
#pragma once

#include "engine/sim.h"
#include "measure/devices.h"
#include "measure/energy.h"
#include "measure/measures.h"

/* The stretches of a run that went without ngspice, as the circuit was quiet
 * (engine/macromodel/oneport_macromodel.c). */
typedef struct vs_absence {
  int times;      /* how often ngspice was left */
  double first_s; /* instant at which it was first left */
  double total_s; /* how long all stretches are together, s */
  double since_s; /* beginning of the present stretch */
  bool now;       /* a stretch has begun and not ended */
  double bound;   /* on the error by all of this, relative to each probe's peak */
} vs_absence;

/* Start from {0}. vs_watchers_begin may be called again for another run, and vs_watchers_free may
 * be called at any time. */
typedef struct vs_watchers {
  vs_measures *measures; /* owned; NULL before the first run */
  vs_devices *devices;   /* owned; NULL: the deck has none */
  vs_batch *batch;       /* owned; NULL: there is no deck. Steps that devices and losses, whose
                            formulas cost most, have not seen yet */
  bool began;            /* a step was accepted */
  bool prompt;           /* set behind vs_watchers_begin: no step waits, as someone asks what was
                            seen of it, or as the scene's firings or events are decided on the way */
  vs_energy energy;
  vs_winding_state heat; /* of the winding, by the losses so far */
  double hottest_degc;
  double burnt_s;     /* when it passed VS_WINDING_BURNT_DEGC; NaN: it did not */
  vs_warming warming; /* its model is owned; NULL: the run keeps its resistance */
  double lag;         /* by which share the resistance was off at most, while it followed */
  double flux_wb;     /* the largest |lambda| so far; kept where actuator.linear_to is given */
  vs_absence absence;
  double strays;          /* of the last step (engine/step.h) */
  vs_sequence sequence;   /* of the run's own firings and ends (engine/step.h) */
  vs_measure_set settled; /* as vs_watchers_may_end_early found it the last time */
  bool left;              /* the rest of the run was left out: what is not settled is not known */
  double left_s;          /* from here on, where it was */
} vs_watchers;

/* Begins a run anew. The frame must outlive the watchers' use. wants: as for vs_measures_new. */
void vs_watchers_begin(vs_watchers *watchers, const vs_frame *frame, const vs_measure_set *wants);
/* Returns what lets the run's resistance follow the winding's temperature, for its order, borrowed;
 * NULL: the run keeps it, as nothing says how warm the winding becomes, as its temperature is that
 * of an orbit already, as no thyristor fires, or as a circuit or a load that changes stands in the
 * way. */
const vs_warming *vs_watchers_warm(vs_watchers *watchers, const vs_setup *setup);
/* Shows one accepted step to all. */
void vs_watchers_accept(vs_watchers *watchers, const vs_step *step);
/* Returns true if the rest of the run cannot change any of the values that are wanted, so that it
 * may be left out (vs_observer.leaves). What it could change is then not known at the end. */
bool vs_watchers_may_end_early(vs_watchers *watchers, const vs_swing_rest *rest,
                               const vs_measure_set *wanted);
/* The run has ended at until_s: completes what each has seen and gives the standard measures, the
 * energies included, values[VS_MEASURES]. */
void vs_watchers_finish(vs_watchers *watchers, double until_s, vs_value values[VS_MEASURES]);
/* By how much coil.t_max may be off, K, as the resistance was another one than the winding's
 * temperature makes it: by a share s of the losses, and the rise then adds as much to s again.
 * INFINITY: the losses may be twice as large, or more. */
double vs_watchers_heat_doubt(const vs_watchers *watchers);
void vs_watchers_free(vs_watchers *watchers);
