/* SPDX-License-Identifier: GPL-3.0-or-later
 * Taylor series of the machine and its flux linkage about one instant. All is linear but for two
 * products, lambda^2 in the force and lambda z in the current, so each term follows from those
 * before it. */
#ifndef VS_IDEAL_SERIES_H
#define VS_IDEAL_SERIES_H

#include "drive/wave.h"
#include "sim/step.h"

enum { VS_SERIES_ORDER = 13 };
enum { VS_FLUX = VS_STATES, VS_CONDUCTING }; /* y = (q, q', lambda) */

/* What moves the machine from a knot on. */
typedef struct vs_driven {
  const vs_frame *frame;
  bool conducting, touching;          /* dlambda/dt = u - R_c i, else lambda = 0; the stop */
  bool held;                          /* p stays what it is */
  vs_wave mains;                      /* u */
  double since_s;                     /* the knot, behind the origin of u */
  double coordinate[VS_DOF], flux_wb; /* what is large for q and lambda */
  double negligible;                  /* a term is, at this part of what is large */
} vs_driven;

/* q(s) = sum q[n] (s/span)^n, lambda likewise: each term as large as it is where the span ends. */
typedef struct vs_series {
  double span_s;
  double q[VS_SERIES_ORDER + 1][VS_DOF], flux[VS_SERIES_ORDER + 1];
} vs_series;

void vs_series_make(const vs_driven *driven, const vs_knot *knot, double span_s, vs_series *out);
/* The n-th term where the span ends, of what is large or is there already: the largest such part.
 */
double vs_series_part(const vs_driven *driven, const vs_series *series, int n);

/* s seconds on, within the span. */
void vs_series_at(const vs_series *series, double s, double y[VS_CONDUCTING]);
/* p or lambda alone, and its rate. */
double vs_series_p(const vs_series *series, double s, double *rate);
double vs_series_flux(const vs_series *series, double s, double *rate);

/* Does lambda fall below -nothing_wb within s seconds? Then between these two for the first time,
 * and there but once; whatever it does, no fall is passed over. */
bool vs_series_flux_falls(const vs_series *series, double s, double nothing_wb, double *lower_s,
                          double *upper_s);

#endif
