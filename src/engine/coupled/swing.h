/* SPDX-License-Identifier: GPL-3.0-or-later
 * How long a step of the circuit tier may be while the voltage across the coil swings faster than
 * the mains do; and whether that voltage alternates from step to step. */
#pragma once

#include "engine/sim.h"

/* Begins as vs_swing_of makes it. */
typedef struct vs_swing {
  const vs_model *model;
  double tolerance; /* run.tolerance; a quarter of it by Gear's rule, whose error is four times as
                       large */
  bool gear;        /* the rule is Gear's */
  bool kinks;       /* sub-pulses of gates make kinks in v while a thyristor conducts */
  double strays_wb, strayed_wb; /* what that may have been off by in lambda since a thyristor last
                                   conducted, and the most of it so far */
  double share;                 /* error of lambda that the swing may make, relative to flux_wb */
  double fades;                 /* what is left of the derivatives' sizes after a step */
  double period_s;              /* of the mains */
  double flux_wb; /* largest flux linkage so far; at first what the first firing may bring */
  double seen_wb; /* the same, but 0 at first */
  double peak_v;  /* of the mains */
  double peak_a,
      amplifies;     /* largest current so far that counts, of a coil that is not square, and by how
                        much a relative error of lambda is larger in that current; 1 at least */
  double current_wb; /* that current over its slope by lambda; INFINITY: a square coil's, or none */
  double slope_v_s, bend_v_s2; /* sizes of the first two derivatives of v = dlambda/dt of late */
  double missed_v_s2;          /* size of late of what of v'' the rule was not given back */
  double shown_s;              /* length of the step over which that of the second one showed */
  double before_s;             /* length of the last step; 0: there was none */
  double rise_v;               /* by how much v rose over the last step */
  double kick_v;               /* by how much more than over the step before */
  int alternations;            /* steps in a row whose kick was against the one before */
  int since_anew;              /* steps since the solver's rule was last told to begin anew */
  bool anew;                   /* the rule is to begin anew at the end of the last step */
} vs_swing;

vs_swing vs_swing_of(const vs_setup *setup);

/* Takes in the solver's step between two knots. The flux_rate2_v_s of each is the mean over the
 * step that ends there. missed_v_s2: what of v'' the rule was not given back (truncation.h), V/s^2.
 * driven: a thyristor conducts. */
void vs_swing_take(vs_swing *swing, const vs_knot *from, const vs_knot *to, double missed_v_s2,
                   bool driven);

/* Returns the longest step, s, that may be taken from the last knot on; INFINITY: any. */
double vs_swing_longest(const vs_swing *swing);

/* Returns by what Gear's rule may be off in lambda, in parts of run.tolerance of its peak, as the
 * coil was left to itself; 0 by the trapezoidal rule. */
double vs_swing_strays(const vs_swing *swing);

/* Returns the charge, A s, that a thyristor may bring too much or too little as it goes out after
 * t_s of mains at the least: times the mains' peak it is run.tolerance of the coil's energy. */
double vs_swing_charge(const vs_swing *swing, double t_s);

/* Returns by how much, s, the instant may be off at which a thyristor lets the coil's current i_a
 * go within t_s. */
double vs_swing_instant(const vs_swing *swing, double i_a, double t_s);
