/* SPDX-License-Identifier: GPL-3.0-or-later
 * Wing plant: matrices, modes, state space, energies. */
#include <math.h>
#include <string.h>

#include "plant/coil.h"
#include "suite.h"

static vs_model model_of(const char *set) {
  const char *sets[] = {"run.until=1ms", set, NULL};
  vs_trial *t = vs_trial_run("paper", "switched", sets, NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  vs_model m = t->scene.setup.model;
  vs_trial_free(t);
  return m;
}

/* Eigenfrequencies of the mechanics with Table 1, to the ten digits they are known to. */
static void modes_have_their_frequencies(void) {
  static const double PAPER[4] = {8.33011423, 16.72221123, 31.61794792, 56.57710805};
  static const double DERIVED[4] = {8.32990797, 16.72157209, 31.63857348, 56.54844917};
  static const double TAU[4] = {58.090078, 14.487634, 4.0159056, 0.57104797};
  vs_mode modes[VS_MOST_STATES];
  vs_model m = model_of("machine.m14=paper");
  CU_ASSERT_TRUE_FATAL(vs_mechanics_modes(&m, modes));
  for (int k = 0; k < 4; k++) {
    CLOSE_OF(modes[2 * k].frequency_hz, PAPER[k], 1, 6e-9); /* the printed digits end at 1e-8 Hz */
    CLOSE(modes[2 * k].time_constant_s, TAU[k], 1e-7);      /* eight digits are printed */
    CU_ASSERT_DOUBLE_EQUAL(modes[2 * k].im_rad_s, -modes[2 * k + 1].im_rad_s, 1e-9);
  }
  m = model_of("machine.m14=derived");
  CU_ASSERT_TRUE_FATAL(vs_mechanics_modes(&m, modes));
  for (int k = 0; k < 4; k++) CLOSE_OF(modes[2 * k].frequency_hz, DERIVED[k], 1, 6e-9);
}

static void working_mode_is_the_one_the_force_drives(void) {
  vs_model m = model_of("machine.m14=paper");
  CLOSE(m.working_rad_s / (2 * M_PI), 56.57710805, 1e-9);
  CLOSE(m.fastest_rad_s / (2 * M_PI), 56.57710805, 1e-9);
}

/* m14 = m_K [(yC - yB) sin a + (xC - xB) cos a] = 2.2423696761e-3 kg m */
static void derived_m14_has_its_value(void) {
  CLOSE(model_of("machine.m14=derived").mass[P][PHI], 2.2423696761e-3, 1e-10);
  CU_ASSERT_EQUAL(model_of("machine.m14=paper").mass[P][PHI], 0);
}

/* Eq. 88: 0.3 * 2 g/cm3 * 380 cm3 = 0.228 kg, on m_k alone */
static void load_adds_to_the_trough(void) {
  const char *sets[] = {"load.fraction=0.3", "load.density=2 g/cm3", "run.until=1ms", NULL};
  vs_trial *t = vs_trial_run("paper", "switched", sets, NULL);
  CU_ASSERT_EQUAL_FATAL(t->status, VS_OK);
  CLOSE(t->scene.setup.model.mass[P][P], 0.83 + 0.228, 1e-14);
  CLOSE(t->scene.setup.model.mass[U][U], 4.83 + 0.228, 1e-14);
  vs_trial_free(t);
}

/* The state space (Eqs. 84-87) says the same as the equation of motion (Eq. 54): x~' = A x~ + B Q.
 */
static void state_space_is_the_equation_of_motion(void) {
  vs_model m = model_of("machine.m14=derived");
  vs_state_space s;
  vs_mechanics_state_space(&m, &s);
  const double x[VS_STATES] = {1e-3, -2e-4, 3e-4, 1e-2, 0.3, -0.05, 0.02, 1.5}, force = 90;
  double a[VS_MOST_DOF];
  vs_mechanics_accelerations(&m, x, x + VS_DOF, force, a);
  for (int i = 0; i < VS_DOF; i++) {
    double from_space = -s.b[i][P] * force, q = 0;
    for (int j = 0; j < VS_DOF; j++) {
      from_space += s.a[i][j] * x[VS_DOF + j] + s.a[i][VS_DOF + j] * x[j];
      q += s.c[i][j] * x[VS_DOF + j] + s.c[i][VS_DOF + j] * x[j];
    }
    CLOSE(a[i], from_space, 1e-12);
    CU_ASSERT_EQUAL(q, x[i]);
    /* and M q" + B q' + K q = (-F, 0, 0, 0) */
    double left = 0, size = 0;
    for (int j = 0; j < VS_DOF; j++) {
      left += m.mass[i][j] * a[j] + m.damping[i][j] * x[VS_DOF + j] + m.stiffness[i][j] * x[j];
      size += fabs(m.stiffness[i][j] * x[j]);
    }
    CLOSE_OF(left, i == P ? -force : 0, size, 1e-12);
  }
}

static void actuator_is_consistent(void) {
  vs_model m = model_of("machine.m14=paper");
  CLOSE(m.coil.a_hm, 5.2e-3, 1e-14);
  double z = conveyor_gap(&m, -1e-3), flux = 1.2, i = vs_coil_current(&m.coil, flux, z);
  CLOSE(vs_coil_force(&m.coil, flux, NAN), m.coil.a_hm * i * i / (z * z),
        1e-14); /* F = a i^2/z^2, Eq. 72 */
  CLOSE(vs_coil_energy(&m.coil, flux, z), flux * i / 2, 1e-14);
  double dz = 1e-7; /* F = -dW/dz at constant lambda, by a central difference that is exact: W is
                       linear in z */
  CLOSE((vs_coil_energy(&m.coil, flux, z + dz) - vs_coil_energy(&m.coil, flux, z - dz)) / (2 * dz),
        vs_coil_force(&m.coil, flux, NAN), 1e-8);
}

/* M and K must be positive definite: Eq. 55 with the paper's m14 = 0 and hardly any inertia is not;
 * K is singular when both mounts lie on one vertical line, about which nothing holds the base. */
static void indefinite_matrices_are_refused(void) {
  static const char *const M_SETS[] = {"machine.base_inertia=1e-9 kg.m2",
                                       "machine.trough_inertia=1e-9 kg.m2",
                                       "machine.base_mass=0.01 kg", NULL};
  static const char *const K_SETS[] = {"machine.mount_3=[194 mm, 15 mm]",
                                       "machine.mount_4=[194 mm, 15 mm]", NULL};
  static const struct {
    const char *const *sets, *word;
  } ROWS[] = {{M_SETS, "mass is not positive definite"},
              {K_SETS, "stiffness is not positive definite"}};
  for (size_t k = 0; k < 2; k++) {
    vs_trial *t = vs_trial_run("paper", "switched", ROWS[k].sets, NULL);
    CU_ASSERT_EQUAL(t->status, VS_INPUT);
    CU_ASSERT_PTR_NOT_NULL(strstr(t->err.text, ROWS[k].word));
    vs_trial_free(t);
  }
}

static const vs_test TESTS[] = {
    {"modes, m14 both ways", modes_have_their_frequencies},
    {"working mode", working_mode_is_the_one_the_force_drives},
    {"derived m14", derived_m14_has_its_value},
    {"load", load_adds_to_the_trough},
    {"state space", state_space_is_the_equation_of_motion},
    {"indefinite matrices", indefinite_matrices_are_refused},
    {"actuator", actuator_is_consistent},
};
VS_SUITE_MAIN("machine", TESTS)
