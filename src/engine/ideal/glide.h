/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine's free motion in closed form, as the sum of its modes: how far each coordinate can
 * still go, and what damping takes. The motion itself comes from the propagator, so that the books
 * of energy hold two computations against each other that share nothing but M, B and K. */
#ifndef VS_ENGINE_GLIDE_H
#define VS_ENGINE_GLIDE_H

#include <complex.h>

#include "engine/sim.h"

/* q(t) = middle + sum over k of share[k] exp(s[k] t), t being the time since the knot. */
typedef struct vs_glide {
  const vs_model *model; /* borrowed */
  double began_s;        /* the knot's time */
  double middle[VS_MOST_DOF];
  double complex s[VS_MOST_STATES], share[VS_MOST_STATES][VS_MOST_DOF];
} vs_glide;

/* Finds the shares of the modes in the motion that begins at the knot, without flux and outside of
 * all stops. Returns false where there is no such sum that gives the knot's state back: two modes
 * are alike, B couples what K does not, or constant forces push where no spring holds. */
bool vs_glide_make(const vs_model *model, const vs_knot *knot, vs_glide *glide);

/* Fills what holds of the motion from from_s to to_s. */
void vs_glide_rest(const vs_glide *glide, double from_s, double to_s, vs_rest *rest);
/* Returns true if the rest may be left out as far as the tier goes: the armature cannot come near a
 * stop or the poles, and the coil's law takes any gap. */
bool vs_glide_is_clear(const vs_glide *glide, const vs_rest *rest);

/* What damping takes from from_s to to_s, the integral of q'.B q', J. */
double vs_glide_lost(const vs_glide *glide, double from_s, double to_s);

#endif
