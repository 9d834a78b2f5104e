/* SPDX-License-Identifier: GPL-3.0-or-later
 * A knot: the state at one end of a step, with the derivatives that the polynomials between two
 * knots need (engine/step.h). */
#ifndef VS_ENGINE_KNOT_H
#define VS_ENGINE_KNOT_H

#include "plant/mechanics.h"
#include "engine/frame.h"

typedef struct vs_knot {
  double t_s;
  double x[VS_MOST_STATES];              /* q, q' (plant/model.h): m, rad, m/s, rad/s */
  double a[VS_MOST_DOF], j[VS_MOST_DOF]; /* q", q"' */
  /* lambda and its derivatives. Where a step's cubic_flux is set the last two do not count, but are
   * finite all the same. */
  double flux_wb, flux_rate_v, flux_rate2_v_s, flux_rate3_v_s2;
  double v_eva_v, i_mains_a;  /* as the circuit has them; not set on a tier without a circuit */
  double terms[VS_DECK_MOST]; /* of the deck's probes and formulas, V or A, in the deck's order; the
                                 last member, so that a copy may leave out those behind the deck's
                                 own */
} vs_knot;

/* Copies a knot, with no more terms than the deck has. */
void vs_knot_copy(const vs_frame *frame, const vs_knot *from, vs_knot *to);

/* Sets q" and q"' of a knot from its q, q' and flux linkage by Eq. 54. `touched`: the
 * stops whose force counts, as vs_stops_touched has them. On the instant of contact a knot belongs
 * to either side, so that q alone cannot tell. */
void vs_knot_complete(const vs_frame *frame, vs_knot *knot, unsigned touched);
/* The same for a jammed armature: the gap's rate is 0 and stays 0. */
void vs_knot_hold(const vs_frame *frame, vs_knot *knot);

#endif
