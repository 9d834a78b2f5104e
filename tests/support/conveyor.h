/* SPDX-License-Identifier: GPL-3.0-or-later
 * The paper's conveyor by its own names, for tests that know which machine they look at. */
#pragma once

#include "plant/mechanics.h"
#include "engine/channel.h"

enum { P, U, W, PHI, VS_DOF, VS_STATES = 2 * VS_DOF };
enum {
  VS_CH_P = VS_CH_Q,
  VS_CH_U,
  VS_CH_W,
  VS_CH_PHI,
  VS_CH_VP,
  VS_CH_VU,
  VS_CH_VW,
  VS_CH_VPHI,
  VS_CH_AP,
  VS_CH_AU,
  VS_CH_AW,
  VS_CH_APHI
};

/* The parameters of spice/machines/conveyor.yaml, SI; pairs are x, y. */
typedef struct conveyor_values {
  double trough_mass_kg, base_mass_kg, trough_inertia_kgm2, base_inertia_kgm2, spring_angle_rad;
  double base_com_m[2], trough_com_m[2], mount_3_m[2], mount_4_m[2];
  double spring_stiffness_n_m, mount_stiffness_x_n_m, mount_stiffness_y_n_m;
  double spring_damping_ns_m, mount_damping_x_ns_m, mount_damping_y_ns_m;
  int m14; /* 0: the paper's (zero), 1: as Eq. 55 gives it */
} conveyor_values;
conveyor_values conveyor_values_of(const vs_model *model);

static inline double conveyor_gap(const vs_model *m, double p_m) {
  return vs_coil_gap(&m->coil, p_m);
}
