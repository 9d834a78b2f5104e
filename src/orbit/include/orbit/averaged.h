/* SPDX-License-Identifier: GPL-3.0-or-later
 * The averaged model from the firing angle to an amplitude, in continuous time. It is the map of
 * orbit/linear.h by its modes: with the eigenvalues m_i of A, A v_i = m_i v_i, and w_i the
 * rows of the inverse of (v_1, v_2, ...),
 *
 *   Y(z)/A(z) = D + sum of r_i/(z - m_i),    r_i = (C v_i) (w_i B).
 *
 * A step of the angle by a at the section t = 0 makes, at t = 0, T, 2 T, ...,
 *
 *   y(t) = a (g - sum of h_i exp(s_i t)),   s_i = ln(m_i)/T,  h_i = r_i/(1 - m_i),
 *   g = D + sum of h_i = D + C (I - A)^-1 B,
 *
 * where g is the gain at rest of all transients. The frequency |Im s_i|/(2 pi) of a pole is that of
 * the beat of a mode with the firings, at most half of their own. */
#pragma once

#include <complex.h>

#include "orbit/linear.h"
#include "orbit/multipliers.h"

/* A pole. */
typedef struct vs_averaged_pole {
  vs_multiplier multiplier; /* m */
  double re_1_s, im_rad_s;  /* s; -INFINITY where m is 0 */
  double frequency_hz;      /* of the beat */
  double time_constant_s;   /* -1/Re s; negative where the mode grows */
} vs_averaged_pole;

typedef struct vs_averaged {
  int n, outputs; /* as of the linear model */
  vs_averaged_pole
      pole[VS_LINEAR_STATES]; /* the largest multiplier first; a pair by falling imaginary part */
  double gain[VS_LINEAR_OUTPUTS];    /* g, in the output's unit per rad */
  double at_once[VS_LINEAR_OUTPUTS]; /* D */
  double _Complex residue[VS_LINEAR_OUTPUTS][VS_LINEAR_STATES]; /* r_i */
  double _Complex share[VS_LINEAR_OUTPUTS][VS_LINEAR_STATES];   /* h_i */
  /* The pole, and its conjugate behind it where it has one, whose share is the largest. */
  int dominant[VS_LINEAR_OUTPUTS];
  /* How far the step response with this pole or pair alone, g - D - h_i exp(..), is from the whole
   * one at most, relative to |g|; the rest is taken to be there at once. */
  double left_out[VS_LINEAR_OUTPUTS];
} vs_averaged;

/* Finds it. Error, VS_RUN: a multiplier is 1, so that there is no gain; the modes cannot be told
 * apart. */
vs_status vs_averaged_find(const vs_linear *linear, vs_averaged *averaged, vs_error *err);

/* The step response of an output after k firings, in its unit per rad. */
double vs_averaged_step(const vs_averaged *averaged, int output, int k);
