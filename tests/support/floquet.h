/* SPDX-License-Identifier: GPL-3.0-or-later
 * The periodic orbit of a coupling scheme under firing in every cycle, and how fast the working
 * mode comes back to it: from the map of one mains period, at whose beginning no current flows, so
 * that the machine's state is all there is. */
#pragma once

#include "schemes.h"

typedef struct orbit {
  double x[VS_STATES];     /* at the rising zero of the mains */
  double multiplier;       /* |mu| of the working mode: > 1 unstable */
  double angle_rad;        /* of mu, 0..pi */
  double largest;          /* |mu| of any mode */
  double damping_ns_m;     /* c = -2 m_eff ln|mu| / T */
  double force_over_z_n_m; /* mean of F/z over the orbit */
  double p_min_m, p_max_m; /* at substeps */
} orbit;

/* Effective mass of the working mode: a unit impulse of F makes it swing with 1/(m_eff w) in p. */
double floquet_mass(const vs_model *model);

/* Newton from orbit->x, with n macro steps in a period. false: there is no orbit, or it was not
 * found; orbit->x is then what it was. */
bool floquet_orbit(const scheme *s, const vs_model *model, const vs_timeline *timeline, long n,
                   orbit *o);
