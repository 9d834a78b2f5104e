/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupling/motion.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

#include "actuator/coil.h"

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

static bool substep(vs_motion *m, double at_s, double h, double *x) {
  double error[VS_MOST_STATES];
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
