/* SPDX-License-Identifier: GPL-3.0-or-later
 * Taylor series, in time, of the machine's coordinates and of the flux linkage lambda about a knot.
 * The equations are linear but for two products, lambda^2 in the force and lambda z in the current,
 * so that each term follows from those before it. */
#pragma once

#include "engine/driven.h"

/* Degree of the series; reach() in phases.c says how long a span it is good for. */
enum { VS_SERIES_ORDER = 13 };

/* q(s) = sum of q[n] (s/span)^n, lambda likewise, s being the time since the knot: each term is as
 * large as it is at the end of the span. */
typedef struct vs_taylor {
  double span_s;
  const vs_model *model;
  double q[VS_SERIES_ORDER + 1][VS_MOST_DOF], flux[VS_SERIES_ORDER + 1];
  /* with eddy currents: those of psi, and of the coil's current while conducting */
  double psi[VS_SERIES_ORDER + 1][VS_MOST_RUNGS], current[VS_SERIES_ORDER + 1];
} vs_taylor;

/* Makes the series about a knot, of which the time, q, q' and lambda count. */
void vs_taylor_make(const vs_driven *driven, const vs_knot *knot, double span_s, vs_taylor *out);

/* Returns the size of the n-th term at the end of the span, relative to each quantity's scale; the
 * largest over all quantities. The scale is what counts as large, or the quantity itself where it
 * is larger. */
double vs_taylor_term(const vs_driven *driven, const vs_taylor *series, int n);

/* Gives the state s seconds after the knot, within the span. */
void vs_taylor_at(const vs_taylor *series, double s, double y[VS_CONDUCTING]);
/* Returns the travel g = c.q alone s seconds after the knot, and gives its rate. */
double vs_taylor_travel(const vs_taylor *series, double s, double *rate);
/* The same of what a conduction ends with: lambda, or with eddy currents the coil's current times
 * its inductance at rest. */
double vs_taylor_flux(const vs_taylor *series, double s, double *rate);

/* Returns true if that falls below -nothing_wb within s seconds after the knot. The first time it
 * does so lies between *lower_s and *upper_s, and no other time does. No fall is overlooked,
 * whatever it does on the way. */
bool vs_taylor_flux_falls(const vs_taylor *series, double s, double nothing_wb, double *lower_s,
                          double *upper_s);
