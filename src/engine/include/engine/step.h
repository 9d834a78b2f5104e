/* SPDX-License-Identifier: GPL-3.0-or-later
 * One accepted step, as a watcher is shown it: the states at its two ends (knots), the channels
 * anywhere between them, and what happened on the way. */
#pragma once

#include "base/error.h"
#include "engine/channel.h"
#include "plant/mechanics.h"

/* ---- knots ---- */

/* A knot: the state at one end of a step, with the derivatives that the polynomials between two
 * knots need. */
typedef struct vs_knot {
  double t_s;
  double x[VS_MOST_STATES];              /* q, q' (plant/model.h): m, rad, m/s, rad/s */
  double a[VS_MOST_DOF], j[VS_MOST_DOF]; /* q", q"' */
  /* lambda and its derivatives. Where a step's cubic_flux is set the last two do not count, but are
   * finite all the same. */
  double flux_wb, flux_rate_v, flux_rate2_v_s, flux_rate3_v_s2;
  double psi_wb[VS_MOST_RUNGS]; /* of the secondaries with leakage (plant/coil.h) */
  double v_eva_v, i_mains_a;    /* as the circuit has them; not set on a tier without a circuit */
  double terms[VS_DECK_MOST]; /* of the deck's probes and formulas, V or A, in the deck's order; the
                                 last member, so that a copy may leave out those behind the deck's
                                 own */
} vs_knot;

/* Copies a knot, with no more terms than the deck has. */
void vs_step_copy_knot(const vs_frame *frame, const vs_knot *from, vs_knot *to);

/* Sets q" and q"' of a knot from its q, q' and flux linkage by Eq. 54. `touched`: the
 * stops whose force counts, as vs_stops_touched has them. On the instant of contact a knot belongs
 * to either side, so that q alone cannot tell. */
void vs_step_complete_knot(const vs_frame *frame, vs_knot *knot, unsigned touched);
/* The same for a jammed armature: the gap's rate is 0 and stays 0. */
void vs_step_hold_knot(const vs_frame *frame, vs_knot *knot);

/* ---- steps ---- */

typedef enum vs_event {
  VS_EV_NONE,
  VS_EV_FIRES,
  VS_EV_EXTINCT,
  VS_EV_MEETS_STOP,
  VS_EV_LEAVES_STOP,
  VS_EV_JAMS,
  VS_EV_LOADS, /* the load changes: the step of no length has the new model in its frame */
  VS_EV_QUIET, /* the circuit's solver is left (engine/macromodel/macromodel.h) */
  VS_EV_BACK   /* it has been gone back to */
} vs_event;

enum { VS_STEP_PARTS = 15 }; /* instants within a step at most */

/* The knots belong to the tier and live as long as the observer's call. A step may have no length:
 * it then shows the other side of an instant at which something changed. */
typedef struct vs_step {
  const vs_frame *frame;
  const vs_knot *from, *to;
  const vs_knot *part; /* instants within the step, in order, of which t_s, v_eva_v, i_mains_a and
                          terms are set: these run straight from one to the next */
  int parts;           /* how many; 0: from end to end */
  bool cubic_flux;     /* lambda is a cubic, from values and first derivatives alone */
  bool periodic;       /* the deck's terms follow a law that repeats from cycle to cycle, as the
                          circuit's solver was left */
  bool glides;       /* the machine swings freely, and the step is longer than any polynomial holds:
                        its ends alone count, and lost_j */
  double lost_j;     /* where it glides: what damping takes in the step, J */
  bool held;         /* the armature is jammed: p" = 0 */
  bool open;         /* nothing flows in the coil, though eddy currents may keep a flux */
  vs_event event[2]; /* in order of time; VS_EV_NONE where there is none */
  double event_s[2]; /* when they happened: within the step, or as near to it as can be told */
  double strays; /* what may be wrong so far of the coil's flux linkage, in parts of run.tolerance
                    of its peak: by Gear's rule, while that swung by itself, or by thyristors whose
                    voltage was back within their t_q */
  double bound;  /* with VS_EV_QUIET and VS_EV_BACK: largest error that leaving the solver has
                    made, relative to each probe's peak */
} vs_step;

