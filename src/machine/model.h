/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine as numbers: its masses, springs, mounts and the actuator's geometry, by default those
 * of the paper's Table 1, and what is computed from them once. Constant once it is built. */
#ifndef VS_MACHINE_MODEL_H
#define VS_MACHINE_MODEL_H

#include "base/field.h"
#include "base/tree.h"

/* Coordinates q of Eq. 59: p, the trough relative to the base along the springs' motion; u and w,
 * the base's horizontal and vertical displacement; phi, its rotation counter-clockwise. In m and
 * rad. */
enum { P, U, W, PHI, VS_DOF };
/* A state x is (q, q'). */
enum { VS_STATES = 2 * VS_DOF };

/* What the scene says, in SI. Each member's meaning stands in the texts of vs_model_machine_section
 * and its two sisters. */
typedef struct vs_machine_values {
  double trough_mass_kg, base_mass_kg, trough_inertia_kgm2, base_inertia_kgm2, spring_angle_rad;
  double base_com_m[2], trough_com_m[2], mount_3_m[2], mount_4_m[2]; /* x, y */
  double spring_stiffness_n_m, mount_stiffness_x_n_m, mount_stiffness_y_n_m;
  double spring_damping_ns_m, mount_damping_x_ns_m, mount_damping_y_ns_m;
  int m14; /* 0: the paper's (zero), 1: as Eq. 55 gives it */
} vs_machine_values;
typedef struct vs_stop_values {
  int present; /* 0: there is no stop */
  double stiffness_n_m, damping_ns_m;
} vs_stop_values;
typedef struct vs_actuator_values {
  double gap_m, pole_cover_m, inductance_h, resistance_ohm;
  vs_stop_values stop; /* it stands at p = -gap_m */
} vs_actuator_values;
typedef struct vs_load_values {
  double density_kg_m3, volume_m3, fraction;
} vs_load_values;

extern const vs_section vs_model_machine_section, vs_model_actuator_section, vs_model_load_section;

typedef struct vs_model {
  vs_machine_values machine;
  vs_actuator_values actuator;
  vs_load_values load;
  double mass[VS_DOF][VS_DOF];      /* M, Eq. 55; kg, kg m, kg m2 */
  double damping[VS_DOF][VS_DOF];   /* B, Eq. 56; N s/m, N s, N m s */
  double stiffness[VS_DOF][VS_DOF]; /* K, Eq. 57; N/m, N, N m. It couples p with no other
                                       coordinate, so that (K^-1)_pp = 1/K_pp */
  double mb_column[VS_DOF][VS_DOF]; /* M^-1 B, 1/s and mixed; [j][i] is row i, column j */
  double mk_column[VS_DOF][VS_DOF]; /* M^-1 K, 1/s2 and mixed; laid out the same */
  double mf[VS_DOF];                /* M^-1 (-1, 0, 0, 0): the acceleration per newton of F */
  double gap_rest_m;                /* the air gap z at p = 0: D + d */
  double a_hm;                      /* a = L(0) (D + d)/2, Eq. 72, H m */
  double fastest_rad_s;             /* the largest |s| of the mechanics' modes */
  double contact_rad_s; /* a bound of |s| while the stop is touched; without a stop it is
                           fastest_rad_s */
  double working_rad_s; /* |s| of the mode that F drives hardest in p */
} vs_model;

#endif
