/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/driven.h"

#include <math.h>
#include <string.h>

#include "engine/firing.h"
#include "plant/coil.h"

static void complete_driven_knot(const vs_driven *d, vs_knot *k) {
  if (d->held)
    vs_step_hold_knot(d->frame, k);
  else
    vs_step_complete_knot(d->frame, k, d->touched);
}

/* The last two derivatives of lambda where i = lambda z/(2a). */
static void square_rates(const vs_model *m, const double u[3], const double z[3], vs_knot *k) {
  double r = m->coil.resistance_ohm / (2 * m->coil.a_hm);
  k->flux_rate2_v_s = u[1] - r * (k->flux_rate_v * z[0] + k->flux_wb * z[1]);
  k->flux_rate3_v_s2 =
      u[2] - r * (k->flux_rate2_v_s * z[0] + 2 * k->flux_rate_v * z[1] + k->flux_wb * z[2]);
}

/* The same for any law. The second derivative of i needs the second of lambda, which needs the
 * first of i. */
static void law_rates(const vs_model *m, const double u[3], const double z[3], vs_knot *k) {
  double i[3], force[3], flux[3] = {k->flux_wb, k->flux_rate_v, 0};
  m->coil.law->along(&m->coil, flux, z, i, force);
  k->flux_rate2_v_s = flux[2] = u[1] - m->coil.resistance_ohm * i[1];
  m->coil.law->along(&m->coil, flux, z, i, force);
  k->flux_rate3_v_s2 = u[2] - m->coil.resistance_ohm * i[2];
}

/* ---- with eddy currents ---- */

enum { ORDERS = 4 }; /* a value and three derivatives */

/* The order-th derivative of dW/dlambda where lambda and z have these. A law gives two; the third
 * one is the second one's central difference, off by the square of CLOSE. */
static double law_current(const vs_coil *c, const double f[ORDERS], const double z[ORDERS],
                          int order) {
  static const double CHOOSE[ORDERS][ORDERS] = {{1}, {1, 1}, {1, 2, 1}, {1, 3, 3, 1}};
  static const double CLOSE = 1e-4;
  double i[3], force[3], sum = 0;
  if (c->square) {
    for (int n = 0; n <= order; n++) sum += CHOOSE[order][n] * f[n] * z[order - n];
    return sum / (2 * c->a_hm);
  }
  if (order < ORDERS - 1) {
    c->law->along(c, f, z, i, force);
    return i[order];
  }
  double fastest = fmax(fabs(f[1]) / fmax(fabs(f[0]), 1e-300), fabs(z[1]) / fabs(z[0]));
  const double h = CLOSE / fmax(fmax(fastest, 1), fmin(sqrt(fabs(f[2] / f[0])), 1e9));
  for (int side = -1; side <= 1; side += 2) {
    double at[2][3];
    for (int n = 0; n < 3; n++)
      for (int of = 0; of < 2; of++) {
        const double *y = of ? z : f;
        at[of][n] = 0;
        for (int k = ORDERS - 1; k >= n; k--) at[of][n] = y[k] + at[of][n] * side * h / (k - n + 1);
      }
    c->law->along(c, at[0], at[1], i, force);
    sum += side * i[2] / (2 * h);
  }
  return sum;
}

/* The n-th derivative of lambda from those before it, with which those of psi go as far as the
 * n-th; u is the (n-1)-th of the mains' voltage. While nothing flows, i = 0 tells it: by a
 * secondary without leakage, or else by the n-th derivative of i = 0. */
