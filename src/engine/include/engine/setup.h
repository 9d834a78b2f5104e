/* SPDX-License-Identifier: GPL-3.0-or-later
 * One scene as numbers: machine, mains, deck, and the sections `run`, `start` and `measure`. */
#pragma once

#include "engine/channel.h"
#include "engine/cooling.h"
#include "engine/timeline.h"
#include "netlist/limits.h"
#include "plant/model.h"

/* ---- how a scene is run ----
 *
 * How a scene is to be run: the keys of its sections `run` and `measure`, and the tiers, whose
 * names are the words of run.tier. */

/* The tiers, from the simplest to the fullest: id, file, and the word for run.tier and --tier. The
 * file defines `const vs_tier vs_FILE_tier` (engine/sim.h); everything else that lists tiers, or
 * names them to the user, is made from these rows. */
#define VS_TIER_LIST(X)                                                                            \
  X(VS_TIER_ANALYTIC, analytic, "analytic")                                                        \
  X(VS_TIER_SWITCHED, switched, "switched")                                                        \
  X(VS_TIER_CIRCUIT, coupled, "circuit")                                                           \
  X(VS_TIER_COMPILED, compiled, "compiled")

enum {
#define VS_TIER_ID(id, file, word) id,
  VS_TIER_LIST(VS_TIER_ID)
#undef VS_TIER_ID
      VS_TIERS
};
extern const char vs_setup_tier_words[VS_TIERS][16];
#define VS_TIER_FITS(id, file, word) _Static_assert(sizeof word <= 16, "a longer word: more room");
VS_TIER_LIST(VS_TIER_FITS)
#undef VS_TIER_FITS

/* What run.ladder and run.verify may be, and their words in the same order. */
enum { VS_LADDER_CLIMB, VS_LADDER_IDEAL, VS_LADDER_STAY };
#define VS_LADDER_WORDS "climb|ideal|stay"
enum { VS_VERIFY_AUTO, VS_VERIFY_ALWAYS, VS_VERIFY_NEVER };
#define VS_VERIFY_WORDS "auto|always|never"

typedef struct vs_run_values {
  int tier; /* as the scene chooses it: 0 is auto, 1 + VS_TIER_... a tier */
  double until_s, sample_s;
  double tolerance;  /* largest error wanted, relative to each quantity's own peak */
  double max_step_s; /* 0: it follows from the tolerance */
  double first_step; /* where the mains are not at their zero at t = 0; a part of the largest */
  double trtol;      /* ngspice's own: a factor on the truncation error a step may have */
  double pivrel;     /* ngspice's own: decides the order in which it eliminates */
  int gear;          /* the circuit's rule: 0 is the trapezoidal, 1 Gear's of second order */
  int ladder;        /* how far it is climbed where the solver gives up: VS_LADDER_... */
  int verify;        /* whether a second run tells the margins' errors: VS_VERIFY_... */
  int stays;         /* 1: in the circuit's solver to the end, also when the circuit is quiet */
} vs_run_values;

/* run.first_step on the rungs of the ladder. */
#define VS_SETUP_LONGER_FIRST_STEP 1e-4

/* What means are taken over: from one instant to another, or the run's last cycles of the mains. */
typedef struct vs_measure_values {
  double from_s, to_s; /* to_s 0 stands for run.until */
  double last_cycles;  /* 0: from_s and to_s hold */
} vs_measure_values;

extern const vs_section vs_setup_run_keys, vs_setup_measure_keys; /* the keys with their defaults */

/* ---- the load over time ----
 *
 * The machine of a scene over time: events may change its load, and with it its masses. What is
 * added arrives with the trough's velocity, and what is taken away leaves with it, so that q and q'
 * go on as they are while M jumps. */

/* The machine from an instant on. */
typedef struct vs_loaded {
  double at_s;
  vs_model model; /* borrows what the coil of the scene's own model owns */
} vs_loaded;

/* Start from {0}; vs_setup_free frees it. */
typedef struct vs_loads {
  size_t count;
  vs_loaded *item; /* in order of time; owned */
} vs_loads;

/* Builds the machine that each event leaves behind from the scene's own, `model`, whose member
 * `reloaded` it sets. What an event does not name stays as it was before it. What `loads` had is
 * freed. Errors: the machine has no load; an event names neither of its keys; two events at one
 * instant; what vs_build_loaded refuses. */
vs_status vs_setup_make_loads(const vs_events *events, vs_machine *machine, vs_model *model,
                              vs_loads *loads, vs_error *err);

/* The event that changes the load at that instant; NULL: there is none. */
const vs_scene_event *vs_setup_load_event(const vs_events *events, double at_s);

/* When the change number k takes place, s; INFINITY: there are not so many. */
double vs_setup_load_at(const vs_loads *loads, size_t k);

/* ---- a scene as numbers ---- */

/* The machine's state at t = 0: q, q'. The circuit always begins without current and charge. */
typedef struct vs_start_values {
  double x[VS_MOST_STATES];
  double flux_wb; /* what the coil's flux linkage is at t = 0 besides that which it has without a
                     current; only an orbit without a valve or with eddy currents
                     (orbit/shooting.h) has some, on an ideal tier */
  double psi_wb[VS_MOST_RUNGS]; /* the same of the secondaries */
} vs_start_values;

extern const char vs_setup_steady[]; /* the word of `start` for an orbit */

/* Built once by vs_setup_build, then constant: what one run alone has, such as its files, stands
 * in its vs_run_order (engine/sim.h). */
typedef struct vs_setup {
  bool begun;          /* it has had something else than zeros in it */
  vs_machine *machine; /* owned; the model borrows it */
  vs_model model;      /* from the beginning on */
  vs_loads loads;      /* what events make of it; owned */
  vs_timeline timeline;
  vs_run_values run;
  vs_start_values start;
  bool wants_fraction;      /* load.fraction is auto, and the model's is not found yet, which
                               run/session.h does before a run */
  double throw_coefficient; /* with which it was found */
  double other_fraction;    /* another share that its own orbit asks for; NaN: none is known */
  bool other_on_ideal;      /* that one was looked for on an ideal tier alone, and the run has a
                               circuit */
  bool steady;  /* `start: steady`: the run begins on the scene's orbit, which run/session.h has
                   found for it; until then `start` is at rest */
  bool at_work; /* the run is whole periods of an orbit: what is seen comes again for ever */
  vs_limits_values limits;
  vs_measure_values measure;
  vs_span_s means; /* what `measure` says, as a stretch of time */
  vs_deck deck;    /* the scene's, also for a tier that does not use it; with what the scene's
                      events put into it */
  vs_circuit_values circuit_values;
  vs_cooling cooling;    /* of the deck's devices */
  vs_text written;       /* what the model was built from (plant/build.h); owned */
  vs_section_cache memo; /* what other sections were read from; owned */
} vs_setup;

/* True where a circuit begins at its operating point, with all ports pwm off: the deck says so, and
 * the supply is direct. */
bool vs_setup_stands(const vs_setup *setup);

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
/* The values of the parameters that every deck may use, and of those of its EVA (netlist/deck.h).
 */
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
