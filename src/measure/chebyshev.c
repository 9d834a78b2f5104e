/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/chebyshev.h"

#include <math.h>

enum { N = VS_LOWPASS_DEGREE };

/* cos(pi n/6); sqrt(3/4) is written out. */
static double cosine(int n) {
  static const double COSINE[] = {
      1,  0.86602540378443864676,  0.5,  0, -0.5, -0.86602540378443864676,
      -1, -0.86602540378443864676, -0.5, 0, 0.5,  0.86602540378443864676};
  return COSINE[n % 12];
}

double vs_chebyshev_instant(int j, double from_s, double to_s) {
  double s = (1 - cosine(j)) / 2;
  return j == N ? from_s : to_s - s * (to_s - from_s);
}

/* The instants are those of Chebyshev's extrema, x_j = cos(pi j/6). With them
 *   a_k = c_k (2/6) (y_0 T_k(x_0)/2 + sum of y_j T_k(x_j) + y_6 T_k(x_6)/2),
 * T_k(x_j) = cos(pi j k/6), and c_k is 1/2 for the first and the last k, else 1. */
vs_chebyshev vs_chebyshev_through(const double value[VS_LOWPASS_TERMS]) {
  vs_chebyshev c = {.reach = 0};
  for (int k = 0; k <= N; k++) {
    double sum = 0;
    for (int j = 0; j <= N; j++) sum += value[j] * (j == 0 || j == N ? 0.5 : 1) * cosine(j * k);
    c.a[k] = sum / (k == 0 || k == N ? N : N / 2);
    if (k) c.reach += fabs(c.a[k]);
  }
  return c;
}

vs_chebyshev vs_chebyshev_of(const vs_step *step, int channel, double from_s, double to_s) {
  const unsigned groups = vs_channel_groups(step->frame->model, &channel, 1);
  double at[VS_CH_MOST], y[N + 1];
  for (int j = 0; j <= N; j++) {
    vs_step_groups_at(step, vs_chebyshev_instant(j, from_s, to_s), groups, at);
    y[j] = at[channel];
  }
  return vs_chebyshev_through(y);
}

double vs_chebyshev_error(const vs_chebyshev *c) {
  return fabs(c->a[N - 1]) + fabs(c->a[N]);
}

void vs_chebyshev_powers(const vs_chebyshev *c, double u[VS_LOWPASS_TERMS]) {
  /* coefficients of T_k(2 s - 1) by powers of s */
  static const double T[N + 1][N + 1] = {{1},
                                         {-1, 2},
                                         {1, -8, 8},
                                         {-1, 18, -48, 32},
                                         {1, -32, 160, -256, 128},
                                         {-1, 50, -400, 1120, -1280, 512},
                                         {1, -72, 840, -3584, 6912, -6144, 2048}};
  for (int i = 0; i <= N; i++) {
    u[i] = 0;
    for (int k = N; k >= i; k--) u[i] += c->a[k] * T[k][i];
  }
}
