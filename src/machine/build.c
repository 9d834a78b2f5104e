/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "machine/build.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>
#include <math.h>
#include <string.h>

#include "machine/mechanics.h"

_Static_assert(P == 0 && U == 1 && W == 2 && PHI == 3 && VS_DOF == 4,
               "the matrices below are written out in this order");

/* One of B (Eq. 56) and K (Eq. 57): the same form with (beta, beta_x, beta_y) or (k, k_x, k_y).
 *   c11 = 2 c;  c22 = 2 cx;  c33 = 2 cy
 *   c24 = cx [(yB - y3) + (yB - y4)];  c34 = cy [(x3 - xB) + (x4 - xB)]
 *   c44 = cx [(yB - y3)^2 + (yB - y4)^2] + cy [(x3 - xB)^2 + (x4 - xB)^2] */
static void mounts_matrix(const vs_machine_values *v, const double c[3],
                          double out[VS_DOF][VS_DOF]) {
  double y3 = v->base_com_m[1] - v->mount_3_m[1], y4 = v->base_com_m[1] - v->mount_4_m[1];
  double x3 = v->mount_3_m[0] - v->base_com_m[0], x4 = v->mount_4_m[0] - v->base_com_m[0];
  memset(out, 0, sizeof(double[VS_DOF][VS_DOF]));
  out[P][P] = 2 * c[0];
  out[U][U] = 2 * c[1];
  out[W][W] = 2 * c[2];
  out[U][PHI] = out[PHI][U] = c[1] * (y3 + y4);
  out[W][PHI] = out[PHI][W] = c[2] * (x3 + x4);
  out[PHI][PHI] = c[1] * (y3 * y3 + y4 * y4) + c[2] * (x3 * x3 + x4 * x4);
}

/* M of Eq. 55, with m34 = m_K (x_C - x_B) (the paper prints x_K there) and with the mass of the
 * loaded trough, m_k = m_k0 + lambda_t rho V_k (Eq. 88). */
static void mass_matrix(vs_model *model) {
  const vs_machine_values *v = &model->machine;
  const vs_load_values *load = &model->load;
  double mk = v->trough_mass_kg + load->fraction * load->density_kg_m3 * load->volume_m3;
  double sin_a = sin(v->spring_angle_rad), cos_a = cos(v->spring_angle_rad);
  double dx = v->trough_com_m[0] - v->base_com_m[0], dy = v->trough_com_m[1] - v->base_com_m[1];
  double m14 = v->m14 ? mk * (dy * sin_a + dx * cos_a) : 0;
  double m[VS_DOF][VS_DOF] = {
      {mk, -mk * sin_a, mk * cos_a, m14},
      {-mk * sin_a, mk + v->base_mass_kg, 0, -mk * dy},
      {mk * cos_a, 0, mk + v->base_mass_kg, mk * dx},
      {m14, -mk * dy, mk * dx,
       v->trough_inertia_kgm2 + v->base_inertia_kgm2 + mk * (dx * dx + dy * dy)},
  };
  memcpy(model->mass, m, sizeof m);
}

/* M^-1 B, M^-1 K and M^-1 (-1,0,0,0) by Cholesky, which fails just when M is not positive definite.
 */
static vs_status solve_mass(vs_model *model, vs_error *err) {
  double m[VS_DOF * VS_DOF], column[VS_DOF];
  memcpy(m, model->mass, sizeof m);
  gsl_matrix_view mv = gsl_matrix_view_array(m, VS_DOF, VS_DOF);
  gsl_vector_view cv = gsl_vector_view_array(column, VS_DOF);
  if (gsl_linalg_cholesky_decomp1(&mv.matrix) != GSL_SUCCESS)
    return vs_fail(err, VS_INPUT,
                   "machine: the inertia matrix M (Eq. 55) is not positive definite; check masses, "
                   "inertias and centres of mass");
  for (int j = 0; j < 2 * VS_DOF + 1; j++) {
    for (int i = 0; i < VS_DOF; i++)
      column[i] = j < VS_DOF       ? model->damping[i][j]
                  : j < 2 * VS_DOF ? model->stiffness[i][j - VS_DOF]
                                   : (i == P ? -1.0 : 0.0);
    gsl_linalg_cholesky_svx(&mv.matrix, &cv.vector);
    for (int i = 0; i < VS_DOF; i++)
      *(j < VS_DOF       ? &model->mb_column[j][i]
        : j < 2 * VS_DOF ? &model->mk_column[j - VS_DOF][i]
                         : &model->mf[i]) = column[i];
  }
  return VS_OK;
}

