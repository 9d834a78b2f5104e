/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/lowpass.h"

#include <math.h>

/* Of the second order |y/u|^2 = 1/((1 - r^2)^2 + (2 zeta r)^2) with r = w_input/w. It is 1/2 at
 *   r^2 = s + sqrt(s^2 + 1),  s = 1 - 2 zeta^2 */
vs_lowpass vs_lowpass_make(double bandwidth_hz, int order, double damping) {
  vs_lowpass p = {.works_on = order - 1, .damping = damping};
  double w = 2 * M_PI * bandwidth_hz, s = 1 - 2 * damping * damping;
  if (isnan(bandwidth_hz)) return p;
  p.rate = order == 1 ? w : w / sqrt(s + sqrt(s * s + 1));
  if (order == 1) {
    p.m[0][0] = p.m[1][1] = -1;
  } else {
    p.m[0][1] = 1;
    p.m[1][0] = -1;
    p.m[1][1] = -2 * damping;
  }
  return p;
}

void vs_lowpass_settle(vs_lowpass *p, double u) {
  p->x[0] = u;
  p->x[1] = 0;
}

/* y = z M v, where z = w h. */
static void times_lowpass_matrix(const vs_lowpass *p, double z, const double v[2], double y[2]) {
  double a = z * (p->m[0][0] * v[0] + p->m[0][1] * v[1]);
  y[1] = z * (p->m[1][0] * v[0] + p->m[1][1] * v[1]);
  y[0] = a;
}

/* The same backwards: solves z M y = v. det M = 1 for either order. */
static void divided(const vs_lowpass *p, double z, const double v[2], double y[2]) {
  double a = (p->m[1][1] * v[0] - p->m[0][1] * v[1]) / z;
  y[1] = (p->m[0][0] * v[1] - p->m[1][0] * v[0]) / z;
  y[0] = a;
}

/* y = exp(A h) v. With B = A + zeta w of the second order, B^2 = -beta^2, so that
 *   exp(A h) = exp(-zeta w h) (cos(beta h) + sin(beta h)/beta B),  beta = w sqrt(1 - zeta^2) */
static void transition(const vs_lowpass *p, double z, const double v[2], double y[2]) {
  if (p->works_on == 0) {
    y[0] = exp(-z) * v[0];
    y[1] = exp(-z) * v[1];
    return;
  }
  double zeta = p->damping, turn = z * sqrt(1 - zeta * zeta);
  double decay = exp(-zeta * z), sinc = turn > 1e-8 ? sin(turn) / turn : 1;
  double bv[2];
  times_lowpass_matrix(p, z, v, bv);
  for (int i = 0; i < 2; i++) y[i] = decay * (cos(turn) * v[i] + sinc * (bv[i] + zeta * z * v[i]));
}

static const double FACTORIAL[] = {1, 1, 2, 6, 24, 120, 720, 5040};
_Static_assert(sizeof FACTORIAL / sizeof *FACTORIAL == VS_LOWPASS_TERMS + 1, "0! to 7!");

/* Up to here the functions phi are summed up as series. Beyond, each follows from the one before
 * it, which loses less the larger z is: at this one two digits over all. */
static const double SERIES = 5;

/* phi[k] = phi_k(A h) b for k = 1, ..., where
 *   phi_k(Z) = sum over j of Z^j/(j + k)!,   phi_k(Z) = Z phi_(k+1)(Z) + 1/k!
 * and phi_0 is the exponential. */
static void find_phi(const vs_lowpass *p, double z, double phi[VS_LOWPASS_TERMS + 1][2]) {
  const int last = VS_LOWPASS_TERMS;
  double b[2] = {0, 0};
  b[p->works_on] = 1;
  if (z <= SERIES) {
    double term[2] = {b[0] / FACTORIAL[last], b[1] / FACTORIAL[last]};
    phi[last][0] = phi[last][1] = 0;
    for (int j = 1; j < 80 && fabs(term[0]) + fabs(term[1]) > 1e-20 / FACTORIAL[last]; j++) {
      phi[last][0] += term[0];
      phi[last][1] += term[1];
      times_lowpass_matrix(p, z / (j + last), term, term);
    }
    for (int k = last - 1; k > 0; k--) {
      times_lowpass_matrix(p, z, phi[k + 1], phi[k]);
      phi[k][0] += b[0] / FACTORIAL[k];
      phi[k][1] += b[1] / FACTORIAL[k];
    }
    return;
  }
  transition(p, z, b, phi[0]);
  for (int k = 0; k < last; k++) {
    const double rest[2] = {phi[k][0] - b[0] / FACTORIAL[k], phi[k][1] - b[1] / FACTORIAL[k]};
    divided(p, z, rest, phi[k + 1]);
  }
}

/* x(h) = exp(A h) x(0) + w h (sum over k of u_k k! phi_(k+1)(A h)) b, as the convolution of
 * (t/h)^k with the exponential is h k! phi_(k+1). */
void vs_lowpass_advance(vs_lowpass *p, double h, const double u[VS_LOWPASS_TERMS]) {
  double phi[VS_LOWPASS_TERMS + 1][2], x[2], z = p->rate * h;
  transition(p, z, p->x, x);
  find_phi(p, z, phi);
  for (int k = VS_LOWPASS_DEGREE; k >= 0; k--) {
    x[0] += z * u[k] * FACTORIAL[k] * phi[k + 1][0];
    x[1] += z * u[k] * FACTORIAL[k] * phi[k + 1][1];
  }
  p->x[0] = x[0];
  p->x[1] = x[1];
}

/* As x(T) = E x(0) + c with E = exp(A T), the state sought is that with (I - E) x = c. */
void vs_lowpass_close(vs_lowpass *p, const double from[2], double period_s) {
  double z = p->rate * period_s, e[2][2], past[2]; /* e[j] is the j-th column of E */
  if (z == 0) return;
  transition(p, z, (const double[]){1, 0}, e[0]);
  transition(p, z, (const double[]){0, 1}, e[1]);
  transition(p, z, from, past);
  double c0 = p->x[0] - past[0], c1 = p->x[1] - past[1];
  double det = (1 - e[0][0]) * (1 - e[1][1]) - e[1][0] * e[0][1];
  p->x[0] = (c0 * (1 - e[1][1]) + c1 * e[1][0]) / det;
  p->x[1] = (c1 * (1 - e[0][0]) + c0 * e[0][1]) / det;
}

void vs_lowpass_response(const vs_lowpass *p, double frequency_hz, double *gain, double *phase) {
  double r = p->rate > 0 ? 2 * M_PI * frequency_hz / p->rate : 0;
  double real = p->works_on ? 1 - r * r : 1, imaginary = p->works_on ? 2 * p->damping * r : r;
  *gain = 1 / hypot(real, imaginary);
  *phase = imaginary > 0 ? -atan2(imaginary, real) : 0;
}

double vs_lowpass_settling(const vs_lowpass *p, double part) {
  return p->rate > 0 ? -log(part) / (p->rate * (p->works_on ? p->damping : 1)) : 0;
}
