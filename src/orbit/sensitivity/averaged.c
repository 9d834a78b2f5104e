/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "orbit/averaged.h"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>

enum { N = VS_LINEAR_STATES };

/* The modes of A in parts of each state's scale, and what B is made of. */
typedef struct modes {
  size_t n;
  double _Complex m[N], v[N][N], from_b[N]; /* v[i][k]: state i of the k-th; w_k B */
} modes;

static double _Complex of_gsl(gsl_complex z) {
  return GSL_REAL(z) + GSL_IMAG(z) * _Complex_I;
}

/* Solves V w = B. */
static bool solve_modes(modes *m, const vs_linear *l) {
  size_t order[N];
  int sign;
  gsl_matrix_complex *v = vs_checked(gsl_matrix_complex_alloc(m->n, m->n));
  gsl_vector_complex *b = vs_checked(gsl_vector_complex_alloc(m->n)),
                     *w = vs_checked(gsl_vector_complex_alloc(m->n));
  gsl_permutation p = {m->n, order};
  for (size_t i = 0; i < m->n; i++) {
    gsl_vector_complex_set(b, i, gsl_complex_rect(l->b[i] / l->scale[i], 0));
    for (size_t k = 0; k < m->n; k++)
      gsl_matrix_complex_set(v, i, k, gsl_complex_rect(creal(m->v[i][k]), cimag(m->v[i][k])));
  }
  bool good =
      !gsl_linalg_complex_LU_decomp(v, &p, &sign) && !gsl_linalg_complex_LU_solve(v, &p, b, w);
  for (size_t k = 0; k < m->n && good; k++) m->from_b[k] = of_gsl(gsl_vector_complex_get(w, k));
  gsl_vector_complex_free(w);
  gsl_vector_complex_free(b);
  gsl_matrix_complex_free(v);
  return good;
}

static bool stands_before(double _Complex a, double _Complex b) {
  const vs_multiplier left = {creal(a), cimag(a)}, right = {creal(b), cimag(b)};
  return vs_multiplier_order(&left, &right) < 0;
}

static bool find_modes(const vs_linear *l, modes *m) {
  m->n = (size_t)l->n;
  gsl_matrix *a = vs_checked(gsl_matrix_alloc(m->n, m->n));
  gsl_matrix_complex *v = vs_checked(gsl_matrix_complex_alloc(m->n, m->n));
  gsl_vector_complex *values = vs_checked(gsl_vector_complex_alloc(m->n));
  gsl_eigen_nonsymmv_workspace *work = vs_checked(gsl_eigen_nonsymmv_alloc(m->n));
  size_t place[N];
  for (size_t i = 0; i < m->n; i++)
    for (size_t j = 0; j < m->n; j++) {
      double part = l->a[i][j] * l->scale[j] / l->scale[i];
      gsl_matrix_set(a, i, j, fabs(part) < vs_multipliers_gone ? 0 : part);
    }
  bool good = !gsl_eigen_nonsymmv(a, values, v, work);
  for (size_t k = 0; k < m->n; k++) {
    size_t at = k;
    double _Complex z = of_gsl(gsl_vector_complex_get(values, k));
    for (; at && stands_before(z, m->m[at - 1]); at--) {
      m->m[at] = m->m[at - 1];
      place[at] = place[at - 1];
    }
    m->m[at] = z;
    place[at] = k;
  }
  for (size_t k = 0; k < m->n; k++)
    for (size_t i = 0; i < m->n; i++) m->v[i][k] = of_gsl(gsl_matrix_complex_get(v, i, place[k]));
  gsl_eigen_nonsymmv_free(work);
  gsl_vector_complex_free(values);
  gsl_matrix_complex_free(v);
  gsl_matrix_free(a);
  return good && solve_modes(m, l);
}

static vs_averaged_pole pole_of(double _Complex m, double period_s) {
  double re = log(cabs(m)) / period_s, im = carg(m) / period_s;
  return (vs_averaged_pole){.multiplier = {creal(m), cimag(m)},
                            .re_1_s = re,
                            .im_rad_s = im,
                            .frequency_hz = fabs(im) / (2 * M_PI),
                            .time_constant_s = -1 / re};
}

