/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "coupling/motion.h"

#include <gsl/gsl_errno.h>
#include <math.h>
#include <string.h>

#include "machine/actuator.h"

static int rhs(double s, const double x[], double rate[], void *user) {
  const vs_motion *m = user;
  double flux = m->flux[0] + s * (m->flux[1] + s * (m->flux[2] + s * m->flux[3]));
  memcpy(rate, x + VS_DOF, sizeof(double[VS_DOF]));
  double stop = m->touching ? vs_mechanics_stop_force(m->model, x) : 0;
  vs_mechanics_accelerations(m->model, x, vs_actuator_force(m->model, flux) + stop, rate + VS_DOF);
  if (m->jammed) vs_mechanics_hold_p(m->model, rate + VS_DOF);
  return GSL_SUCCESS;
}

static bool substep(vs_motion *m, double at_s, double h, double x[VS_STATES]) {
  double error[VS_STATES];
  return !gsl_odeiv2_step_apply(m->step, at_s, h, x, error, NULL, NULL, &m->system);
}

/* The armature passes p = -D in the substep of h from x. Takes x to that instant, by Newton's
 * iteration on the substep's length, and returns that length. */
static double to_contact(vs_motion *m, double at_s, double h, double x[VS_STATES]) {
  double from[VS_STATES], lower = 0, upper = h, sign = m->touching ? -1 : 1;
  double gap = m->model->actuator.gap_m;
  memcpy(from, x, sizeof from);
  for (int n = 0; n < 40; n++) {
    memcpy(x, from, sizeof from);
    if (!substep(m, at_s, h, x)) return NAN;
    double left = sign * (x[P] + gap); /* falls through zero */
    if (fabs(left) < 1e-15 * gap || upper - lower < 1e-17) break;
    if (left > 0)
      lower = h;
    else
      upper = h;
    double next = h - left / (sign * x[VS_DOF + P]);
    h = next > lower && next < upper ? next : (lower + upper) / 2;
  }
  return h;
}

double vs_motion_advance(vs_motion *m, double at_s, double h, double x[VS_STATES]) {
  double longest = m->touching ? m->substep_touching_s : m->substep_s, before[VS_STATES];
  double n = ceil((h - at_s) / longest), sub = (h - at_s) / n;
  for (double k = 0; k < n; k++) {
    memcpy(before, x, sizeof before);
    if (!substep(m, at_s + k * sub, sub, x)) return NAN;
    if (!m->model->actuator.stop.present || vs_mechanics_in_stop(m->model, x[P]) == m->touching)
      continue;
    memcpy(x, before, sizeof before);
    return at_s + k * sub + to_contact(m, at_s + k * sub, sub, x);
  }
  return h;
}

void vs_motion_begin(vs_motion *m, const vs_model *model) {
  *m = (vs_motion){.model = model,
                   .substep_s = 0.02 / model->fastest_rad_s,
                   .substep_touching_s = 0.02 / model->contact_rad_s,
                   .system = {rhs, NULL, VS_STATES, m},
                   .step = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rkf45, VS_STATES)};
}

void vs_motion_end(vs_motion *m) {
  gsl_odeiv2_step_free(m->step);
}
