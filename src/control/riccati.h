/* SPDX-License-Identifier: GPL-3.0-or-later
 * The steady gain of a Kalman filter. Of x(k+1) = A x(k) + w(k) and y(k) = C x(k) + v(k), with
 * white noise w and v of the covariances Q and R, it finds the covariance P of the state's error
 * one period after the last sample, which solves the discrete Riccati equation
 *
 *   P = A (P - P C^T (C P C^T + R)^-1 C P) A^T + Q
 */
#pragma once

#include <gsl/gsl_matrix.h>
#include <stdbool.h>

/* Fills p (n x n) from a (n x n), c (m x n), q (n x n) and r (m x m, positive definite). Returns
 * false where the iteration does not settle: the sensors do not see a motion that does not decay by
 * itself. */
bool vs_riccati(const gsl_matrix *a, const gsl_matrix *c, const gsl_matrix *q, const gsl_matrix *r,
                gsl_matrix *p);

/* Fills the gain L = P C^T (C P C^T + R)^-1 (n x m), with which a sample corrects the state of its
 * own instant: x + L (y - C x). */
void vs_riccati_gain(const gsl_matrix *p, const gsl_matrix *c, const gsl_matrix *r,
                     gsl_matrix *gain);
