/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ideal/runge_kutta.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

#include "plant/coil.h"

/* How many states the vector has. */
static size_t states_of(const vs_model *m) {
  return 2 * (size_t)m->dof + 1 + (size_t)m->coil.rungs;
}

void vs_runge_kutta_begin(vs_runge_kutta *g, const vs_model *m) {
  *g = (vs_runge_kutta){.stepper =
                            vs_checked(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, states_of(m)))};
}

void vs_runge_kutta_end(vs_runge_kutta *g) {
  if (g->stepper) gsl_odeiv2_step_free(g->stepper);
  g->stepper = NULL;
}

void vs_runge_kutta_restart(vs_runge_kutta *g) {
  g->next_s = 0;
}

/* ---- the equations, of a vector (q, q', lambda, psi) without a gap ---- */

/* dlambda/dt = u - R_c i, and the machine's accelerations with the forces of coil and stops. */
static int machine_and_coil_rhs(double since_s, const double *y, double *rate, void *params) {
  const vs_driven *d = params;
  const vs_model *m = d->frame->model;
  int dof = m->dof;
  double g = vs_mechanics_travel(m, y), g1 = vs_mechanics_travel(m, y + dof), flux = y[2 * dof];
  double z = vs_coil_gap(&m->coil, g), u[3], force = 0, a[VS_MOST_DOF];
  rate[2 * dof] = 0;
  for (int n = 0; n < m->coil.rungs; n++) rate[2 * dof + 1 + n] = 0;
  if (m->coil.eddies && (d->conducting || d->fades)) {
    const bool rests = d->frame->gap_at_rest;
    const double gap[2] = {rests ? m->coil.gap_rest_m : z, rests ? 0 : g1};
    double psi[VS_MOST_RUNGS] = {0};
    memcpy(psi, y + 2 * dof + 1, (size_t)m->coil.rungs * sizeof *psi);
    if (d->conducting) vs_wave_at(&d->mains, since_s, u);
    rate[2 * dof] =
        vs_driven_flux_rate(d, d->conducting ? u[0] : 0, flux, psi, gap, rate + 2 * dof + 1);
    force = vs_coil_force(&m->coil, flux, z);
  } else if (d->conducting) {
    double z_coil = d->frame->gap_at_rest ? m->coil.gap_rest_m : z;
    vs_wave_at(&d->mains, since_s, u);
    rate[2 * dof] = u[0] - m->coil.resistance_ohm * vs_coil_current(&m->coil, flux, z_coil);
    force = vs_coil_force(&m->coil, flux, z);
  }
  if (d->touched && !d->held) force += vs_stops_force(&m->stops, d->touched, g, g1);
  vs_mechanics_accelerations(m, y, y + dof, force, a);
  if (d->held) vs_mechanics_hold(m, a);
  memcpy(rate, y + dof, (size_t)dof * sizeof *rate);
  memcpy(rate + dof, a, (size_t)dof * sizeof *rate);
  return isfinite(rate[2 * dof] + a[0]) ? GSL_SUCCESS : GSL_EBADFUNC;
}

/* ---- a step of two halves ---- */

enum { ENDS = 3, EACH = 4, TERMS = ENDS * EACH, QUANTITIES = VS_MOST_DOF + 1 };

/* By how much less the coordinates may be off while a stop is touched: its force follows the depth,
 * which is small beside the gap, and is not smooth, so that the books need short steps there. */
static const double IN_A_STOP = 1e-3;

/* What is large for the coordinate i in a step of h_s. A fast coordinate is as large as it gets. */
static double size_of(const vs_driven *d, const vs_knot *k, int i, double h_s) {
  int dof = d->frame->model->dof;
  double size = fmax(d->coordinate[i], fabs(k->x[i]) + h_s * fabs(k->x[dof + i]));
  return d->touched && !d->held ? IN_A_STOP * size : size;
}
static double flux_size(const vs_driven *d, const vs_knot *k) {
  return fmax(d->flux_wb, fabs(k->flux_wb));
}

/* Goes from a knot h_s on. Returns GSL's estimate of the error, relative to what is large; of q'
 * what it makes of q in the step. INFINITY: the equations have no value on the way. */
