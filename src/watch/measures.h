/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that reduces a run to its standard measures while it goes on. Extremes (extremes.h) and
 * crossings are found by root-finding on the dense output, not by the largest sample. */
#ifndef VS_WATCH_MEASURES_H
#define VS_WATCH_MEASURES_H

#include <gsl/gsl_roots.h>
#include <stdbool.h>

#include "watch/extremes.h"

/* The standard measures, which every tier has. id, name, unit, text */
#define VS_MEASURE_LIST(X)                                                                         \
  X(VS_M_I_PEAK, "i_peak", "A", "largest |coil current|")                                          \
  X(VS_M_T_FIRE, "t_fire", "s", "first firing")                                                    \
  X(VS_M_T_EXTINCTION, "t_extinction", "s", "first extinction: the anode current reaches zero")    \
  X(VS_M_CONDUCTION, "conduction_time", "s",                                                       \
    "first conduction, from firing to extinction; gaps between a gate's sub-pulses included")      \
  X(VS_M_FORCE_PEAK, "force_peak", "N", "largest force")                                           \
  X(VS_M_P_FIRST, "p_first_peak", "m", "first motion peak of p after the first firing")            \
  X(VS_M_P_SECOND, "p_second_peak", "m", "the extremum of p that follows it")                      \
  X(VS_M_P_MIN, "p_min", "m", "least p")                                                           \
  X(VS_M_P_MAX, "p_max", "m", "largest p")                                                         \
  X(VS_M_AP_PEAK, "ap_peak", "m/s2", "largest |acceleration| of p")                                \
  X(VS_M_AU_PEAK, "au_peak", "m/s2", "largest |acceleration| of u")                                \
  X(VS_M_AW_PEAK, "aw_peak", "m/s2", "largest |acceleration| of w")                                \
  X(VS_M_F_RESONANCE, "f_resonance", "Hz",                                                         \
    "of the free swing, from the rising zero crossings of p between the first extinction and 1 s " \
    "or the next firing")                                                                          \
  X(VS_M_TAU_P, "tau_p", "s", "decay time of p there, from the envelope of its extremes")          \
  X(VS_M_ENERGY_IN, "energy_in", "J", "drawn from the mains")                                      \
  X(VS_M_ENERGY_COPPER, "energy_copper", "J", "lost in the coil's resistance")                     \
  X(VS_M_WORK_FORCE, "work_force", "J", "done by the force on the machine")                        \
  X(VS_M_ENERGY_RESIDUAL, "energy_residual", "",                                                   \
    "what the worst energy balance leaves over, relative to |work_force| or to 1 % of "            \
    "|energy_in|, "                                                                                \
    "whichever is more")

enum {
#define VS_MEASURE_ID(id, name, unit, text) id,
  VS_MEASURE_LIST(VS_MEASURE_ID)
#undef VS_MEASURE_ID
      VS_MEASURES
};

typedef struct vs_measure {
  const char *name, *unit, *text;
} vs_measure;
extern const vs_measure vs_measures_standard[VS_MEASURES];

/* The measures that are extremes of a channel. id, channel, sense (as vs_extreme has it) */
#define VS_EXTREME_LIST(X)                                                                         \
  X(VS_M_I_PEAK, VS_CH_I, 0)                                                                       \
  X(VS_M_FORCE_PEAK, VS_CH_FORCE, 1)                                                               \
  X(VS_M_P_MIN, VS_CH_TRAVEL, -1)                                                                  \
  X(VS_M_P_MAX, VS_CH_TRAVEL, 1)                                                                   \
  X(VS_M_AP_PEAK, VS_RATE2(0), 0)                                                                  \
  X(VS_M_AU_PEAK, VS_RATE2(1), 0)                                                                  \
  X(VS_M_AW_PEAK, VS_RATE2(2), 0)

enum {
#define VS_EXTREME_ONE(measure, channel, sense) +1
  VS_STANDARD_EXTREMES = 0 VS_EXTREME_LIST(VS_EXTREME_ONE),
#undef VS_EXTREME_ONE
  VS_MOST_EXTREMES = VS_STANDARD_EXTREMES + 2 * VS_DECK_MOST
};

/* A step that outlives the tier's own knots. */
#define VS_RATE2(i) (-1 - (i)) /* transitional: the second rate of coordinate i */
typedef struct vs_kept_step {
  vs_knot from, to;
  vs_step step;
} vs_kept_step;

typedef struct vs_measures {
  const vs_frame *frame;
  vs_kept_step kept[2]; /* the last two steps of some length; `last` is the index of the newer */
  int last, steps;      /* steps: how many are kept, 0..2 */
  double travel_m[3];   /* the travel at the three ends of the kept steps */
  bool jammed;          /* the armature has jammed */
  /* those of VS_EXTREME_LIST in its order, then least and largest of each of the deck's probes */
  vs_extreme extremes[VS_MOST_EXTREMES];
  int n_extremes;
  double passed_s[VS_DECK_MOST]; /* when each of the deck's ratings was first passed; NaN: it was
                                    not */
  double fired_s, extinct_s, refired_s; /* first firing, first extinction, second firing; NaN: not
                                           yet */
  vs_value first, second;               /* motion peaks of p */
  /* rising zero crossings of p in the free swing: how many, and when the first and the last were */
  double crossings, first_crossing_s, last_crossing_s;
  vs_value swing;             /* the last extremum of p in the free swing */
  double n, st, sl, stt, stl; /* sums for the straight line of ln(amplitude) over t */
  gsl_root_fsolver *solver;   /* owned */
} vs_measures;

/* The frame must outlive the watcher, which vs_measures_free frees. */
vs_measures *vs_measures_new(const vs_frame *frame);
void vs_measures_free(vs_measures *measures);
/* Takes one accepted step. */
void vs_measures_accept(vs_measures *measures, const vs_step *step);
/* The least and the largest value of one of the deck's probes so far: two extremes, one behind the
 * other. probe: its number in the deck, from 0. */
const vs_extreme *vs_measures_of_probe(const vs_measures *measures, int probe);
/* How far a probe may pass an end of its rating that is 0, in the probe's SI unit: such an end says
 * which sign the probe may have. It is run.tolerance of the rating's range, the scale on which the
 * run is judged, or of the probe's largest magnitude so far where the rating has no other end. */
double vs_measures_slack(const vs_measures *measures, const vs_rating *rating);
/* Gives the values of all standard measures but the energies, values[VS_MEASURES]. */
void vs_measures_finish(const vs_measures *measures, vs_value values[VS_MEASURES]);

#endif
