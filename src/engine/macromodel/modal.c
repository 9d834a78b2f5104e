/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macromodel/modal.h"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_linalg.h>

/* The shares are V^-1 x, with the modes as the columns of V. */
void vs_modal_shares(const vs_modal *modal, const double x[VS_MOST_STATES],
                     double share[VS_MOST_STATES]) {
  size_t states = modal->share->size;
  for (size_t n = 0; n < states; n++)
    gsl_vector_complex_set(modal->share, n, gsl_complex_rect(x[n], 0));
  gsl_linalg_complex_LU_svx(modal->vectors, modal->order, modal->share);
  for (size_t n = 0; n < states; n++)
    share[n] = gsl_complex_abs(gsl_vector_complex_get(modal->share, n));
}

bool vs_modal_begin(vs_modal *modal, const vs_model *model) {
  size_t dof = (size_t)model->dof, states = 2 * dof;
  int sign;
  modal->vectors = vs_checked(gsl_matrix_complex_alloc(states, states));
  modal->order = vs_checked(gsl_permutation_alloc(states));
  modal->share = vs_checked(gsl_vector_complex_alloc(states));
  if (!vs_mechanics_modes(model, modal->mode)) return false;
  for (size_t k = 0; k < states; k++)
    for (size_t n = 0; n < dof; n++) {
      const vs_mode *m = &modal->mode[k];
      gsl_complex shape = gsl_complex_rect(m->shape_re[n], m->shape_im[n]);
      gsl_matrix_complex_set(modal->vectors, n, k, shape);
      gsl_matrix_complex_set(modal->vectors, dof + n, k,
                             gsl_complex_mul(gsl_complex_rect(m->re_1_s, m->im_rad_s), shape));
    }
  gsl_linalg_complex_LU_decomp(modal->vectors, modal->order, &sign);
  return gsl_complex_abs(gsl_linalg_complex_LU_det(modal->vectors, sign)) > 0;
}

void vs_modal_end(vs_modal *modal) {
  gsl_matrix_complex_free(modal->vectors);
  gsl_permutation_free(modal->order);
  gsl_vector_complex_free(modal->share);
}