static double go_half(vs_runge_kutta *g, double since_s, double h_s, const vs_knot *from,
                      vs_knot *to) {
  const vs_driven *d = g->driven;
  int dof = d->frame->model->dof;
  size_t states = 2 * (size_t)dof;
  const vs_coil *c = &d->frame->model->coil;
  size_t rungs = (size_t)c->rungs;
  double y[VS_CONDUCTING], error[VS_CONDUCTING], rate[VS_CONDUCTING], worst;
  gsl_odeiv2_system system = {machine_and_coil_rhs, NULL, states + 1 + rungs, (void *)(size_t)d};
  memcpy(y, from->x, states * sizeof *y);
  y[states] = from->flux_wb;
  memcpy(y + states + 1, from->psi_wb, rungs * sizeof *y);
  for (int n = 0; n < c->rungs; n++)
    rate[states + 1 + (size_t)n] = vs_coil_rung_rate(c, n, from->flux_wb, from->psi_wb);
  memcpy(rate, from->x + dof, (size_t)dof * sizeof *rate);
  memcpy(rate + dof, from->a, (size_t)dof * sizeof *rate);
  rate[states] = from->flux_rate_v;
  if (gsl_odeiv2_step_apply(g->stepper, since_s, h_s, y, error, rate, NULL, &system))
    return INFINITY;
  memcpy(to->x, y, states * sizeof *y);
  to->flux_wb = y[states];
  memcpy(to->psi_wb, y + states + 1, rungs * sizeof *y);
  vs_driven_fill(d, since_s + h_s, to);
  worst = fabs(error[states]) / flux_size(d, from);
  for (size_t n = 0; n < rungs; n++)
    worst = fmax(worst, fabs(error[states + 1 + n]) / flux_size(d, from));
  for (int i = 0; i < dof; i++) {
    double own = fmax(fabs(error[i]), h_s * fabs(error[dof + i]));
    worst = fmax(worst, own / size_of(d, from, i, h_s));
  }
  return worst;
}

/* By how much the polynomial of degree seven between the ends is off in the middle, where it is off
 * most, relative to what is large. Its slope there, times the length, is judged too: it is off
 * where the value, by chance, is not. */
static double off_in_the_middle(const vs_driven *d, const vs_knot k[ENDS], double h) {
  int dof = d->frame->model->dof;
  double worst = 0;
  for (int i = 0; i <= dof; i++) {
    double e[ENDS][EACH], size = i < dof ? size_of(d, &k[0], i, h) : flux_size(d, &k[0]);
    for (int n = 0; n < ENDS; n++) {
      const vs_knot *at = &k[n];
      const double of_q[EACH] = {at->x[i % dof], at->x[dof + i % dof], at->a[i % dof],
                                 at->j[i % dof]};
      const double of_flux[EACH] = {at->flux_wb, at->flux_rate_v, at->flux_rate2_v_s,
                                    at->flux_rate3_v_s2};
      memcpy(e[n], i < dof ? of_q : of_flux, sizeof e[n]);
    }
    double value = (e[0][0] + e[2][0]) / 2 + h * (11 * (e[0][1] - e[2][1]) / 64) +
                   h * h * (3 * (e[0][2] + e[2][2]) / 128) +
                   h * h * h * ((e[0][3] - e[2][3]) / 768);
    double slope = 35 * (e[2][0] - e[0][0]) / (16 * h) - 19 * (e[0][1] + e[2][1]) / 32 +
                   h * (e[2][2] - e[0][2]) / 16 - h * h * (e[0][3] + e[2][3]) / 384;
    worst = fmax(worst, fmax(fabs(value - e[1][0]), h * fabs(slope - e[1][1]) / 4) / size);
    if (isnan(value + slope)) return INFINITY;
  }
  return worst;
}

/* ---- the polynomial of degree eleven ---- */

/* Its coefficients c[n] in powers of s, 0 to 1 over the step, from value and derivatives, `each`
 * of them, at s = 0, 1/2 and 1 (f[n][k]: the k-th derivative times h^k/k!): Newton's divided
 * differences, each place taken as often, and then the Newton form multiplied out. */
static void interpolate(double f[ENDS][EACH], int each, double c[TERMS]) {
  double place[TERMS], d[TERMS];
  const int terms = ENDS * each;
  for (int n = 0; n < terms; n++) {
    place[n] = n / each / (double)(ENDS - 1);
    d[n] = f[n / each][0];
  }
  for (int order = 1; order < terms; order++)
    for (int n = terms - 1; n >= order; n--) {
      double apart = place[n] - place[n - order];
      d[n] = apart > 0 ? (d[n] - d[n - 1]) / apart : f[n / each][order];
    }
  memset(c, 0, TERMS * sizeof *c);
  for (int n = terms - 1; n >= 0; n--) { /* c becomes c (s - place) + d */
    for (int k = terms - 1; k > 0; k--) c[k] = c[k - 1] - place[n] * c[k];
    c[0] = d[n] - place[n] * c[0];
  }
}

