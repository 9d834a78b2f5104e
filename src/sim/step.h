/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a watcher is shown: one accepted step, its channels anywhere inside it, and what happened in
 * it. */
#ifndef VS_SIM_STEP_H
#define VS_SIM_STEP_H

#include <stdbool.h>

#include "base/error.h"
#include "deck/deck.h"
#include "drive/timeline.h"
#include "machine/mechanics.h"

/* Channels of every tier, in the order of the CSV: id, name, unit, text.
 * The last, drawn from the mains, is for the energy audit and in no list. */
#define VS_CHANNEL_LIST(X)                                                                         \
  X(VS_CH_P, "p", "m", "trough relative to base, along the springs' motion")                       \
  X(VS_CH_U, "u", "m", "base, horizontal")                                                         \
  X(VS_CH_W, "w", "m", "base, vertical")                                                           \
  X(VS_CH_PHI, "phi", "rad", "base, rotation, counter-clockwise")                                  \
  X(VS_CH_VP, "vp", "m/s", "velocity of p")                                                        \
  X(VS_CH_VU, "vu", "m/s", "velocity of u")                                                        \
  X(VS_CH_VW, "vw", "m/s", "velocity of w")                                                        \
  X(VS_CH_VPHI, "vphi", "rad/s", "velocity of phi")                                                \
  X(VS_CH_AP, "ap", "m/s2", "acceleration of p")                                                   \
  X(VS_CH_AU, "au", "m/s2", "acceleration of u")                                                   \
  X(VS_CH_AW, "aw", "m/s2", "acceleration of w")                                                   \
  X(VS_CH_APHI, "aphi", "rad/s2", "acceleration of phi")                                           \
  X(VS_CH_Z, "z", "m", "air gap D + d + p")                                                        \
  X(VS_CH_LAMBDA, "lambda", "Wb", "flux linkage of the EVA")                                       \
  X(VS_CH_I, "i", "A", "coil current of the EVA")                                                  \
  X(VS_CH_FORCE, "force", "N", "force on the armature")                                            \
  X(VS_CH_V_EVA, "v_eva", "V", "voltage across the EVA")                                           \
  X(VS_CH_V_MAINS, "v_mains", "V", "mains voltage behind its impedance")                           \
  X(VS_CH_I_MAINS, "i_mains", "A", "current drawn from the mains")

enum {
#define VS_CHANNEL_ID(id, name, unit, text) id,
  VS_CHANNEL_LIST(VS_CHANNEL_ID)
#undef VS_CHANNEL_ID
      VS_CH_DECK, /* the deck's probes follow from here */
  VS_CH_MOST = VS_CH_DECK + VS_DECK_MOST
};

typedef struct vs_channel {
  const char *name, *unit, *text;
  bool listed; /* in CSV files and lists */
} vs_channel;
extern const vs_channel vs_channel_standard[VS_CH_DECK];

/* A stretch of time, s. */
typedef struct vs_span_s {
  double from_s, to_s;
} vs_span_s;

/* Everything that is the same for all steps of one run. */
typedef struct vs_frame {
  const vs_model *model;
  const vs_timeline *timeline;
  const vs_deck *deck; /* NULL but on the circuit tier */
  bool gap_at_rest;    /* analytic tier: i = lambda z(0)/(2a), L constant (Eq. 91) */
  vs_span_s means;     /* what means are over; from 0 to 0: the whole run */
  double tolerance;    /* run.tolerance */
  bool source_is_coil; /* no circuit in between: the mains current is the coil's, and v = R_c i +
                          dlambda/dt */
} vs_frame;

int vs_channel_count(const vs_frame *frame);
vs_channel vs_channel_at(const vs_frame *frame, int index);
int vs_channel_find(const vs_frame *frame, const char *name); /* -1: there is none */

/* The state at one instant with the derivatives that dense output and channels need. */
typedef struct vs_knot {
  double t_s;
  double x[VS_STATES];         /* q, q' */
  double a[VS_DOF], j[VS_DOF]; /* q", q"' */
  /* lambda and its derivatives; where flux is cubic the last two are not asked for */
  double flux_wb, flux_rate_v, flux_rate2_v_s, flux_rate3_v_s2;
  double v_eva_v, i_mains_a;  /* circuit tier only: as the circuit has them */
  double terms[VS_DECK_MOST]; /* the last member: the deck's, of its probes and formulas */
} vs_knot;

/* Copies a knot with no more terms than the deck has. */
void vs_knot_copy(const vs_frame *frame, const vs_knot *from, vs_knot *to);

typedef enum vs_event {
  VS_EV_NONE,
  VS_EV_FIRES,
  VS_EV_EXTINCT,
  VS_EV_MEETS_STOP,
  VS_EV_LEAVES_STOP,
  VS_EV_JAMS,
  VS_EV_QUIET, /* the circuit's solver is left: quiet/quiet.h */
  VS_EV_BACK
} vs_event;

typedef struct vs_step {
  const vs_frame *frame;
  const vs_knot *from, *to;
  bool cubic_flux;   /* flux between the knots by its values and first derivatives alone */
  bool periodic;     /* the deck's terms are as in any other cycle */
  bool held;         /* the armature is jammed: p" = 0 */
  vs_event event[2]; /* in order of time; VS_EV_NONE where there is none */
  double event_s[2]; /* in [from, to], or as near as it can be told */
  double bound;      /* of VS_EV_QUIET: largest error by it, relative to each probe's peak */
} vs_step;

/* Fills q", q"' of a knot from its state and flux; touching: on the side of the stop. */
void vs_knot_complete(const vs_frame *frame, vs_knot *knot, bool touching);
/* The same of a jammed armature, whose p' is 0 and stays so. */
void vs_knot_hold(const vs_frame *frame, vs_knot *knot);

/* What some of the channels cost of their own; all others are always there. */
enum {
  VS_GROUP_VELOCITIES = 1,
  VS_GROUP_ACCELERATIONS = 2, /* needs the velocities */
  VS_GROUP_V_EVA = 4,
  VS_GROUP_V_MAINS = 8,
  VS_GROUP_DECK = 16, /* the deck's probes */
  VS_GROUP_ALL = 31
};
unsigned vs_channel_groups(const int *channels, int count);

/* All channels at t in [from, to], y[vs_channel_count]: for q the Hermite polynomial of degree
 * seven from value and three derivatives at each end, for q' its slope; the same or a cubic for
 * lambda; accelerations from Eq. 54; straight lines for the deck's terms. */
void vs_step_at(const vs_step *step, double t_s, double *y);
/* The same numbers, but only the parts wanted: the other channels are left as they are. */
void vs_step_groups_at(const vs_step *step, double t_s, unsigned parts, double *y);
double vs_step_channel(const vs_step *step, double t_s, int channel);
/* Is there no flux anywhere in it, and so neither current nor force? */
bool vs_step_is_quiet(const vs_step *step);

#endif
