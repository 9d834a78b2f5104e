/* SPDX-License-Identifier: GPL-3.0-or-later
 * A low-pass of first or second order, taken along a polynomial in time without an error of its
 * own. Its input u and its output y have the same unit, and slow signals pass unchanged:
 *
 *   first order:    y' = w (u - y)
 *   second order:   y" = w^2 (u - y) - 2 zeta w y'
 *
 * The state is x = (y, y'/w), so that x' = A x + w b u with A = w M and b = (1, 0) or (0, 1). */
#pragma once

/* Highest power of time in an input, and how many coefficients that makes. */
enum { VS_LOWPASS_DEGREE = 6, VS_LOWPASS_TERMS = VS_LOWPASS_DEGREE + 1 };

typedef struct vs_lowpass {
  double rate;    /* w, rad/s; 0: there is no low-pass, and y = u */
  double m[2][2]; /* M */
  int works_on; /* which of x the input works on, with the factor w: 0 of the first order, 1 of the
                   second */
  double damping; /* zeta; of the second order */
  double x[2];    /* y, y'/w */
} vs_lowpass;

/* Makes a low-pass whose magnitude has fallen by 3 dB, to 1/sqrt(2), at bandwidth_hz. NaN: there is
 * none. order: 1 or 2; damping: zeta of the second order, above 0 and at most 1. Its input has
 * always been 0. */
vs_lowpass vs_lowpass_make(double bandwidth_hz, int order, double damping);

/* Puts the output to where an input that has always been u leaves it. */
void vs_lowpass_settle(vs_lowpass *lowpass, double u);

/* Takes the state on by h, s, along the input u(t) = sum of u[k] (t/h)^k, t from 0 to h. */
void vs_lowpass_advance(vs_lowpass *lowpass, double h, const double u[VS_LOWPASS_TERMS]);

/* The low-pass was taken along one period, s, of an input that repeats, from the state `from` on.
 * Puts it into the state that comes back after each period. */
void vs_lowpass_close(vs_lowpass *lowpass, const double from[2], double period_s);

/* What becomes of a steady sine of that frequency, Hz: its amplitude is multiplied by *gain, and it
 * is shifted by *phase, rad, which is negative as the output lags. */
void vs_lowpass_response(const vs_lowpass *lowpass, double frequency_hz, double *gain,
                         double *phase);

/* How long it takes, s, until about this part of an earlier input is left; 0 without a low-pass.
 * For tests. */
double vs_lowpass_settling(const vs_lowpass *lowpass, double part);