/* Of psi, whose derivatives follow from lambda's, and of the current, of which two are known. */
static void take_eddies(const vs_driven *d, const vs_knot k[ENDS], double h, vs_taylor *s) {
  const vs_coil *coil = &s->model->coil;
  double f[VS_MOST_RUNGS + 1][ENDS][EACH], c[TERMS], i[3];
  for (int n = 0; n < ENDS; n++) {
    const double flux[EACH - 1] = {k[n].flux_wb, k[n].flux_rate_v, k[n].flux_rate2_v_s};
    double psi[EACH][VS_MOST_RUNGS];
    memcpy(psi[0], k[n].psi_wb, sizeof psi[0]);
    double weight = 1;
    for (int order = 0; order < EACH; order++, weight *= h / order)
      for (int r = 0; r < coil->rungs; r++) {
        f[r][n][order] = weight * psi[order][r];
        if (order + 1 < EACH)
          psi[order + 1][r] = vs_coil_rung_rate(coil, r, flux[order], psi[order]);
      }
    vs_driven_current(d, &k[n], d->since_s + n * h / (ENDS - 1), i);
    for (int order = 0; order < 3; order++)
      f[coil->rungs][n][order] = coil->rest_h * i[order] * (order == 2 ? h * h / 2 : order ? h : 1);
  }
  for (int r = 0; r <= coil->rungs; r++) {
    interpolate(f[r], r < coil->rungs ? EACH : 3, c);
    for (int n = 0; n < TERMS; n++) *(r < coil->rungs ? &s->psi[n][r] : &s->current[n]) = c[n];
  }
}

static void take_polynomial(const vs_driven *d, const vs_knot k[ENDS], double h, vs_taylor *s) {
  const vs_model *m = d->frame->model;
  double f[ENDS][EACH], c[TERMS];
  _Static_assert(TERMS <= VS_SERIES_ORDER + 1, "a series has the terms of the polynomial");
  memset(s, 0, sizeof *s);
  s->span_s = h;
  s->model = m;
  for (int i = 0; i <= m->dof; i++) {
    for (int n = 0; n < ENDS; n++) {
      const vs_knot *at = &k[n];
      bool flux = i == m->dof;
      f[n][0] = flux ? at->flux_wb : at->x[i];
      f[n][1] = h * (flux ? at->flux_rate_v : at->x[m->dof + i]);
      f[n][2] = h * h / 2 * (flux ? at->flux_rate2_v_s : at->a[i]);
      f[n][3] = h * h * h / 6 * (flux ? at->flux_rate3_v_s2 : at->j[i]);
    }
    interpolate(f, EACH, c);
    for (int n = 0; n < TERMS; n++) *(i < m->dof ? &s->q[n][i] : &s->flux[n]) = c[n];
  }
  if (m->coil.eddies) take_eddies(d, k, h, s);
}

/* ---- its length ---- */

/* The part of `rough` by which a step's end may be off. */
static const double AT_END = 0.1;

double vs_runge_kutta_make(vs_runge_kutta *g, const vs_driven *driven, const vs_knot *knot,
                           double longest_s, double rough, vs_taylor *series) {
  vs_knot k[ENDS] = {*knot};
  double h = g->next_s > 0 ? fmin(g->next_s, longest_s) : longest_s;
  double shortest = 4e-16 * (fabs(driven->since_s) + knot->t_s);
  g->driven = driven;
  for (;;) {
    double e = go_half(g, driven->since_s, h / 2, &k[0], &k[1]);
    if (isfinite(e)) e = fmax(e, go_half(g, driven->since_s + h / 2, h / 2, &k[1], &k[2]));
    e /= AT_END;
    if (isfinite(e)) e = fmax(e, off_in_the_middle(driven, k, h));
    double fits = isfinite(e) ? 0.9 * pow(rough / e, 1.0 / 8) : 0.1;
    if (e <= rough) {
      g->next_s = h * fmin(fits, 4);
      break;
    }
    h *= fmax(fmin(fits, 0.9), 0.1);
    if (!(h > shortest)) return 0;
  }
  take_polynomial(driven, k, h, series);
  return h;
}
