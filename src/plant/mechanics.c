/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/mechanics.h"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

const char *vs_mechanics_travel_name(const vs_model *m) {
  return m->alone ? m->machine->coordinates[m->alone - 1].name : "travel";
}

void vs_mechanics_hold(const vs_model *model, double rate[VS_MOST_DOF]) {
  double force = vs_mechanics_travel(model, rate) / model->per_newton_m_s2;
  for (int i = 0; i < model->dof; i++) rate[i] -= model->mf[i] * force;
  int sole = -1, n = 0; /* the one coordinate that opens the gap, if it is one: exactly 0 */
  for (int i = 0; i < model->dof; i++)
    if (model->along[i] != 0) sole = i, n++;
  if (n == 1) rate[sole] = 0;
}

static double quadratic_form(const vs_model *model, const double *m, const double *v) {
  double sum = 0;
  for (int i = 0; i < model->dof; i++)
    for (int j = 0; j < model->dof; j++) sum += v[i] * m[VS_MOST_DOF * i + j] * v[j];
  return sum;
}

double vs_mechanics_kinetic_energy(const vs_model *model, const double *v) {
  return quadratic_form(model, &model->mass[0][0], v) / 2;
}

double vs_mechanics_elastic_energy(const vs_model *model, const double *q) {
  double sum = quadratic_form(model, &model->stiffness[0][0], q) / 2;
  for (int i = 0; model->loaded && i < model->dof; i++) sum -= model->constant[i] * q[i];
  return sum;
}

void vs_mechanics_state_space(const vs_model *model, vs_state_space *out) {
  *out = (vs_state_space){0};
  int dof = model->dof;
  double inverse[VS_MOST_DOF * VS_MOST_DOF];
  for (int i = 0; i < dof; i++)
    for (int j = 0; j < dof; j++) inverse[dof * i + j] = model->mass[i][j];
  gsl_matrix_view mv = gsl_matrix_view_array(inverse, (size_t)dof, (size_t)dof);
  gsl_linalg_cholesky_decomp1(&mv.matrix); /* it works, or vs_build_model would have refused M */
  gsl_linalg_cholesky_invert(&mv.matrix);
  for (int i = 0; i < dof; i++) {
    for (int j = 0; j < dof; j++) {
      out->a[i][j] = -model->mb_column[j][i];
      out->a[i][dof + j] = -model->mk_column[j][i];
      out->b[i][j] = inverse[dof * i + j];
    }
    out->a[dof + i][i] = 1;
    out->c[i][dof + i] = 1;
  }
}

static int by_frequency(const void *left, const void *right) {
  const vs_mode *a = left, *b = right;
  double da = hypot(a->re_1_s, a->im_rad_s), db = hypot(b->re_1_s, b->im_rad_s);
  if (fabs(da - db) > 1e-9 * (da + db)) return da < db ? -1 : 1;
  return (a->im_rad_s < b->im_rad_s) - (a->im_rad_s > b->im_rad_s);
}

/* Shares of the modes in g(t) = c.q(t) = sum share_m exp(s_m t) after q = 0, q' = -M^-1 c:
 * share_m = (c times the rows of q of the eigenvectors V) (V^-1 x0)_m. */
static bool find_drive(const vs_model *model, const gsl_matrix_complex *vectors,
                       double drive[VS_MOST_STATES]) {
  size_t n = (size_t)model->dof;
  gsl_matrix_complex *lu = vs_checked(gsl_matrix_complex_alloc(2 * n, 2 * n));
  gsl_vector_complex *x0 = vs_checked(gsl_vector_complex_calloc(2 * n));
  gsl_permutation *perm = vs_checked(gsl_permutation_alloc(2 * n));
  int sign;
  gsl_matrix_complex_memcpy(lu, vectors);
  for (size_t i = 0; i < n; i++) gsl_vector_complex_set(x0, i, gsl_complex_rect(model->mf[i], 0));
  bool good = !gsl_linalg_complex_LU_decomp(lu, perm, &sign) &&
              !gsl_linalg_complex_LU_svx(lu, perm, x0); /* fails for a defective matrix */
  for (size_t m = 0; m < 2 * n; m++) {
    gsl_complex row = gsl_complex_mul_real(gsl_matrix_complex_get(vectors, n, m), model->along[0]);
    for (size_t i = 1; i < n; i++)
      row = gsl_complex_add(
          row, gsl_complex_mul_real(gsl_matrix_complex_get(vectors, n + i, m), model->along[i]));
    drive[m] = good ? gsl_complex_abs(gsl_complex_mul(row, gsl_vector_complex_get(x0, m))) : 0;
  }
  gsl_permutation_free(perm);
  gsl_vector_complex_free(x0);
  gsl_matrix_complex_free(lu);
  return good;
}

bool vs_mechanics_modes(const vs_model *model, vs_mode modes[VS_MOST_STATES]) {
  size_t n = (size_t)model->dof, states = 2 * n;
  vs_state_space space;
  vs_mechanics_state_space(model, &space);
  gsl_matrix_view a =
      gsl_matrix_view_array_with_tda(&space.a[0][0], states, states, VS_MOST_STATES);
  gsl_vector_complex *values = vs_checked(gsl_vector_complex_alloc(states));
  gsl_matrix_complex *vectors = vs_checked(gsl_matrix_complex_alloc(states, states));
  gsl_eigen_nonsymmv_workspace *work = vs_checked(gsl_eigen_nonsymmv_alloc(states));
  gsl_eigen_nonsymmv_params(1, work); /* balance: q' and q differ by orders of magnitude */
  bool good = gsl_eigen_nonsymmv(&a.matrix, values, vectors, work) == 0;
  double drive[VS_MOST_STATES];
  if (good) find_drive(model, vectors, drive);
  for (size_t m = 0; good && m < states; m++) {
    gsl_complex s = gsl_vector_complex_get(values, m);
    vs_mode *mode = &modes[m];
    double size = gsl_complex_abs(s);
    *mode = (vs_mode){.re_1_s = GSL_REAL(s), .im_rad_s = GSL_IMAG(s), .drive = drive[m]};
    mode->frequency_hz = size / (2 * M_PI);
    mode->time_constant_s = mode->re_1_s < 0 ? -1 / mode->re_1_s : INFINITY;
    mode->damping_ratio = size > 0 ? -mode->re_1_s / size : 0;
    gsl_complex largest = gsl_matrix_complex_get(vectors, n, m);
    for (size_t i = 1; i < n; i++) {
      gsl_complex v = gsl_matrix_complex_get(vectors, n + i, m);
      if (gsl_complex_abs(v) > gsl_complex_abs(largest)) largest = v;
    }
    for (size_t i = 0; i < n; i++) {
      gsl_complex v = gsl_complex_div(gsl_matrix_complex_get(vectors, n + i, m), largest);
      mode->shape_re[i] = GSL_REAL(v);
      mode->shape_im[i] = GSL_IMAG(v);
    }
  }
  if (good) qsort(modes, states, sizeof *modes, by_frequency);
  gsl_eigen_nonsymmv_free(work);
  gsl_matrix_complex_free(vectors);
  gsl_vector_complex_free(values);
  return good;
}
