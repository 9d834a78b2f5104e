/* SPDX-License-Identifier: GPL-3.0-or-later
 * The equation of motion, M q" + B q' + K q = (-F, 0, 0, 0) (Eq. 54), its energies and its modes.
 * All are pure functions of the model. */
#ifndef VS_MACHINE_MECHANICS_H
#define VS_MACHINE_MECHANICS_H

#include <stdbool.h>
#include <string.h>

#include "machine/model.h"

/* The accelerations q" [m/s2, rad/s2] from x = (q, q') and the force F [N] on the armature
 * (Eq. 83). */
static inline void vs_mechanics_accelerations(const vs_model *model, const double x[VS_STATES],
                                              double force_n, double acceleration[VS_DOF]) {
  /* q" = M^-1 (-F,0,0,0) - M^-1 K q - M^-1 B q' */
  const double(*k)[VS_DOF] = model->mk_column, (*b)[VS_DOF] = model->mb_column, *v = x + VS_DOF;
  double sum[VS_DOF];
  _Static_assert(VS_DOF == 4, "the terms of four coordinates are written out below");
  for (int i = 0; i < VS_DOF; i++)
    sum[i] = model->mf[i] * force_n - (k[P][i] * x[P] + b[P][i] * v[P]) -
             (k[U][i] * x[U] + b[U][i] * v[U]) - (k[W][i] * x[W] + b[W][i] * v[W]) -
             (k[PHI][i] * x[PHI] + b[PHI][i] * v[PHI]);
  memcpy(acceleration, sum, sizeof sum);
}

/* The force that the stop adds to F while the armature touches it, N: k (p + D) + c p', negative in
 * compression. It acts along p as F does, and so goes wherever F goes. */
static inline double vs_mechanics_stop_force(const vs_model *model, const double x[VS_STATES]) {
  const vs_actuator_values *a = &model->actuator;
  return a->stop.stiffness_n_m * (x[P] + a->gap_m) + a->stop.damping_ns_m * x[VS_DOF + P];
}
/* The rate of that force, N/s. */
static inline double vs_mechanics_stop_rate(const vs_model *model, const double x[VS_STATES],
                                            const double acceleration[VS_DOF]) {
  const vs_stop_values *s = &model->actuator.stop;
  return s->stiffness_n_m * x[VS_DOF + P] + s->damping_ns_m * acceleration[P];
}
/* True where the armature is in the stop; never without one. */
static inline bool vs_mechanics_in_stop(const vs_model *model, double p_m) {
  return model->actuator.stop.present && p_m < -model->actuator.gap_m;
}

/* The jerks q"' from (q', q") and dF/dt [N/s]: the same equation, one derivative on. */
static inline void vs_mechanics_jerks(const vs_model *model,
                                      const double velocity_acceleration[VS_STATES],
                                      double force_rate_n_s, double jerk[VS_DOF]) {
  vs_mechanics_accelerations(model, velocity_acceleration, force_rate_n_s, jerk);
}

/* Holds a jammed armature: takes from q" what the force along p that keeps p' constant contributes,
 * so that its row P becomes 0. For q' the same is done by an impulse. */
void vs_mechanics_hold_p(const vs_model *model, double rate[VS_DOF]);

/* The energies q'.M q'/2 and q.K q/2, J. */
double vs_mechanics_kinetic_energy(const vs_model *model, const double x[VS_STATES]);
double vs_mechanics_elastic_energy(const vs_model *model, const double x[VS_STATES]);

/* The state space of Eqs. 84-87 with x~ = (q', q), in the paper's order: A 8x8, B 8x4 (the paper
 * prints 8x1), C 4x8, D 4x4 = 0. The input is a force on each coordinate, the output is q. */
typedef struct vs_state_space {
  double a[VS_STATES][VS_STATES], b[VS_STATES][VS_DOF], c[VS_DOF][VS_STATES], d[VS_DOF][VS_DOF];
} vs_state_space;
void vs_mechanics_state_space(const vs_model *model, vs_state_space *out);

/* A mode of the free motion. */
typedef struct vs_mode {
  double re_1_s, im_rad_s; /* its eigenvalue s */
  double frequency_hz;     /* |s|/2 pi */
  double time_constant_s;  /* -1/Re s; infinite when undamped */
  double damping_ratio;    /* -Re s/|s| */
  double drive;            /* the size of its share in p after a unit impulse of F, m/(N s) */
  double shape_re[VS_DOF], shape_im[VS_DOF]; /* of q, scaled to a largest component of 1 */
} vs_mode;
/* Finds all eight modes, sorted by |s|, pairs by falling imaginary part. Returns false where GSL
 * finds none. */
bool vs_mechanics_modes(const vs_model *model, vs_mode modes[VS_STATES]);

#endif
