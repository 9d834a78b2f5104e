/* SPDX-License-Identifier: GPL-3.0-or-later
 * How long a step of the circuit tier may be while the voltage across the coil swings, faster than
 * the mains do; and when it alternates from step to step. */
#ifndef VS_SIM_SWING_H
#define VS_SIM_SWING_H

#include "sim/sim.h"

typedef struct vs_swing {
  double part;                 /* of the largest flux linkage that it may be put wrong by */
  double fades;                /* what is left of the derivatives after a step */
  double period_s;             /* of the mains */
  double flux_wb;              /* the largest so far, at first what the first firing may bring */
  double slope_v_s, bend_v_s2; /* sizes of the first two derivatives of v = dlambda/dt of late */
  double rise_v, kick_v;       /* of v over the last step; how much more than over the one before */
  int alternations;            /* steps in a row whose kick is against the last one's */
  int since_anew;              /* steps since the rule was to begin anew */
  bool anew;                   /* it is to, at the end of the last step */
} vs_swing;

vs_swing vs_swing_of(const vs_setup *setup);

/* Takes in the solver's step between two knots, each with flux_rate2_v_s of the step that ends
 * there. before_s: the length of the step before; 0: there was none. */
void vs_swing_take(vs_swing *swing, const vs_knot *from, const vs_knot *to, double before_s);

/* Longest step from the last knot on, s; INFINITY: as long as one likes. */
double vs_swing_longest(const vs_swing *swing);

#endif
