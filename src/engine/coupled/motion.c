/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupled/motion.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

#include "plant/coil.h"

static int rhs(double s, const double x[], double rate[], void *user) {
  const vs_motion *m = user;
  const vs_model *model = m->model;
  const double *q = x, *v = x + model->dof;
  double flux = m->flux[0] + s * (m->flux[1] + s * (m->flux[2] + s * m->flux[3]));
  double g = vs_mechanics_travel(model, q), a[VS_MOST_DOF];
  double force = vs_coil_force(&model->coil, flux, vs_coil_gap(&model->coil, g));
  if (m->touched)
    force += vs_stops_force(&model->stops, m->touched, g, vs_mechanics_travel(model, v));
  vs_mechanics_accelerations(model, q, v, force, a);
  if (m->jammed) vs_mechanics_hold(model, a);
  memcpy(rate, v, (size_t)model->dof * sizeof *rate);
  memcpy(rate + model->dof, a, (size_t)model->dof * sizeof *rate);
  return GSL_SUCCESS;
}

/* ---- a free swing as a series ---- */

/* F = lambda^2/(4a) and its first four derivatives, at_s into the course of the flux. */
static void force_rates(const vs_motion *m, double at_s, double f[5]) {
  const double *c = m->flux, a4 = 4 * m->model->coil.a_hm;
  double l0 = c[0] + at_s * (c[1] + at_s * (c[2] + at_s * c[3]));
  double l1 = c[1] + at_s * (2 * c[2] + at_s * 3 * c[3]);
  double l2 = 2 * c[2] + at_s * 6 * c[3], l3 = 6 * c[3];
  f[0] = l0 * l0 / a4;
  f[1] = 2 * l0 * l1 / a4;
  f[2] = 2 * (l0 * l2 + l1 * l1) / a4;
  f[3] = (2 * l0 * l3 + 6 * l1 * l2) / a4;
  f[4] = (8 * l1 * l3 + 6 * l2 * l2) / a4;
}

/* The Taylor series of q up to its sixth derivative, which follows from Eq. 54, and of q' as far.
 * Over the longest substep of 0.02 rad the rest is (0.02)^7/7! = 3e-16 of the amplitude of q and
 * (0.02)^6/6! = 9e-14 of that of q'. */
static inline __attribute__((always_inline)) void swing(const vs_motion *m, double at_s, double h,
                                                        int dof, double *x) {
  enum { ORDER = 6 };
  const vs_model *model = m->model;
  double d[ORDER + 1][VS_MOST_DOF], f[ORDER - 1];
  force_rates(m, at_s, f);
  memcpy(d[0], x, (size_t)dof * sizeof *x);
  memcpy(d[1], x + dof, (size_t)dof * sizeof *x);
  vs_mechanics_accelerations(model, d[0], d[1], f[0], d[2]);
  for (int n = 1; n + 2 <= ORDER; n++) vs_mechanics_jerks(model, d[n], d[n + 1], f[n], d[n + 2]);
  double h2 = h / 2, h3 = h / 3, h4 = h / 4, h5 = h / 5, h6 = h / 6;
  for (int i = 0; i < dof; i++) {
    x[i] = d[0][i] +
           h * (d[1][i] +
                h2 * (d[2][i] + h3 * (d[3][i] + h4 * (d[4][i] + h5 * (d[5][i] + h6 * d[6][i])))));
    x[dof + i] =
        d[1][i] + h * (d[2][i] + h2 * (d[3][i] + h3 * (d[4][i] + h4 * (d[5][i] + h5 * d[6][i]))));
  }
}

/* ---- substeps ---- */

static bool substep(vs_motion *m, double at_s, double h, double *x) {
  double error[VS_MOST_STATES];
  if (m->model->coil.square && !m->touched && !m->jammed) {
    if (m->model->dof == VS_ROWS)
      swing(m, at_s, h, VS_ROWS, x);
    else
      swing(m, at_s, h, m->model->dof, x);
    return true;
  }
  return !gsl_odeiv2_step_apply(m->step, at_s, h, x, error, NULL, NULL, &m->system);
}

