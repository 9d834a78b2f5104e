/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "machine/build.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_matrix.h>
#include <gsl/gsl_vector.h>
#include <math.h>
#include <string.h>

#include "machine/mechanics.h"

/* Transitional: the conveyor's own matrices, until its file is read. */
enum { P, U, W, PHI, VS_DOF };
typedef struct conveyor {
  double trough_mass_kg, base_mass_kg, trough_inertia_kgm2, base_inertia_kgm2, spring_angle_rad,
      spring_stiffness_n_m, mount_stiffness_x_n_m, mount_stiffness_y_n_m, spring_damping_ns_m,
      mount_damping_x_ns_m, mount_damping_y_ns_m;
  double base_com_m[2], trough_com_m[2], mount_3_m[2], mount_4_m[2];
  int m14;
} conveyor;
static conveyor conveyor_of(const vs_machine_values *v) {
  return (conveyor){.trough_mass_kg = v->real[0],
                    .base_mass_kg = v->real[1],
                    .trough_inertia_kgm2 = v->real[2],
                    .base_inertia_kgm2 = v->real[3],
                    .spring_angle_rad = v->real[4],
                    .base_com_m = {v->real[5], v->real[6]},
                    .trough_com_m = {v->real[7], v->real[8]},
                    .mount_3_m = {v->real[9], v->real[10]},
                    .mount_4_m = {v->real[11], v->real[12]},
                    .spring_stiffness_n_m = v->real[13],
                    .mount_stiffness_x_n_m = v->real[14],
                    .mount_stiffness_y_n_m = v->real[15],
                    .spring_damping_ns_m = v->real[16],
                    .mount_damping_x_ns_m = v->real[17],
                    .mount_damping_y_ns_m = v->real[18],
                    .m14 = v->choice[0]};
}

/* One of B (Eq. 56) and K (Eq. 57): the same form with (beta, beta_x, beta_y) or (k, k_x, k_y).
 *   c11 = 2 c;  c22 = 2 cx;  c33 = 2 cy
 *   c24 = cx [(yB - y3) + (yB - y4)];  c34 = cy [(x3 - xB) + (x4 - xB)]
 *   c44 = cx [(yB - y3)^2 + (yB - y4)^2] + cy [(x3 - xB)^2 + (x4 - xB)^2] */
static void mounts_matrix(const conveyor *v, const double c[3],
                          double out[VS_MOST_DOF][VS_MOST_DOF]) {
  double y3 = v->base_com_m[1] - v->mount_3_m[1], y4 = v->base_com_m[1] - v->mount_4_m[1];
  double x3 = v->mount_3_m[0] - v->base_com_m[0], x4 = v->mount_4_m[0] - v->base_com_m[0];
  out[P][P] = 2 * c[0];
  out[U][U] = 2 * c[1];
  out[W][W] = 2 * c[2];
  out[U][PHI] = out[PHI][U] = c[1] * (y3 + y4);
  out[W][PHI] = out[PHI][W] = c[2] * (x3 + x4);
  out[PHI][PHI] = c[1] * (y3 * y3 + y4 * y4) + c[2] * (x3 * x3 + x4 * x4);
}

/* M of Eq. 55, with m34 = m_K (x_C - x_B) (the paper prints x_K there) and with the mass of the
 * loaded trough, m_k = m_k0 + lambda_t rho V_k (Eq. 88). */
static void mass_matrix(const conveyor *v, vs_model *model) {
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
  for (int i = 0; i < VS_DOF; i++)
    for (int j = 0; j < VS_DOF; j++) model->mass[i][j] = m[i][j];
}

/* Packs the first dof rows and columns of a matrix, for GSL. */
static void pack(const vs_model *model, double m[VS_MOST_DOF][VS_MOST_DOF], double *out) {
  for (int i = 0; i < model->dof; i++)
    for (int j = 0; j < model->dof; j++) out[i * model->dof + j] = m[i][j];
}

/* M^-1 B, M^-1 K, -M^-1 c and M^-1 f0 by Cholesky, which fails just when M is not positive
 * definite. */
static vs_status solve_mass(vs_model *model, vs_error *err) {
  double m[VS_MOST_DOF * VS_MOST_DOF], column[VS_MOST_DOF];
  size_t n = (size_t)model->dof;
  pack(model, model->mass, m);
  gsl_matrix_view mv = gsl_matrix_view_array(m, n, n);
  gsl_vector_view cv = gsl_vector_view_array(column, n);
  if (gsl_linalg_cholesky_decomp1(&mv.matrix) != GSL_SUCCESS)
    return vs_fail(err, VS_INPUT,
                   "machine: the inertia matrix M (Eq. 55) is not positive definite; check masses, "
                   "inertias and centres of mass");
  for (int j = 0; j < 2 * model->dof + 2; j++) {
    int of_k = j - model->dof, other = j - 2 * model->dof;
    double *into = other == 1   ? model->m0
                   : other == 0 ? model->mf
                   : of_k >= 0  ? model->mk_column[of_k]
                                : model->mb_column[j];
    for (int i = 0; i < model->dof; i++)
      column[i] = other == 1   ? model->constant[i]
                  : other == 0 ? -model->along[i]
                  : of_k >= 0  ? model->stiffness[i][of_k]
                               : model->damping[i][j];
    gsl_linalg_cholesky_svx(&mv.matrix, &cv.vector);
    memcpy(into, column, n * sizeof *column);
  }
  return VS_OK;
}

