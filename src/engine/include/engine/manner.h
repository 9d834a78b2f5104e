/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a scene is to be run: the keys of its sections `run` and `measure`, and the tiers, whose
 * names are the words of run.tier. */
#ifndef VS_ENGINE_MANNER_H
#define VS_ENGINE_MANNER_H

#include "engine/frame.h"

/* The tiers, from the simplest to the fullest: id, file, and the word for run.tier and --tier. The
 * file defines `const vs_tier vs_FILE_tier` (engine/sim.h); everything else that lists tiers, or names
 * them to the user, is made from these rows. */
#define VS_TIER_LIST(X)                                                                            \
  X(VS_TIER_ANALYTIC, analytic, "analytic")                                                        \
  X(VS_TIER_SWITCHED, switched, "switched")                                                        \
  X(VS_TIER_CIRCUIT, coupled, "circuit")

enum {
#define VS_TIER_ID(id, file, word) id,
  VS_TIER_LIST(VS_TIER_ID)
#undef VS_TIER_ID
      VS_TIERS
};
extern const char vs_manner_tier_words[VS_TIERS][16];
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
  int ladder;        /* how far it is climbed where ngspice gives up: VS_LADDER_... */
  int verify;        /* whether a second run tells the margins' errors: VS_VERIFY_... */
  int stays;         /* 1: in the circuit's solver to the end, also when the circuit is quiet */
} vs_run_values;

/* run.first_step on the rungs of the ladder. */
#define VS_MANNER_LONGER_FIRST_STEP 1e-4

/* What means are taken over: from one instant to another, or the run's last cycles of the mains. */
typedef struct vs_measure_values {
  double from_s, to_s; /* to_s 0 stands for run.until */
  double last_cycles;  /* 0: from_s and to_s hold */
} vs_measure_values;

extern const vs_section vs_manner_run, vs_manner_measure; /* the keys with their defaults */

/* Gives the stretch of time that means are taken over. map: the section measure, as v was read from
 * it; period_s: of the mains. Errors: from is not before to, to is beyond run.until, there are more
 * cycles than the run has, both ways are taken at once. */
vs_status vs_manner_means(const vs_measure_values *v, const vs_node *map, double until_s,
                          double period_s, vs_span_s *means, vs_error *err);

#endif