/* The armature meets or leaves a stop in the substep of h from x. Takes x to that instant, by
 * Newton's iteration on the substep's length, and returns that length. */
static double to_contact(vs_motion *m, const vs_stop *stop, bool leaves, double at_s, double h,
                         double *x) {
  const vs_model *model = m->model;
  double from[VS_MOST_STATES], lower = 0, upper = h, sign = leaves ? 1 : -1;
  memcpy(from, x, m->size);
  for (int n = 0; n < 40; n++) {
    memcpy(x, from, m->size);
    if (!substep(m, at_s, h, x)) return NAN;
    double left =
        sign * vs_stop_depth(stop, vs_mechanics_travel(model, x)); /* falls through zero */
    double rate = -sign * stop->side * vs_mechanics_travel(model, x + model->dof);
    if (fabs(left) < 1e-15 * fabs(stop->at_m) || upper - lower < 1e-17) break;
    if (left > 0)
      lower = h;
    else
      upper = h;
    double next = h - left / rate;
    h = next > lower && next < upper ? next : (lower + upper) / 2;
  }
  return h;
}

/* Goes to the first of the contacts of these stops in the substep from x, says in m->changed which
 * that is, and returns how far into the substep it is. */
static double to_first_contact(vs_motion *m, unsigned stops, double at_s, double h, double *x) {
  double from[VS_MOST_STATES], there[VS_MOST_STATES], first = INFINITY;
  memcpy(from, x, m->size);
  for (int k = 0; k < m->model->stops.count; k++) {
    if (!(stops >> k & 1)) continue;
    memcpy(there, from, m->size);
    double at = to_contact(m, &m->model->stops.item[k], m->touched >> k & 1, at_s, h, there);
    if (isnan(at)) return NAN;
    if (at >= first) continue;
    first = at;
    m->changed = 1u << k;
    memcpy(x, there, m->size);
  }
  return first;
}

double vs_motion_advance(vs_motion *m, double at_s, double h, double *x) {
  const vs_model *model = m->model;
  double longest = m->touched ? m->substep_touching_s : m->substep_s, before[VS_MOST_STATES];
  double n = fmax(ceil((h - at_s) / longest), 1), sub = (h - at_s) / n;
  for (double k = 0; k < n; k++) {
    memcpy(before, x, m->size);
    if (!substep(m, at_s + k * sub, sub, x)) return NAN;
    unsigned changed = vs_stops_touched(&model->stops, vs_mechanics_travel(model, x)) ^ m->touched;
    if (!changed) continue;
    memcpy(x, before, m->size);
    return at_s + k * sub + to_first_contact(m, changed, at_s + k * sub, sub, x);
  }
  return h;
}

double vs_motion_fastest(const vs_model *model) {
  const vs_coil *c = &model->coil;
  if (c->square) return model->fastest_rad_s; /* the force hangs on the flux linkage alone */
  double z = c->gap_rest_m, i[3], force[3];
  const double flux[3] = {0}, moving[3] = {z, 1, 0};
  c->law->along(c, flux, moving, i, force); /* the force's rate is then dF/dz */
  return model->fastest_rad_s + sqrt(fabs(force[1] * model->per_newton_m_s2));
}

void vs_motion_take(vs_motion *m, const vs_model *model) {
  double fastest = vs_motion_fastest(model);
  m->model = model;
  m->substep_s = 0.02 / fastest;
  m->substep_touching_s = 0.02 / fmax(model->contact_rad_s, fastest);
}

void vs_motion_begin(vs_motion *m, const vs_model *model) {
  *m = (vs_motion){
      .size = 2 * (size_t)model->dof * sizeof(double),
      .system = {rhs, NULL, 2 * (size_t)model->dof, m},
      .step = vs_checked(gsl_odeiv2_step_alloc(gsl_odeiv2_step_rkf45, 2 * (size_t)model->dof))};
  vs_motion_take(m, model);
}

void vs_motion_end(vs_motion *m) {
  gsl_odeiv2_step_free(m->step);
}
