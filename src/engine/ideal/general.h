/* SPDX-License-Identifier: GPL-3.0-or-later
 * The motion of a machine with any law and any stops, where series.c has none: by a Runge-Kutta
 * method of order eight, GSL's rk8pd. A step is taken as two halves, and what lies between is the
 * polynomial of degree eleven through value and three derivatives at its three knots. It is handed
 * on as a vs_series, so that everything that asks a Taylor series may ask it as well. */
#ifndef VS_ENGINE_GENERAL_H
#define VS_ENGINE_GENERAL_H

#include <gsl/gsl_odeiv2.h>

#include "ideal/series.h"

/* Begin with vs_general_begin, end with vs_general_end. */
typedef struct vs_general {
  gsl_odeiv2_step *stepper; /* owned */
  const vs_driven *driven;
  double next_s; /* the length that the next step is tried with; 0: as long as allowed */
} vs_general;

void vs_general_begin(vs_general *general, int dof);
void vs_general_end(vs_general *general);

/* Something changed: what is known of step lengths is forgotten. */
void vs_general_restart(vs_general *general);

/* Makes the longest step from the knot, up to longest_s, between whose ends the polynomial of
 * degree seven is right to `rough`, relative to what is large, and whose end is right to a small
 * part of that. Returns its length, s, which is the series' span; 0 where no step is short enough.
 */
double vs_general_make(vs_general *general, const vs_driven *driven, const vs_knot *knot,
                       double longest_s, double rough, vs_series *series);

#endif