/* ---- an output ---- */

static bool is_pair(const vs_averaged *a, int k) {
  return k + 1 < a->n && a->pole[k].multiplier.im > 0;
}

/* The share of a pole, or of a pair together at its largest. */
static double size_of_share(const vs_averaged *a, int output, int k) {
  return (is_pair(a, k) ? 2 : 1) * cabs(a->share[output][k]);
}

/* What is left out by the dominant pole or pair alone is the sum of all other shares, which decay
 * from the first firing on. */
static double left_out(const vs_averaged *a, int output) {
  enum { LOOKS = 100000 };
  double _Complex now[N];
  int one = a->dominant[output];
  double most = 0, bound = INFINITY;
  for (int k = 0; k < a->n; k++)
    now[k] = k == one || (k == one + 1 && is_pair(a, one)) ? 0 : a->share[output][k];
  for (int n = 0; n < LOOKS && bound > most; n++) {
    double _Complex sum = 0;
    bound = 0;
    for (int k = 0; k < a->n; k++) {
      sum += now[k];
      bound += cabs(now[k]);
      now[k] *= a->pole[k].multiplier.re + a->pole[k].multiplier.im * _Complex_I;
    }
    most = fmax(most, fabs(creal(sum)));
  }
  return most / fabs(a->gain[output]);
}

static void take_output(const vs_linear *l, const modes *m, int output, vs_averaged *a) {
  int dominant = 0;
  a->at_once[output] = a->gain[output] = l->d[output];
  for (int k = 0; k < a->n; k++) {
    double _Complex cv = 0;
    for (int i = 0; i < a->n; i++) cv += l->c[output][i] * l->scale[i] * m->v[i][k];
    a->residue[output][k] = cv * m->from_b[k];
    a->share[output][k] = a->residue[output][k] / (1 - m->m[k]);
    a->gain[output] += creal(a->share[output][k]);
  }
  for (int k = 1; k < a->n; k++)
    if (a->pole[k].multiplier.im >= 0 &&
        size_of_share(a, output, k) > size_of_share(a, output, dominant))
      dominant = k;
  a->dominant[output] = dominant;
  a->left_out[output] = left_out(a, output);
}

/* ---- all of it ---- */

/* The gain without the modes tells whether these are known: their sum must not cancel. */
static bool does_gain_agree(const vs_averaged *a, const double gain[VS_LINEAR_OUTPUTS]) {
  for (int k = 0; k < a->outputs; k++)
    if (!(fabs(gain[k] - a->gain[k]) <= 1e-6 * (fabs(gain[k]) + fabs(a->at_once[k])))) return false;
  return true;
}

vs_status vs_averaged_find(const vs_linear *l, vs_averaged *a, vs_error *err) {
  modes *m = vs_alloc(1, sizeof *m);
  *a = (vs_averaged){.n = l->n, .outputs = l->outputs};
  double gain[VS_LINEAR_OUTPUTS];
  vs_status status = vs_linear_gain(l, gain, err);
  bool good = !status && find_modes(l, m);
  for (int k = 0; k < a->n; k++) a->pole[k] = pole_of(m->m[k], l->period_s);
  for (int k = 0; k < a->outputs && good; k++) take_output(l, m, k, a);
  free(m);
  if (status) return status;
  return good && does_gain_agree(a, gain)
             ? VS_OK
             : vs_fail(err, VS_RUN,
                       "the poles of the linear model cannot be told apart, so that there is no "
                       "averaged model");
}

double vs_averaged_step(const vs_averaged *a, int output, int k) {
  double y = a->gain[output];
  for (int i = 0; i < a->n; i++) {
    double _Complex m = a->pole[i].multiplier.re + a->pole[i].multiplier.im * _Complex_I;
    y -= creal(a->share[output][i] * cpow(m, k));
  }
  return y;
}