/* K of Eq. 57 couples p with no other coordinate. The bound of |p| in quiet/quiet.c, by 1/K_pp in
 * the place of (K^-1)_pp, holds for no other K. */
static vs_status check_coupling(const vs_model *model, vs_error *err) {
  for (int i = 0; i < VS_DOF; i++)
    if (i != P && (model->stiffness[P][i] != 0 || model->stiffness[i][P] != 0))
      return vs_fail(err, VS_RUN, "machine: the stiffness matrix couples p with coordinate %d", i);
  return VS_OK;
}

/* Sylvester's criterion (after Eq. 57) by Cholesky: without it the rest position is not stable. */
static vs_status check_stiffness(const vs_model *model, vs_error *err) {
  double k[VS_DOF * VS_DOF];
  memcpy(k, model->stiffness, sizeof k);
  gsl_matrix_view kv = gsl_matrix_view_array(k, VS_DOF, VS_DOF);
  bool positive = gsl_linalg_cholesky_decomp1(&kv.matrix) == GSL_SUCCESS;
  for (size_t i = 0; positive && i < VS_DOF; i++) /* of a smaller pivot only rounding is left */
    positive = pow(gsl_matrix_get(&kv.matrix, i, i), 2) > 1e-14 * model->stiffness[i][i];
  return positive
             ? VS_OK
             : vs_fail(err, VS_INPUT,
                       "machine: the stiffness matrix K (Eq. 57) is not positive definite; check "
                       "the mounts' stiffness and where mount_3, mount_4 and base_com lie");
}

vs_status vs_build_model(const vs_node *scene, vs_model *model, vs_error *err) {
  *model = (vs_model){0};
  size_t found = vs_error_count(err);
  vs_status s = vs_field_section_read(&vs_model_machine_section, vs_tree_child(scene, "machine"),
                                      &model->machine, err);
  if (!s)
    s = vs_field_section_read(&vs_model_actuator_section, vs_tree_child(scene, "actuator"),
                              &model->actuator, err);
  if (!s)
    s = vs_field_section_read(&vs_model_load_section, vs_tree_child(scene, "load"), &model->load,
                              err);
  if (s || vs_error_count(err) > found) return s;
  const vs_machine_values *v = &model->machine;
  const double b[3] = {v->spring_damping_ns_m, v->mount_damping_x_ns_m, v->mount_damping_y_ns_m};
  const double k[3] = {v->spring_stiffness_n_m, v->mount_stiffness_x_n_m, v->mount_stiffness_y_n_m};
  mounts_matrix(v, b, model->damping);
  mounts_matrix(v, k, model->stiffness);
  mass_matrix(model);
  s = solve_mass(model, err);
  if (!s) s = check_stiffness(model, err);
  if (!s) s = check_coupling(model, err);
  if (s) return s;
  model->gap_rest_m = model->actuator.gap_m + model->actuator.pole_cover_m;
  model->a_hm = model->actuator.inductance_h * model->gap_rest_m / 2;
  vs_mode modes[VS_STATES];
  if (!vs_mechanics_modes(model, modes))
    return vs_fail(err, VS_INPUT, "machine: the eigenvalues of the mechanics cannot be found");
  double drive = 0;
  for (int m = 0; m < VS_STATES; m++) {
    double size = hypot(modes[m].re_1_s, modes[m].im_rad_s);
    if (size > model->fastest_rad_s) model->fastest_rad_s = size;
    if (modes[m].drive > drive) {
      drive = modes[m].drive;
      model->working_rad_s = size;
    }
  }
  const vs_stop_values *stop = &model->actuator.stop;
  model->contact_rad_s = model->fastest_rad_s + sqrt(stop->stiffness_n_m * fabs(model->mf[P])) +
                         stop->damping_ns_m * fabs(model->mf[P]);
  return VS_OK;
}
