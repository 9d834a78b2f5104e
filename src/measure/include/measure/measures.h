/* SPDX-License-Identifier: GPL-3.0-or-later
 * Watcher that reduces a run to its measures while it goes on. Extremes (extremes.h) and
 * crossings are found by root-finding on the dense output, not by the largest sample. */
#pragma once

#include <gsl/gsl_roots.h>
#include <stdbool.h>

#include "measure/extremes.h"
#include "measure/pull_in.h"

/* The measures that every machine has, but for the last: id, name, unit, text. In a text %s stands
 * for what opens the gap: the name of the one coordinate that does, or "the travel". */
#define VS_MEASURE_LIST(X)                                                                         \
  X(VS_M_I_PEAK, "i_peak", "A", "largest |coil current|")                                          \
  X(VS_M_T_FIRE, "t_fire", "s", "first firing")                                                    \
  X(VS_M_T_EXTINCTION, "t_extinction", "s",                                                        \
    "end of the first conduction: the thyristor's current passes zero, and its burst of gate "     \
    "pulses does not fire it again")                                                               \
  X(VS_M_CONDUCTION, "conduction_time", "s",                                                       \
    "first conduction, from firing to extinction; gaps between a gate's sub-pulses included")      \
  X(VS_M_FORCE_PEAK, "force_peak", "N", "largest force")                                           \
  X(VS_M_GAP_FIRST, "gap_first_peak", "m",                                                         \
    "first peak of the travel (the gap's opening) after the first firing")                         \
  X(VS_M_GAP_SECOND, "gap_second_peak", "m", "the travel's extremum after its first peak")         \
  X(VS_M_GAP_MIN, "gap_min", "m", "least travel: how far the gap is closed")                       \
  X(VS_M_GAP_MAX, "gap_max", "m", "largest travel: how far the gap is opened")                     \
  X(VS_M_STROKE, "stroke", "m", "largest travel less the least, over the run")                     \
  X(VS_M_F_RESONANCE, "f_resonance", "Hz",                                                         \
    "of the free swing: from the rising zero crossings of %s after the first extinction, up to 1 " \
    "s "                                                                                           \
    "or the next firing")                                                                          \
  X(VS_M_TAU_GAP, "tau_gap", "s", "decay time of the travel in the free swing, by its extremes")   \
  X(VS_M_ENERGY_IN, "energy_in", "J", "drawn from the mains")                                      \
  X(VS_M_ENERGY_COPPER, "energy_copper", "J", "lost in the coil's resistance")                     \
  X(VS_M_WORK_FORCE, "work_force", "J", "done by the force on the machine")                        \
  X(VS_M_ENERGY_RESIDUAL, "energy_residual", "",                                                   \
    "largest imbalance of the energy books, as a part of |work_force| or of 1 % of |energy_in|, "  \
    "whichever is more")                                                                           \
  X(VS_M_PULL_IN, "pull_in", "s", "from switching on to the armature's first contact")             \
  X(VS_M_RELEASE, "release", "s",                                                                  \
    "from switching off to the instant at which the armature leaves its stop for good")            \
  X(VS_M_BOUNCE_TIME, "bounce_time", "s", "from the first contact to the last one")                \
  X(VS_M_BOUNCES, "bounces", "", "contacts after the first one")                                   \
  X(VS_M_IMPACT_SPEED, "impact_speed", "m/s", "speed of the travel at the first contact")          \
  X(VS_M_COIL_T, "coil.t_max", "degC", "highest temperature of the winding, by its losses")

/* VS_M_PULL_IN and the four after it are of a machine that pulls in alone (vs_model.pulls_in),
 * VS_M_COIL_T of one whose winding has a temperature. */
enum { VS_PULL_IN_MEASURES = 5 };

/* Where a measure's value stands in an array values[VS_MEASURES]: those above first, then three of
 * each coordinate i, at VS_M_OF_COORDINATE(i, VS_LEAST), VS_LARGEST and VS_PEAK. */
enum {
#define VS_MEASURE_ID(id, name, unit, text) id,
  VS_MEASURE_LIST(VS_MEASURE_ID)
#undef VS_MEASURE_ID
      VS_STANDARD_MEASURES,
  VS_MEASURES = VS_STANDARD_MEASURES + VS_OF_COORDINATE * VS_MOST_DOF
};
#define VS_M_OF_COORDINATE(i, which) (VS_STANDARD_MEASURES + VS_OF_COORDINATE * (i) + (which))

/* Some of these values. */
typedef struct vs_measure_set {
  bool has[VS_MEASURES];
} vs_measure_set;

/* One measure of a machine, as it is listed. */
typedef struct vs_measure {
  char name[VS_MACHINE_NAME + 16], text[VS_MACHINE_TEXT + 32];
  const char *unit; /* borrowed from the program or from the machine */
  int slot;         /* where its value stands */
  double factor;    /* what that value is multiplied by: -1 of a coordinate that closes the gap */
} vs_measure;

/* The most measures that a machine has: where one coordinate NAME alone opens the gap, and by as
 * much as it moves, there are NAME_first_peak, NAME_second_peak and tau_NAME besides. */