static double next_flux_rate(const vs_driven *d, int n, double u, const double f[ORDERS],
                             double psi[ORDERS][VS_MOST_RUNGS], const double z[ORDERS]) {
  const vs_coil *c = &d->frame->model->coil;
  const double r = c->resistance_ohm;
  if (!d->conducting && c->core_s == 0) {
    const double one[ORDERS] = {f[0], 1}, still[ORDERS] = {z[0]};
    double without[ORDERS] = {0};
    for (int k = 0; k < n; k++) without[k] = f[k];
    return -(law_current(c, without, z, n) + vs_coil_rungs_current(c, 0, psi[n])) /
           (law_current(c, one, still, 1) + c->leak_1_h);
  }
  const double base = law_current(c, f, z, n - 1) + vs_coil_rungs_current(c, f[n - 1], psi[n - 1]);
  return d->conducting ? (u - r * base) / (1 + r * c->core_s) : -base / c->core_s;
}

static void next_psi(const vs_coil *c, double flux, const double *psi, double *rate) {
  for (int n = 0; n < c->rungs; n++) rate[n] = vs_coil_rung_rate(c, n, flux, psi);
}

double vs_driven_flux_rate(const vs_driven *d, double u, double flux, const double *psi,
                           const double z[2], double *psi_rate) {
  const vs_coil *c = &d->frame->model->coil;
  const double f[ORDERS] = {flux}, gap[ORDERS] = {z[0], z[1]};
  double all[ORDERS][VS_MOST_RUNGS] = {{0}};
  memcpy(all[0], psi, sizeof all[0]);
  next_psi(c, flux, psi, psi_rate);
  for (int n = 0; n < c->rungs; n++) all[1][n] = psi_rate[n];
  return next_flux_rate(d, 1, u, f, all, gap);
}

static void gaps_of(const vs_driven *d, const vs_knot *k, double z[ORDERS]) {
  const vs_model *m = d->frame->model;
  const double moves = d->frame->gap_at_rest ? 0 : 1;
  z[0] = vs_coil_gap(&m->coil, moves * vs_mechanics_travel(m, k->x));
  z[1] = moves * vs_mechanics_travel(m, k->x + m->dof);
  z[2] = moves * vs_mechanics_travel(m, k->a);
  z[3] = moves * vs_mechanics_travel(m, k->j);
}

static void fill_with_eddies(const vs_driven *d, double since_s, vs_knot *k) {
  const vs_coil *c = &d->frame->model->coil;
  double u[3] = {0}, z[ORDERS] = {0}, f[ORDERS] = {k->flux_wb}, psi[ORDERS][VS_MOST_RUNGS] = {{0}};
  if (d->conducting) vs_wave_at(&d->mains, since_s, u);
  memcpy(psi[0], k->psi_wb, sizeof psi[0]);
  for (int n = 1; n < ORDERS; n++) {
    if (n < 3) gaps_of(d, k, z); /* z" and z"' follow from the force, which lambda' tells */
    next_psi(c, f[n - 1], psi[n - 1], psi[n]);
    f[n] = next_flux_rate(d, n, u[n - 1], f, psi, z);
    k->flux_rate_v = f[1];
    if (n == 1) complete_driven_knot(d, k);
  }
  k->flux_rate2_v_s = f[2];
  k->flux_rate3_v_s2 = f[3];
}

void vs_driven_current(const vs_driven *d, const vs_knot *k, double since_s, double i[3]) {
  const vs_coil *c = &d->frame->model->coil;
  const double f[ORDERS] = {k->flux_wb, k->flux_rate_v, k->flux_rate2_v_s};
  const double share = 1 + c->resistance_ohm * c->core_s;
  double u[3] = {0}, z[ORDERS], psi[ORDERS][VS_MOST_RUNGS] = {{0}};
  if (d->conducting) vs_wave_at(&d->mains, since_s, u);
  gaps_of(d, k, z);
  memcpy(psi[0], k->psi_wb, sizeof psi[0]);
  for (int n = 0; n < 3; n++) {
    const double base = law_current(c, f, z, n) + vs_coil_rungs_current(c, f[n], psi[n]);
    i[n] = (base + c->core_s * u[n]) / share;
    next_psi(c, f[n], psi[n], psi[n + 1]);
  }
}

/* dlambda/dt = u - R_c i and two derivatives more, where z' and z" are the travel's, or 0 on the
 * tier that keeps the inductance. */