/* Computes all channels at t_s in [from, to] into y, which has room for vs_channel_count of them.
 * q is the Hermite polynomial of degree seven through value and three derivatives at each end, q'
 * is its slope; lambda is another such polynomial, or a cubic. Accelerations follow from these by
 * Eq. 54. The deck's terms, v_eva and i_mains of a circuit run straight from knot to knot, or from
 * one part to the next. */
void vs_step_at(const vs_step *step, double t_s, double *y);
/* The same numbers, but only for these groups (VS_GROUP_...) and the channels that always come
 * along; the others in y are left as they are. */
void vs_step_groups_at(const vs_step *step, double t_s, unsigned groups, double *y);
/* The same rates q' alone, for whoever asks often: v has room for one for each coordinate. */
void vs_step_velocities_at(const vs_step *step, double t_s, double *v);
/* One channel at t_s, by its number. */
double vs_step_channel(const vs_step *step, double t_s, int channel);
/* The secondaries' flux linkages at t_s (plant/coil.h). */
void vs_step_psi_at(const vs_step *step, double t_s, double psi[VS_MOST_RUNGS]);
/* The coil's current and the force at a knot, and their rates. */
vs_law_rates vs_step_coil_rates(const vs_frame *frame, const vs_knot *knot);
/* True if there is no flux anywhere in the step, and so neither current nor force. */
bool vs_step_is_quiet(const vs_step *step);
/* In how many parts to look for turns, where a step of half a radian of the fastest mode is to have
 * `most`, and any at least `least`. */
int vs_step_parts(const vs_step *step, int least, int most);

/* The knots between which terms run straight: the k-th such piece, of step->parts + 1. */
typedef struct vs_piece {
  const vs_knot *from, *to;
} vs_piece;
static inline vs_piece vs_step_piece(const vs_step *step, int k) {
  return (vs_piece){k ? &step->part[k - 1] : step->from,
                    k < step->parts ? &step->part[k] : step->to};
}

/* ---- channels as polynomials ----
 *
 * Channels over a step as polynomials in Bernstein's form. The argument runs from 0 at the step's
 * beginning to 1 at its end. A polynomial never leaves the range of its Bernstein coefficients, of
 * which the first and the last are its values at the ends. */

enum { VS_CURVE_MOST = 14, VS_CURVE_POINTS = VS_CURVE_MOST + 1 };
typedef struct vs_curve {
  int degree;
  double b[VS_CURVE_POINTS];
} vs_curve;

/* True if vs_step_curve_of gives the channel exactly. That is so for q and the travel of every
 * machine, and for the current, the force and the accelerations where the model is plain. */
bool vs_step_curve_is_exact(const vs_model *model, int channel);
/* The channel over the step: a coordinate, a second rate, VS_CH_TRAVEL, VS_CH_I or VS_CH_FORCE,
 * for which vs_step_curve_is_exact. */
vs_curve vs_step_curve_of(const vs_step *step, int channel);

/* The k-th of the points at which vs_step_curve_through wants its values: Chebyshev's, from 0 to 1.
 */
double vs_step_curve_point(int k);
/* The polynomial of degree 14 through these values at those points. */
vs_curve vs_step_curve_through(const double y[VS_CURVE_POINTS]);

/* The slope; h: the length of the argument's range in the unit that the slope is to be in. */
vs_curve vs_step_curve_slope(const vs_curve *curve, double h);
/* Cuts the curve in the middle. The first half is returned, the second one is left. */
vs_curve vs_step_curve_halve(vs_curve *curve);
/* The value at s, 0..1. */
double vs_step_curve_value(const vs_curve *curve, double s);
/* The root of a curve that changes its sign once, from > 0 to < 0. What rounding makes of a curve
 * of degree 13 moves the root by 1e-11. */
double vs_step_curve_root(vs_curve curve);
