/* SPDX-License-Identifier: GPL-3.0-or-later
 * One scene as numbers: machine, mains, deck, and the sections `run`, `start` and `measure`. */
#ifndef VS_SETUP_SETUP_H
#define VS_SETUP_SETUP_H

#include "bounds/limits.h"
#include "setup/cooling.h"
#include "setup/loads.h"
#include "setup/manner.h"

/* The machine's state at t = 0: q, q'. The circuit always begins without current and charge. */
typedef struct vs_start_values {
  double x[VS_MOST_STATES];
  double flux_wb; /* what the coil's flux linkage is at t = 0 besides that which it has without a
                     current; only an orbit without a valve (orbit/shooting.h) has some, on an ideal
                     tier */
} vs_start_values;

extern const char vs_setup_steady[]; /* the word of `start` for an orbit */

/* Built once by vs_setup_build, then constant: what one run alone has, such as its files, stands
 * in its vs_run_order (sim/sim.h). */
typedef struct vs_setup {
  bool begun;          /* it has had something else than zeros in it */
  vs_machine *machine; /* owned; the model borrows it */
  vs_model model;      /* from the beginning on */
  vs_loads loads;      /* what events make of it; owned */
  vs_timeline timeline;
  vs_run_values run;
  vs_start_values start;
  bool wants_fraction;      /* load.fraction is auto, and the model's is not found yet, which
                               scene/session.h does before a run */
  double throw_coefficient; /* with which it was found */
  double other_fraction;    /* another share that its own orbit asks for; NaN: none is known */
  bool other_on_ideal;      /* that one was looked for on an ideal tier alone, and the run has a
                               circuit */
  bool steady;  /* `start: steady`: the run begins on the scene's orbit, which scene/session.h has
                   found for it; until then `start` is at rest */
  bool at_work; /* the run is whole periods of an orbit: what is seen comes again for ever */
  vs_limits_values limits;
  vs_measure_values measure;
  vs_span_s means; /* what `measure` says, as a stretch of time */
  vs_deck deck;    /* the scene's, also for a tier that does not use it; with what the scene's
                      events put into it */
  vs_circuit_values circuit_values;
  vs_cooling cooling; /* of the deck's devices */
  vs_text written;    /* what the model was built from (machine/build.h); owned */
  vs_memo memo;       /* what other sections were read from; owned */
} vs_setup;

/* Reads the scene's sections machine, actuator, load, supply, firing, circuit, run, events, start
 * and measure, and its keys ambient and heatsink. Errors: whatever these can be wrong in; a check
 * carries on from most of it. The caller owns the setup and calls vs_setup_free, also after an
 * error. */
vs_status vs_setup_build(const vs_node *scene, vs_setup *setup, vs_error *err);
void vs_setup_free(vs_setup *setup);

/* Makes the setup of another run of the same scene: with these values of the section run and,
 * unless x is NULL, from the state x. If run.until is another, means are over the whole run. It
 * borrows what the machine and the deck of `from` own, and is not to be freed. */
vs_setup vs_setup_varied(const vs_setup *from, const vs_run_values *run,
                         const double x[VS_MOST_STATES]);

/* Builds another scene over a setup that was built before. The result is the same as vs_setup_build
 * would give, but the deck's text is only read where vs_setup_keeps_deck says no, and the machine's
 * file where the scene names another. */
vs_status vs_setup_again(const vs_node *scene, vs_setup *setup, vs_error *err);

/* True if the scene names the deck and the parts that the setup has, so that vs_setup_again keeps
 * their text. Events put lines of their own into a deck; one that has some, or is to get some, is
 * not kept. */
bool vs_setup_keeps_deck(const vs_node *scene, const vs_setup *setup);

/* What the circuit has for supply.resistance: this, or what its solver takes in the place of 0. */
double vs_setup_source_ohm(const vs_setup *setup);
/* The values of the parameters that every deck may use, and of those of its EVA (deck/deck.h). */
void vs_setup_standard(const vs_setup *setup, vs_deck_value standard[VS_STANDARD]);

/* First instant after t_s that must be the end of a step for the circuit: an edge of what a port of
 * the deck is driven with, or of an event, or the next decision of a control. INFINITY: none. */
double vs_setup_edge(const vs_setup *setup, double t_s);

/* True if load.fraction is auto, and what it comes to has been found for this setup. */
bool vs_setup_found_fraction(const vs_setup *setup);
/* Error, VS_INPUT: it is auto and has not been found; `who` wants a number. */
vs_status vs_setup_require_fraction(const vs_setup *setup, vs_where where, const char *who,
                                    vs_error *err);

/* When an event jams the armature first, s; INFINITY: none does. */
double vs_setup_jams(const vs_setup *setup);

/* When an event cuts the coil off from the deck first, s; INFINITY: none does. */
double vs_setup_coil_cut(const vs_setup *setup);

#endif