void vs_driven_fill(const vs_driven *d, double since_s, vs_knot *k) {
  const vs_model *m = d->frame->model;
  k->flux_rate_v = k->flux_rate2_v_s = k->flux_rate3_v_s2 = 0;
  if (!d->conducting && !d->fades) {
    complete_driven_knot(d, k);
    return;
  }
  if (m->coil.eddies) {
    fill_with_eddies(d, since_s, k);
    return;
  }
  double u[3], moves = d->frame->gap_at_rest ? 0 : 1, z[3];
  z[0] = vs_coil_gap(&m->coil, moves * vs_mechanics_travel(m, k->x));
  z[1] = moves * vs_mechanics_travel(m, k->x + m->dof);
  vs_wave_at(&d->mains, since_s, u);
  if (m->coil.square) {
    double r = m->coil.resistance_ohm / (2 * m->coil.a_hm);
    k->flux_rate_v = u[0] - r * k->flux_wb * z[0];
  } else {
    k->flux_rate_v = u[0] - m->coil.resistance_ohm * vs_coil_current(&m->coil, k->flux_wb, z[0]);
  }
  complete_driven_knot(d, k);
  z[2] = moves * vs_mechanics_travel(m, k->a);
  if (m->coil.square)
    square_rates(m, u, z, k);
  else
    law_rates(m, u, z, k);
}

void vs_driven_find_coordinates(vs_driven *d) {
  const vs_model *m = d->frame->model;
  double w = m->working_rad_s > 0 ? m->working_rad_s : m->fastest_rad_s;
  double force = fabs(vs_coil_force(&m->coil, d->flux_wb, m->coil.gap_rest_m));
  double per_newton = fabs(m->per_newton_m_s2), closes = m->coil.gap_rest_m / per_newton;
  bool held = m->plain || force / (w * w) < closes;
  for (int i = 0; i < m->dof; i++) {
    double own = fmax(fabs(m->mf[i]), 1e-6 * per_newton);
    d->coordinate[i] = held ? own * force / (w * w) : own * closes;
  }
}

/* A flux linkage below this, relative to that of the mains, is none: it comes from a voltage that
 * was as good as none. */
static const double FAINT = 1e-9;

double vs_driven_built_up(const vs_driven *d, double t_s) {
  const vs_timeline *line = d->frame->timeline;
  const vs_wave *wave = &d->mains;
  double most = fmin(vs_wave_edge(line, t_s) - t_s, line->period_s), flux = 0;
  double half = fmin(vs_wave_turns(wave, -1, 0, most), most) / 2;
  for (size_t k = 0; k < wave->count; k++) { /* its integral: cosines' difference */
    const vs_sine *s = &wave->sine[k];
    double turned = s->omega_rad_s * half;
    flux += 2 * s->peak_v / s->omega_rad_s * sin(s->phase_rad + turned) * sin(turned);
  }
  return fmax(flux, FAINT * line->peak_v / line->omega_rad_s);
}

void vs_driven_find_large(vs_driven *d, bool valve) {
  const vs_timeline *line = d->frame->timeline;
  double range[2] = {0, 0};
  if (valve) vs_firing_range(line, range);
  d->flux_wb = line->peak_v / line->omega_rad_s * (1 + cos(range[0]));
  if (line->supply.direct) {
    const vs_coil *coil = &d->frame->model->coil;
    d->flux_wb = line->peak_v * fmin(coil->rest_h / coil->resistance_ohm, line->period_s);
  }
  vs_driven_find_coordinates(d);
}

double vs_driven_mains_turn(const vs_driven *d, bool disturbed, double most_s) {
  const vs_wave *u = &d->mains;
  if (!u->count) return INFINITY;
  if (!disturbed) return (M_PI - u->sine[0].phase_rad) / u->sine[0].omega_rad_s;
  return fmin(vs_wave_turns(u, -1, d->since_s, most_s), most_s); /* NaN: it does not */
}