enum { VS_MOST_MEASURES = VS_MEASURES + 3 };

/* Fills `measure` with the k-th measure of the machine, from 0, in the order of lists, and returns
 * true; false: there are no more. Of the model only machine, dof, along
 * and pulls_in are read. */
bool vs_measure_at(const vs_model *model, int k, vs_measure *measure);
/* True where one coordinate opens the gap by as much as it moves, so that measures of the travel
 * also stand under that coordinate's name. */
bool vs_measure_has_alias(const vs_model *model);
/* True for a slot of those that only a machine has that pulls in. */
bool vs_measure_pulls_in(int slot);
/* How many there are. */
int vs_measures_count(const vs_model *model);

enum { VS_MOST_EXTREMES = 4 + VS_OF_COORDINATE * VS_MOST_DOF + 2 * VS_DECK_MOST };

/* A step that outlives the tier's own knots. */
typedef struct vs_kept_step {
  vs_knot from, to;
  vs_step step;
} vs_kept_step;

/* A channel whose least and largest value are followed besides, and its range, SI. */
typedef struct vs_followed {
  int channel;
  double min, max;
  vs_extreme end[2]; /* the least and the largest value so far */
  double passed_s;   /* when it first left the range; NaN: it has not */
} vs_followed;

typedef struct vs_measures {
  const vs_frame *frame;
  vs_kept_step kept[2]; /* the last two steps of some length; `last` is the index of the newer */
  int last, steps;      /* steps: how many are kept, 0..2 */
  bool no_turns;        /* nobody wants what the travel's turns tell, so that none are kept */
  double travel_m[3];   /* the travel at the three ends of the kept steps */
  bool jammed;          /* the armature has jammed */
  /* The current's and the force's; three of each coordinate; the travel's, where no coordinate
   * has the same ones; then, from of_probes on, least and largest of each of the deck's probes. */
  vs_extreme extremes[VS_MOST_EXTREMES];
  int of_travel, of_probes, n_extremes;
  double drives_s; /* from when on a motion peak counts: the first firing, or 0 where no valve
                      fires; NaN: not yet */
  double passed_s[VS_DECK_MOST]; /* when each of the deck's ratings was first passed; NaN: it was
                                    not */
  double fired_s, extinct_s, refired_s; /* first firing, the extinction behind it, second firing;
                                           NaN: not yet */
  double rested_s;        /* extinction before the first firing; NaN: there was none */
  vs_value first, second; /* motion peaks of the travel */
  /* rising zero crossings of the travel in the free swing: how many, and when the first and the
   * last were */
  double crossings, first_crossing_s, last_crossing_s;
  vs_value swing;             /* the last extremum of the travel there */
  double n, st, sl, stt, stl; /* sums for the straight line of ln(amplitude) over t */
  vs_pull_in pull_in;
  gsl_root_fsolver *solver; /* owned */
  vs_followed *followed;    /* channels that vs_measures_follow has named; owned */
  size_t n_followed;
} vs_measures;

/* The frame must outlive the watcher, which vs_measures_free frees. wants: of the extremes of
 * coordinates and travel those that are followed, while the others stay unknown; NULL: all. */
vs_measures *vs_measures_new(const vs_frame *frame, const vs_measure_set *wants);
void vs_measures_free(vs_measures *measures);
/* Before the first step: follows another channel of the frame. An end of its range that is 0 counts
 * as vs_measures_slack says. */
void vs_measures_follow(vs_measures *measures, int channel, double min, double max);
/* What was seen of a channel that is followed; NULL: it is not. */
const vs_followed *vs_measures_followed(const vs_measures *measures, int channel);
/* Takes one accepted step. */
void vs_measures_accept(vs_measures *measures, const vs_step *step);
/* The least and the largest value of one of the deck's probes so far: two extremes, one behind the
 * other. probe: its number in the deck, from 0. */
const vs_extreme *vs_measures_of_probe(const vs_measures *measures, int probe);
/* Writes which of the deck's probes has the least certain extreme, where that one is met by a
 * single step and stands out from the steps beside it by more than a fiftieth of the probe's
 * largest magnitude. False: no probe has such an extreme. */
bool vs_measures_are_sharp(const vs_measures *measures, char *text, size_t size);
/* How far a probe may pass an end of its rating that is 0, in the probe's SI unit: such an end says
 * which sign the probe may have. It is run.tolerance of the rating's range, the scale on which the
 * run is judged, or of the probe's largest magnitude so far where the rating has no other end. */
double vs_measures_slack(const vs_measures *measures, const vs_rating *rating);
/* f_resonance and tau_gap are read up to this instant, as the paper's figures are. */
extern const double vs_measures_swing_ends_s;
/* An extremum this much smaller than a later one was no motion peak but a ripple before it. */
extern const double vs_measures_ripple;

/* Gives the values of all measures but the energies, values[VS_MEASURES]. */
void vs_measures_finish(const vs_measures *measures, vs_value values[VS_MEASURES]);