/* Sylvester's criterion (after Eq. 57) by Cholesky: without it the rest position is not stable. */
static vs_status check_stiffness(vs_model *model, vs_error *err) {
  double k[VS_MOST_DOF * VS_MOST_DOF];
  size_t n = (size_t)model->dof;
  pack(model, model->stiffness, k);
  gsl_matrix_view kv = gsl_matrix_view_array(k, n, n);
  bool positive = gsl_linalg_cholesky_decomp1(&kv.matrix) == GSL_SUCCESS;
  for (size_t i = 0; positive && i < n; i++) /* of a smaller pivot only rounding is left */
    positive = pow(gsl_matrix_get(&kv.matrix, i, i), 2) > 1e-14 * model->stiffness[i][i];
  double x[VS_MOST_DOF];
  gsl_vector_view xv = gsl_vector_view_array(x, n);
  memcpy(x, model->along, n * sizeof *x);
  if (positive) gsl_linalg_cholesky_svx(&kv.matrix, &xv.vector);
  model->compliance_m_n = positive ? vs_mechanics_travel(model, x) : INFINITY;
  return positive
             ? VS_OK
             : vs_fail(err, VS_INPUT,
                       "machine: the stiffness matrix K (Eq. 57) is not positive definite; check "
                       "the mounts' stiffness and where mount_3, mount_4 and base_com lie");
}

/* What follows from the modes, for step lengths. */
static vs_status find_speeds(vs_model *model, vs_error *err) {
  vs_mode modes[VS_MOST_STATES];
  if (!vs_mechanics_modes(model, modes))
    return vs_fail(err, VS_INPUT, "machine: the eigenvalues of the mechanics cannot be found");
  double drive = 0;
  for (int m = 0; m < 2 * model->dof; m++) {
    double size = hypot(modes[m].re_1_s, modes[m].im_rad_s);
    if (size > model->fastest_rad_s) model->fastest_rad_s = size;
    if (modes[m].drive > drive) {
      drive = modes[m].drive;
      model->working_rad_s = size;
    }
  }
  model->contact_rad_s = model->fastest_rad_s;
  for (int k = 0; k < model->stops.count; k++) {
    const vs_stop *stop = &model->stops.item[k];
    double per_newton = fabs(model->per_newton_m_s2);
    double rad_s = model->fastest_rad_s + sqrt(stop->kind->steepest(stop) * per_newton) +
                   stop->damping_ns_m * per_newton;
    model->contact_rad_s = fmax(model->contact_rad_s, rad_s);
  }
  return VS_OK;
}

vs_status vs_build_model(const vs_node *scene, vs_model *model, vs_error *err) {
  *model = (vs_model){.machine = &vs_machine_conveyor, .dof = vs_machine_conveyor.dof};
  size_t found = vs_error_count(err);
  vs_status s = vs_field_section_read(&model->machine->section, vs_tree_child(scene, "machine"),
                                      &model->parameters, err);
  if (!s)
    s = vs_field_section_read(&vs_actuator_section, vs_tree_child(scene, "actuator"),
                              &model->actuator, err);
  if (!s)
    s = vs_field_section_read(&vs_model_load_section, vs_tree_child(scene, "load"), &model->load,
                              err);
  if (s || vs_error_count(err) > found) return s;
  const conveyor c = conveyor_of(&model->parameters), *v = &c;
  const double b[3] = {v->spring_damping_ns_m, v->mount_damping_x_ns_m, v->mount_damping_y_ns_m};
  const double k[3] = {v->spring_stiffness_n_m, v->mount_stiffness_x_n_m, v->mount_stiffness_y_n_m};
  model->along[P] = 1;
  mounts_matrix(v, b, model->damping);
  mounts_matrix(v, k, model->stiffness);
  mass_matrix(v, model);
  s = vs_actuator_build(&model->actuator, vs_tree_child(scene, "actuator"), NULL, &model->coil,
                        &model->stops, err);
  if (!s) s = solve_mass(model, err);
  if (!s) s = check_stiffness(model, err);
  for (int i = 0; i < model->dof; i++) model->per_newton_m_s2 += model->along[i] * model->mf[i];
  const vs_stop *first = model->stops.item;
  model->plain =
      model->coil.square &&
      (!model->stops.count || (model->stops.count == 1 && first->kind->linear && first->side > 0));
  return s ? s : find_speeds(model, err);
}
