/* SPDX-License-Identifier: GPL-3.0-or-later
 * The motion of a machine with any law and any stops, where taylor.c has none: by a Runge-Kutta
 * method of order eight, GSL's rk8pd. A step is taken as two halves, and what lies between is the
 * polynomial of degree eleven through value and three derivatives at its three knots. It is handed
 * on as a vs_taylor, so that everything that asks a Taylor series may ask it as well. */
#pragma once

#include <gsl/gsl_odeiv2.h>

#include "ideal/taylor.h"

/* Begin with vs_runge_kutta_begin, end with vs_runge_kutta_end. */
typedef struct vs_runge_kutta {
  gsl_odeiv2_step *stepper; /* owned */
  const vs_driven *driven;
  double next_s; /* the length that the next step is tried with; 0: as long as allowed */
} vs_runge_kutta;

void vs_runge_kutta_begin(vs_runge_kutta *general, const vs_model *model);
void vs_runge_kutta_end(vs_runge_kutta *general);

/* Something changed: what is known of step lengths is forgotten. */
void vs_runge_kutta_restart(vs_runge_kutta *general);

/* Makes the longest step from the knot, up to longest_s, between whose ends the polynomial of
 * degree seven is right to `rough`, relative to what is large, and whose end is right to a small
 * part of that. Returns its length, s, which is the series' span; 0 where no step is short enough.
 */
double vs_runge_kutta_make(vs_runge_kutta *general, const vs_driven *driven, const vs_knot *knot,
                           double longest_s, double rough, vs_taylor *series);
