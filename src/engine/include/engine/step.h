/* SPDX-License-Identifier: GPL-3.0-or-later
 * One accepted step, as a watcher is shown it: two knots, the channels anywhere between them, and
 * what happened on the way. */
#ifndef VS_ENGINE_STEP_H
#define VS_ENGINE_STEP_H

#include "base/error.h"
#include "engine/channel.h"
#include "engine/knot.h"

typedef enum vs_event {
  VS_EV_NONE,
  VS_EV_FIRES,
  VS_EV_EXTINCT,
  VS_EV_MEETS_STOP,
  VS_EV_LEAVES_STOP,
  VS_EV_JAMS,
  VS_EV_LOADS, /* the load changes: the step of no length has the new model in its frame */
  VS_EV_QUIET, /* the circuit's solver is left (engine/stand_in.h) */
  VS_EV_BACK   /* it has been gone back to */
} vs_event;

/* The knots belong to the tier and live as long as the observer's call. A step may have no length:
 * it then shows the other side of an instant at which something changed. */
typedef struct vs_step {
  const vs_frame *frame;
  const vs_knot *from, *to;
  bool cubic_flux;   /* lambda is a cubic, from values and first derivatives alone */
  bool periodic;     /* the deck's terms follow a law that repeats from cycle to cycle, as the
                        circuit's solver was left */
  bool glides;       /* the machine swings freely, and the step is longer than any polynomial holds:
                        its ends alone count, and lost_j */
  double lost_j;     /* where it glides: what damping takes in the step, J */
  bool held;         /* the armature is jammed: p" = 0 */
  vs_event event[2]; /* in order of time; VS_EV_NONE where there is none */
  double event_s[2]; /* when they happened: within the step, or as near to it as can be told */
  double strays; /* by Gear's rule: what it may have made so far of the coil's flux linkage while
                    that swung by itself, in parts of run.tolerance of its peak */
  double bound;  /* with VS_EV_QUIET and VS_EV_BACK: largest error that leaving the solver has
                    made, relative to each probe's peak */
} vs_step;

/* Computes all channels at t_s in [from, to] into y, which has room for vs_channel_count of them.
 * q is the Hermite polynomial of degree seven through value and three derivatives at each end, q'
 * is its slope; lambda is another such polynomial, or a cubic. Accelerations follow from these by
 * Eq. 54. The deck's terms, v_eva and i_mains of a circuit run straight from knot to knot. */
void vs_step_at(const vs_step *step, double t_s, double *y);
/* The same numbers, but only for these groups (VS_GROUP_...) and the channels that always come
 * along; the others in y are left as they are. */
void vs_step_groups_at(const vs_step *step, double t_s, unsigned groups, double *y);
/* The same rates q' alone, for whoever asks often: v has room for one for each coordinate. */
void vs_step_velocities_at(const vs_step *step, double t_s, double *v);
/* One channel at t_s, by its number. */
double vs_step_channel(const vs_step *step, double t_s, int channel);
/* True if there is no flux anywhere in the step, and so neither current nor force. */
bool vs_step_is_quiet(const vs_step *step);

#endif
