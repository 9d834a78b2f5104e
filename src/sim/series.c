/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "sim/series.h"

#include <math.h>
#include <string.h>

#include "machine/actuator.h"

/* n-th term of a product of two series; the newest terms come last, so that it can begin before
 * they are there. */
static double product(const double *x, const double *y, int n) {
  double sum = 0;
  for (int j = 1; j < n; j++) sum += x[j] * y[n - j];
  return n ? sum + x[0] * y[n] + x[n] * y[0] : x[0] * y[0];
}

static double larger(double a, double b) {
  return a > b ? a : b;
}

/* q[n+2] from q[n], q[n+1] and the n-th term of F: Eq. 54, order by order. */
static void next_q(const vs_driven *driven, vs_series *s, int n, double force) {
  const vs_model *m = driven->frame->model;
  double x[VS_STATES], acceleration[VS_DOF], h = s->span_s, rate = (n + 1) / h;
  for (int i = 0; i < VS_DOF; i++) {
    x[i] = s->q[n][i];
    x[VS_DOF + i] = rate * s->q[n + 1][i];
  }
  if (driven->touching) { /* k (p + D) + c p': the D belongs to order 0 */
    const vs_stop_values *stop = &m->actuator.stop;
    double depth = n ? x[P] : x[P] + m->actuator.gap_m;
    force += stop->stiffness_n_m * depth + stop->damping_ns_m * x[VS_DOF + P];
  }
  vs_accelerations(m, x, force, acceleration);
  double weight = h * h / ((n + 1) * (n + 2));
  for (int i = 0; i < VS_DOF; i++) s->q[n + 2][i] = weight * acceleration[i];
}

void vs_series_make(const vs_driven *driven, const vs_knot *knot, double span_s, vs_series *s) {
  const vs_model *m = driven->frame->model;
  double wh = driven->frame->timeline->omega_rad_s * span_s, per_2a = 1 / (2 * m->a_hm);
  double u = driven->mains_v, v = driven->mains_rate_v_s * span_s / wh; /* a sine, its cosine */
  double z[VS_SERIES_ORDER + 1] = {m->gap_rest_m}, force = 0;           /* terms of the gap */
  bool moves = !driven->frame->gap_at_rest;
  s->span_s = span_s;
  memset(s->flux, 0, sizeof s->flux);
  s->flux[0] = knot->flux_wb;
  for (int i = 0; i < VS_DOF; i++) {
    s->q[0][i] = knot->x[i];
    s->q[1][i] = knot->x[VS_DOF + i] * span_s;
  }
  for (int n = 0; n < VS_SERIES_ORDER; n++) {
    if (driven->conducting) { /* lambda[n+1] (Eqs. 80, 81), F[n] = lambda^2/(4a) */
      double part = span_s / (n + 1), sine = wh / (n + 1) * v;
      z[n] += moves ? s->q[n][P] : 0;
      force = product(s->flux, s->flux, n) * per_2a / 2;
      s->flux[n + 1] = part * (u - m->actuator.resistance_ohm * per_2a * product(s->flux, z, n));
      v = -wh / (n + 1) * u;
      u = sine;
    }
    if (n + 2 <= VS_SERIES_ORDER) next_q(driven, s, n, force);
  }
}

double vs_series_part(const vs_driven *driven, const vs_series *s, int n) {
  double largest = fabs(s->flux[n]) / larger(driven->flux_wb, fabs(s->flux[0]));
  for (int i = 0; i < VS_DOF; i++) {
    double size = larger(driven->coordinate[i], fabs(s->q[0][i]) + fabs(s->q[1][i]));
    largest = larger(largest, fabs(s->q[n][i]) / size);
  }
  return largest;
}

void vs_series_at(const vs_series *s, double at_s, double y[VS_CONDUCTING]) {
  double r = at_s / s->span_s, flux = s->flux[VS_SERIES_ORDER], q[VS_DOF], v[VS_DOF] = {0};
  memcpy(q, s->q[VS_SERIES_ORDER], sizeof q);
  for (int n = VS_SERIES_ORDER - 1; n >= 0; n--) {
    for (int i = 0; i < VS_DOF; i++) {
      v[i] = v[i] * r + q[i];
      q[i] = q[i] * r + s->q[n][i];
    }
    flux = flux * r + s->flux[n];
  }
  for (int i = 0; i < VS_DOF; i++) {
    y[i] = q[i];
    y[VS_DOF + i] = v[i] / s->span_s;
  }
  y[VS_FLUX] = flux;
}

/* One column of terms and its slope. */
static double column(const vs_series *s, const double *terms, size_t stride, double at_s,
                     double *rate) {
  double r = at_s / s->span_s, value = 0, slope = 0;
  for (int n = VS_SERIES_ORDER; n >= 0; n--) {
    slope = slope * r + value;
    value = value * r + terms[(size_t)n * stride];
  }
  *rate = slope / s->span_s;
  return value;
}

double vs_series_p(const vs_series *s, double at_s, double *rate) {
  return column(s, &s->q[0][P], VS_DOF, at_s, rate);
}

double vs_series_flux(const vs_series *s, double at_s, double *rate) {
  return column(s, s->flux, 1, at_s, rate);
}
