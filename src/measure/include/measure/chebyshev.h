/* SPDX-License-Identifier: GPL-3.0-or-later
 * A channel over a part of a step as a polynomial of degree six, by Chebyshev's polynomials T_k of
 * an argument that runs from -1 at the part's beginning to 1 at its end. It goes through the
 * channel at seven instants. As |T_k| <= 1, it never leaves a[0] by more than the sum of the other
 * sizes. */
#pragma once

#include "engine/step.h"
#include "measure/lowpass.h"

typedef struct vs_chebyshev {
  double a[VS_LOWPASS_TERMS];
  double reach; /* sum of |a[k]| from k = 1 on: values lie in a[0] - reach .. a[0] + reach */
} vs_chebyshev;

/* The channel, by its number, between two instants of the step. */
vs_chebyshev vs_chebyshev_of(const vs_step *step, int channel, double from_s, double to_s);

/* The j-th of those seven instants, from 0: they run from the part's end back to its beginning. */
double vs_chebyshev_instant(int j, double from_s, double to_s);
/* The polynomial of anything that has these values there. */
vs_chebyshev vs_chebyshev_through(const double value[VS_LOWPASS_TERMS]);

/* About how far the channel may be from the polynomial: the size of its last two terms. */
double vs_chebyshev_error(const vs_chebyshev *chunk);

/* The same polynomial as the sum of u[k] s^k, with s from 0 at the part's beginning to 1. */
void vs_chebyshev_powers(const vs_chebyshev *chunk, double u[VS_LOWPASS_TERMS]);
