/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "machine/mechanics.h"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void vs_mechanics_hold_p(const vs_model *model, double rate[VS_DOF]) {
  double force = rate[P] / model->mf[P];
  for (int i = 0; i < VS_DOF; i++) rate[i] -= model->mf[i] * force;
  rate[P] = 0;
}

static double quadratic_form(const double m[VS_DOF][VS_DOF], const double v[VS_DOF]) {
  double sum = 0;
  for (int i = 0; i < VS_DOF; i++)
    for (int j = 0; j < VS_DOF; j++) sum += v[i] * m[i][j] * v[j];
  return sum;
}

double vs_mechanics_kinetic_energy(const vs_model *model, const double x[VS_STATES]) {
  return quadratic_form(model->mass, x + VS_DOF) / 2;
}

double vs_mechanics_elastic_energy(const vs_model *model, const double x[VS_STATES]) {
  return quadratic_form(model->stiffness, x) / 2;
}

void vs_mechanics_state_space(const vs_model *model, vs_state_space *out) {
  *out = (vs_state_space){0};
  double inverse[VS_DOF * VS_DOF];
  memcpy(inverse, model->mass, sizeof inverse);
  gsl_matrix_view mv = gsl_matrix_view_array(inverse, VS_DOF, VS_DOF);
  gsl_linalg_cholesky_decomp1(&mv.matrix); /* it works, or vs_build_model would have refused M */
  gsl_linalg_cholesky_invert(&mv.matrix);
  for (int i = 0; i < VS_DOF; i++) {
    for (int j = 0; j < VS_DOF; j++) {
      out->a[i][j] = -model->mb_column[j][i];
      out->a[i][VS_DOF + j] = -model->mk_column[j][i];
      out->b[i][j] = inverse[VS_DOF * i + j];
    }
    out->a[VS_DOF + i][i] = 1;
    out->c[i][VS_DOF + i] = 1;
  }
}

static int by_frequency(const void *left, const void *right) {
  const vs_mode *a = left, *b = right;
  double da = hypot(a->re_1_s, a->im_rad_s), db = hypot(b->re_1_s, b->im_rad_s);
  if (fabs(da - db) > 1e-9 * (da + db)) return da < db ? -1 : 1;
  return (a->im_rad_s < b->im_rad_s) - (a->im_rad_s > b->im_rad_s);
}

/* Shares of the modes in p(t) = sum share_m exp(s_m t) after p, q = 0, q' = M^-1 (-1,0,0,0):
 * share_m = (row p of eigenvectors V) (V^-1 x0)_m. */
static bool find_drive(const vs_model *model, const gsl_matrix_complex *vectors,
                       double drive[VS_STATES]) {
  gsl_matrix_complex *lu = gsl_matrix_complex_alloc(VS_STATES, VS_STATES);
  gsl_vector_complex *x0 = gsl_vector_complex_calloc(VS_STATES);
  gsl_permutation *perm = gsl_permutation_alloc(VS_STATES);
  int sign;
  gsl_matrix_complex_memcpy(lu, vectors);
  for (size_t i = 0; i < VS_DOF; i++)
    gsl_vector_complex_set(x0, i, gsl_complex_rect(model->mf[i], 0));
  bool good = !gsl_linalg_complex_LU_decomp(lu, perm, &sign) &&
              !gsl_linalg_complex_LU_svx(lu, perm, x0); /* fails for a defective matrix */
  for (size_t m = 0; m < VS_STATES; m++)
    drive[m] = good
                   ? gsl_complex_abs(gsl_complex_mul(gsl_matrix_complex_get(vectors, VS_DOF + P, m),
                                                     gsl_vector_complex_get(x0, m)))
                   : 0;
  gsl_permutation_free(perm);
  gsl_vector_complex_free(x0);
  gsl_matrix_complex_free(lu);
  return good;
}

bool vs_mechanics_modes(const vs_model *model, vs_mode modes[VS_STATES]) {
  vs_state_space space;
  vs_mechanics_state_space(model, &space);
  gsl_matrix_view a = gsl_matrix_view_array(&space.a[0][0], VS_STATES, VS_STATES);
  gsl_vector_complex *values = gsl_vector_complex_alloc(VS_STATES);
  gsl_matrix_complex *vectors = gsl_matrix_complex_alloc(VS_STATES, VS_STATES);
  gsl_eigen_nonsymmv_workspace *work = gsl_eigen_nonsymmv_alloc(VS_STATES);
  gsl_eigen_nonsymmv_params(1, work); /* balance: q' and q differ by orders of magnitude */
  bool good = gsl_eigen_nonsymmv(&a.matrix, values, vectors, work) == 0;
  double drive[VS_STATES];
  if (good) find_drive(model, vectors, drive);
  for (size_t m = 0; good && m < VS_STATES; m++) {
    gsl_complex s = gsl_vector_complex_get(values, m);
    vs_mode *mode = &modes[m];
    double size = gsl_complex_abs(s);
    *mode = (vs_mode){.re_1_s = GSL_REAL(s), .im_rad_s = GSL_IMAG(s), .drive = drive[m]};
    mode->frequency_hz = size / (2 * M_PI);
    mode->time_constant_s = mode->re_1_s < 0 ? -1 / mode->re_1_s : INFINITY;
    mode->damping_ratio = size > 0 ? -mode->re_1_s / size : 0;
    gsl_complex largest = gsl_matrix_complex_get(vectors, VS_DOF, m);
    for (size_t i = 1; i < VS_DOF; i++) {
      gsl_complex v = gsl_matrix_complex_get(vectors, VS_DOF + i, m);
      if (gsl_complex_abs(v) > gsl_complex_abs(largest)) largest = v;
    }
    for (size_t i = 0; i < VS_DOF; i++) {
      gsl_complex v = gsl_complex_div(gsl_matrix_complex_get(vectors, VS_DOF + i, m), largest);
      mode->shape_re[i] = GSL_REAL(v);
      mode->shape_im[i] = GSL_IMAG(v);
    }
  }
  if (good) qsort(modes, VS_STATES, sizeof *modes, by_frequency);
  gsl_eigen_nonsymmv_free(work);
  gsl_matrix_complex_free(vectors);
  gsl_vector_complex_free(values);
  return good;
}
