/* SPDX-License-Identifier: GPL-3.0-or-later
 * The equation of motion, M q" + B q' + K q = f0 - F c (Eq. 54), its energies and its modes.
 * All are pure functions of the model. */
#pragma once

#include <stdbool.h>
#include <string.h>

#include "plant/blocks.h"

/* The travel g = c.q by which the gap is opened, and likewise its rate from q', m and m/s. */
static inline double vs_mechanics_travel(const vs_model *model, const double *q) {
  if (model->alone) return q[model->alone - 1];
  double g = model->along[0] * q[0];
  for (int i = 1; i < model->dof; i++) g += model->along[i] * q[i];
  return g;
}
/* What messages call the travel: the coordinate that it is, else "travel". */
const char *vs_mechanics_travel_name(const vs_model *model);
/* The air gap z = D + d + c.q, m. */
static inline double vs_mechanics_gap(const vs_model *model, const double *q) {
  return vs_coil_gap(&model->coil, vs_mechanics_travel(model, q));
}

/* The accelerations q" [m/s2, rad/s2] from q, q' and the force F [N] that closes the gap (Eq. 83):
 *   q" = M^-1 f0 - M^-1 c F - M^-1 K q - M^-1 B q'
 * Where there is just one block, it is written out. */
static inline void vs_mechanics_accelerations(const vs_model *model, const double *q,
                                              const double *v, double force_n,
                                              double acceleration[VS_MOST_DOF]) {
  const double(*k)[VS_MOST_DOF] = model->mk_column, (*b)[VS_MOST_DOF] = model->mb_column;
  double sum[VS_ROWS];
  if (model->dof != VS_ROWS || model->loaded) {
    vs_block_accelerations(model, q, v, force_n, acceleration);
    return;
  }
  for (int i = 0; i < VS_ROWS; i++)
    sum[i] = model->mf[i] * force_n - (k[0][i] * q[0] + b[0][i] * v[0]) -
             (k[1][i] * q[1] + b[1][i] * v[1]) - (k[2][i] * q[2] + b[2][i] * v[2]) -
             (k[3][i] * q[3] + b[3][i] * v[3]);
  memcpy(acceleration, sum, sizeof sum);
}

/* True where the gap's poles meet and no stop is there: what follows is not physical. */
static inline bool vs_mechanics_closed(const vs_model *model, double g_m) {
  if (!model->coil.law->poles || g_m >= -model->actuator.gap_m) return false;
  return !(model->stops.count && model->stops.item[0].side > 0);
}

/* The jerks q"' from q', q" and dF/dt [N/s]: the same equation, one derivative on, in which f0 has
 * no part. */
static inline void vs_mechanics_jerks(const vs_model *model, const double *v, const double *a,
                                      double force_rate_n_s, double jerk[VS_MOST_DOF]) {
  vs_mechanics_accelerations(model, v, a, force_rate_n_s, jerk);
  for (int i = 0; model->loaded && i < model->dof; i++) jerk[i] -= model->m0[i];
}

/* Holds a jammed armature: takes from q" what the force along the gap that keeps its rate constant
 * contributes, so that c.q" becomes 0. For q' the same is done by an impulse. */
void vs_mechanics_hold(const vs_model *model, double rate[VS_MOST_DOF]);

/* The energies q'.M q'/2, and q.K q/2 - q.f0, J. */
double vs_mechanics_kinetic_energy(const vs_model *model, const double *v);
double vs_mechanics_elastic_energy(const vs_model *model, const double *q);

/* The state space of Eqs. 84-87 with x~ = (q', q), in the paper's order; with n
 * coordinates A is 2n x 2n, B 2n x n (the paper prints one column), C n x 2n, D n x n = 0. The
 * input is a force on each coordinate, the output is q. */
typedef struct vs_state_space {
  double a[VS_MOST_STATES][VS_MOST_STATES], b[VS_MOST_STATES][VS_MOST_DOF],
      c[VS_MOST_DOF][VS_MOST_STATES], d[VS_MOST_DOF][VS_MOST_DOF];
} vs_state_space;
void vs_mechanics_state_space(const vs_model *model, vs_state_space *out);

/* Finds all modes, two for each coordinate, sorted by |s|, pairs by falling imaginary part. Returns
 * false where GSL finds none. */
bool vs_mechanics_modes(const vs_model *model, vs_mode modes[VS_MOST_STATES]);
