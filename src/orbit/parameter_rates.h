/* SPDX-License-Identifier: GPL-3.0-or-later
 * How the equations of a run on an ideal tier depend on a parameter, at a given state: with
 * y = (q, q', lambda) and y' = f(y, t), this is df/dp. The coefficients' derivatives are
 * orbit/parameter.h's; what stands beside them follows from the state. */
#pragma once

#include "orbit/parameter.h"

/* What the equations are looked at with: an instant and the state there. */
typedef struct vs_parameter_rates_place {
  const vs_frame *frame;
  double t_s;
  const double *q, *rate; /* q, q' */
  double flux_wb;
  bool conducting;
  unsigned touched; /* the stops that the armature is in, as bits */
} vs_parameter_rates_place;

/* Gives df/dp at the place: 2 dof + 1 numbers, those of lambda last. */
void vs_parameter_rates_find(const vs_parameter *parameter, const vs_parameter_rates_place *place,
                             double *rate);
/* d/dp of a stop's depth's negative, travel - at, at a given state: what p moves the contact by. */
double vs_parameter_rates_surface(const vs_parameter *parameter, int stop, const double *q);
