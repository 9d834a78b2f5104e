/* SPDX-License-Identifier: GPL-3.0-or-later
 * Channels over a step as polynomials in Bernstein's form. The argument runs from 0 at the step's
 * beginning to 1 at its end. A polynomial never leaves the range of its Bernstein coefficients, of
 * which the first and the last are its values at the ends. */
#ifndef VS_ENGINE_CURVE_H
#define VS_ENGINE_CURVE_H

#include "engine/step.h"

enum { VS_CURVE_MOST = 14, VS_CURVE_POINTS = VS_CURVE_MOST + 1 };
typedef struct vs_curve {
  int degree;
  double b[VS_CURVE_POINTS];
} vs_curve;

/* True if vs_curve_of gives the channel exactly. That is so for q and the travel of every machine,
 * and for the current, the force and the accelerations where the model is plain. */
bool vs_curve_is_exact(const vs_model *model, int channel);
/* The channel over the step: a coordinate, a second rate, VS_CH_TRAVEL, VS_CH_I or VS_CH_FORCE,
 * for which vs_curve_is_exact. */
vs_curve vs_curve_of(const vs_step *step, int channel);

/* The k-th of the points at which vs_curve_through wants its values: Chebyshev's, from 0 to 1. */
double vs_curve_point(int k);
/* The polynomial of degree 14 through these values at those points. */
vs_curve vs_curve_through(const double y[VS_CURVE_POINTS]);

/* The slope; h: the length of the argument's range in the unit that the slope is to be in. */
vs_curve vs_curve_slope(const vs_curve *curve, double h);
/* Cuts the curve in the middle. The first half is returned, the second one is left. */
vs_curve vs_curve_halve(vs_curve *curve);
/* The value at s, 0..1. */
double vs_curve_value(const vs_curve *curve, double s);
/* The root of a curve that changes its sign once, from > 0 to < 0. What rounding makes of a curve
 * of degree 13 moves the root by 1e-11. */
double vs_curve_root(vs_curve curve);

#endif
