/* SPDX-License-Identifier: GPL-3.0-or-later
 * M q" + B q' + K q = (-F, 0, 0, 0), Eq. 54. Pure functions of the model. */
#ifndef VS_MACHINE_MECHANICS_H
#define VS_MACHINE_MECHANICS_H

#include <stdbool.h>
#include <string.h>

#include "machine/model.h"

/* q" [m/s2, rad/s2] from x = (q, q') and the force F [N] on the armature (Eq. 83). */
static inline void vs_mechanics_accelerations(const vs_model *model, const double x[VS_STATES],
                                              double force_n, double acceleration[VS_DOF]) {
  /* q" = M^-1 (-F,0,0,0) - M^-1 K q - M^-1 B q' */
  const double(*k)[VS_DOF] = model->mk_column, (*b)[VS_DOF] = model->mb_column, *v = x + VS_DOF;
  double sum[VS_DOF];
  for (int i = 0; i < VS_DOF; i++)
    sum[i] = model->mf[i] * force_n - (k[P][i] * x[P] + b[P][i] * v[P]) -
             (k[U][i] * x[U] + b[U][i] * v[U]) - (k[W][i] * x[W] + b[W][i] * v[W]) -
             (k[PHI][i] * x[PHI] + b[PHI][i] * v[PHI]);
  memcpy(acceleration, sum, sizeof sum);
}

/* What the stop adds to F while the armature touches it, N: k (p + D) + c p', negative in
 * compression. It acts along p just as F does, so it goes wherever F goes; the second is its rate,
 * N/s. */
static inline double vs_mechanics_stop_force(const vs_model *model, const double x[VS_STATES]) {
  const vs_actuator_values *a = &model->actuator;
  return a->stop.stiffness_n_m * (x[P] + a->gap_m) + a->stop.damping_ns_m * x[VS_DOF + P];
}
static inline double vs_mechanics_stop_rate(const vs_model *model, const double x[VS_STATES],
                                            const double acceleration[VS_DOF]) {
  const vs_stop_values *s = &model->actuator.stop;
  return s->stiffness_n_m * x[VS_DOF + P] + s->damping_ns_m * acceleration[P];
}
/* Is the armature in the stop? Never without one. */
static inline bool vs_mechanics_in_stop(const vs_model *model, double p_m) {
  return model->actuator.stop.present && p_m < -model->actuator.gap_m;
}

/* q"' from (q', q") and dF/dt [N/s]: the same equation one derivative on. */
static inline void vs_mechanics_jerks(const vs_model *model,
                                      const double velocity_acceleration[VS_STATES],
                                      double force_rate_n_s, double jerk[VS_DOF]) {
  vs_mechanics_accelerations(model, velocity_acceleration, force_rate_n_s, jerk);
}

/* A jammed armature: the force along p that keeps p' where it is takes its part of q" (or, as an
 * impulse, of q') away: row P of it becomes 0. */
void vs_mechanics_hold_p(const vs_model *model, double rate[VS_DOF]);

double vs_mechanics_kinetic_energy(const vs_model *model,
                                   const double x[VS_STATES]); /* q'.M q'/2, J */
double vs_mechanics_elastic_energy(const vs_model *model,
                                   const double x[VS_STATES]); /* q.K q/2, J */

/* State space of Eqs. 84-87, x~ = (q', q) in the paper's order: A 8x8, B 8x4 (the paper prints
 * 8x1), C 4x8, D 4x4 = 0. */
typedef struct vs_state_space {
  double a[VS_STATES][VS_STATES], b[VS_STATES][VS_DOF], c[VS_DOF][VS_STATES], d[VS_DOF][VS_DOF];
} vs_state_space;
void vs_mechanics_state_space(const vs_model *model, vs_state_space *out);

typedef struct vs_mode {
  double re_1_s, im_rad_s; /* eigenvalue s of the free motion */
  double frequency_hz;     /* |s|/2 pi */
  double time_constant_s;  /* -1/Re s; infinite when undamped */
  double damping_ratio;    /* -Re s/|s| */
  double drive;            /* size of this mode's share in p after a unit impulse of F, m/(N s) */
  double shape_re[VS_DOF], shape_im[VS_DOF]; /* of q, scaled to a largest component of 1 */
} vs_mode;
/* All eight eigenvalues, sorted by |s|, pairs by falling imaginary part. false: GSL found none. */
bool vs_mechanics_modes(const vs_model *model, vs_mode modes[VS_STATES]);

#endif
