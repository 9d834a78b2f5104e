/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the solver's trapezoidal rule leaves out at the coil, and is given back.
 *
 * Over a step h the rule takes h/2 (v0 + v1) for the integral of v, which is h^3/12 v'' too much.
 * So for the coil's flux linkage lambda it is told to integrate v - h^2/12 v'' in the place of v.
 * The coil's current i charges the capacitances that the coil rings with, and is integrated there.
 * So i - h^2/12 i'' is drawn at the coil's terminals in the place of i. Both follow from the coil
 * alone, whatever is connected to it. lambda, the gap, v and i = i(lambda, z) stay what they are.
 *
 * v'' of v = dlambda/dt must be known at the end of a step before the step. Over some steps v'' is
 * nearly a straight line over v, where the coil rings as well as where it follows the mains. That
 * line is fitted to the last steps, moved by what it was off at the last two, and its solution goes
 * on over the next step. Where it did not foretell the steps before, nothing is given, nor
 * while a thyristor conducts: the mains then drive the coil, and its neighbours decide. */
#pragma once

#include "engine/sim.h"

/* Fading sums over steps: of their weights, of v in V and v'' in V/s^2, and of products. */
typedef struct vs_truncation_sums {
  double weight, v, bend, v_v, v_bend;
  int count; /* steps in the sums */
} vs_truncation_sums;

/* Fading sums over steps: of the slope s of the voltage v across the coil, of v itself, of the
 * current y that flows out of the coil, and of products. */
typedef struct vs_truncation_outside {
  double weight, s, v, y, s_s, s_v, v_v, s_y, v_y, y_y;
  double rad; /* what angle of the swing they have seen in all */
} vs_truncation_outside;

/* v'' = rest + slope v. */
typedef struct vs_truncation_line {
  double rest, slope;
} vs_truncation_line;

/* Begins as vs_truncation_begin makes it. */
typedef struct vs_truncation {
  bool on;
  double mains_1_s2; /* the square of a frequency up to which a swing is taken for the mains' */
  vs_truncation_sums sums;
  vs_truncation_line line;        /* fitted to the sums */
  bool fitted;                    /* false: too few steps are known for a line */
  double seen_v[2], seen_v_s2[2]; /* v and v'' at the last two instants where v'' is known, the
                                     later one first */
  double seen_s;                  /* that later instant, behind the last knot */
  double size_v_s2, size_s;       /* the largest |v''| of late, and the step over which it showed */
  bool driven;                    /* a thyristor conducted in the last step: nothing is given */
  int good;                       /* how many steps in a row v'' was foretold well */
  double v0_v, rise_v_s;          /* v before the last step, and its mean slope in it */
  double h_s;                     /* length of the last step; 0: there was none */
  double try_s;                   /* length of the step that was asked for last; 0: none was */
  double foretold_v_s2[2];        /* v'' at the end of that step, and of the last one */
  double given_v_s2[2];           /* the same where it was given, else 0 */
  vs_truncation_outside outside;  /* what the coil rings with */
  double flux_v, current_a;       /* what is given in the step that was asked for last */
} vs_truncation;

/* A step of the solver between two knots. driven: a thyristor conducts in it. */
typedef struct vs_truncation_step {
  const vs_model *model;
  const vs_knot *from, *to;
  bool driven;
} vs_truncation_step;

/* A candidate for the end of a step from the knot `last`, with the gap there. */
typedef struct vs_truncation_try {
  const vs_model *model;
  const vs_knot *last;
  double t_s, z_m;
} vs_truncation_try;

/* on: something is given at all. */
vs_truncation vs_truncation_begin(const vs_setup *setup, bool on);

/* Forgets the steps before. */
void vs_truncation_restart(vs_truncation *truncation);

/* Takes in a step of the solver. Returns what of v'' at its beginning the rule was not given, or
 * was given too much, V/s^2. The flux_rate2_v_s of `to` is the mean over the step. */
double vs_truncation_take_step(vs_truncation *truncation, const vs_truncation_step *step);

/* What is given at the end of such a step: to the rate of lambda, V, and to the current that the
 * coil draws, A. */
double vs_truncation_flux_correction(vs_truncation *truncation, const vs_truncation_try *at);
double vs_truncation_current_correction(vs_truncation *truncation, const vs_truncation_try *at);
