/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ideal/glide.h"

#include <gsl/gsl_linalg.h>
#include <math.h>

/* What the sum of the modes may miss of the knot's state, relative to the sum of their sizes. */
static const double MISSED = 1e-9;
/* By which factor the bounds are larger than the sums of the modes' sizes. It covers MISSED and
 * what the dense output of the steps that are left out may be off by (phases.c). */
static const double WIDER = 1 + 1e-6;

/* Where constant forces and springs hold the balance: K middle = f0. False: nowhere. */
static bool find_middle(const vs_model *m, double middle[VS_MOST_DOF]) {
  double k[VS_MOST_DOF * VS_MOST_DOF], scale = 0;
  size_t n = (size_t)m->dof;
  memset(middle, 0, VS_MOST_DOF * sizeof *middle);
  if (!m->loaded) return true;
  for (int i = 0; i < m->dof; i++) {
    middle[i] = m->constant[i];
    scale = fmax(scale, fabs(m->constant[i]));
    for (int j = 0; j < m->dof; j++) k[i * m->dof + j] = m->stiffness[i][j];
  }
  gsl_matrix_view kv = gsl_matrix_view_array(k, n, n);
  gsl_vector_view v = gsl_vector_view_array(middle, n);
  if (gsl_linalg_HH_svx(&kv.matrix, &v.vector)) return false;
  for (int i = 0; i < m->dof; i++) {
    double left = m->constant[i];
    for (int j = 0; j < m->dof; j++) left -= m->stiffness[i][j] * middle[j];
    if (!(fabs(left) <= MISSED * scale)) return false;
  }
  return true;
}

/* With symmetric M, B and K each mode's shape f is also the left one, and
 *   share = f (f.(s M + B) q0 + f.M v0)/(f.(2 s M + B) f) */
static void find_share(vs_glide *g, int mode, const double *q0, const double *v0) {
  const vs_model *m = g->model;
  const vs_mode *of = &m->mode[mode];
  const double complex s = of->re_1_s + of->im_rad_s * I;
  double complex f[VS_MOST_DOF], sum = 0, norm = 0;
  for (int i = 0; i < m->dof; i++) f[i] = of->shape_re[i] + of->shape_im[i] * I;
  for (int i = 0; i < m->dof; i++)
    for (int j = 0; j < m->dof; j++) {
      const double complex both = s * m->mass[i][j] + m->damping[i][j];
      sum += f[i] * (both * q0[j] + m->mass[i][j] * v0[j]);
      norm += f[i] * (both + s * m->mass[i][j]) * f[j];
    }
  g->s[mode] = s;
  for (int i = 0; i < m->dof; i++) g->share[mode][i] = f[i] * (sum / norm);
}

/* Does the sum give the state back? */
static bool gives_back(const vs_glide *g, const double *q0, const double *v0) {
  const vs_model *m = g->model;
  for (int i = 0; i < m->dof; i++) {
    double complex q = -q0[i], v = -v0[i];
    double most_q = 0, most_v = 0;
    for (int k = 0; k < 2 * m->dof; k++) {
      const double complex rate = g->s[k] * g->share[k][i];
      q += g->share[k][i];
      v += rate;
      most_q += cabs(g->share[k][i]);
      most_v += cabs(rate);
    }
    if (!(cabs(q) <= MISSED * most_q) || !(cabs(v) <= MISSED * most_v)) return false;
  }
  return true;
}

bool vs_glide_make(const vs_model *m, const vs_knot *knot, vs_glide *g) {
  double q0[VS_MOST_DOF];
  const double *v0 = knot->x + m->dof;
  g->model = m;
  g->began_s = knot->t_s;
  if (!find_middle(m, g->middle)) return false;
  for (int i = 0; i < m->dof; i++) q0[i] = knot->x[i] - g->middle[i];
  for (int k = 0; k < 2 * m->dof; k++) find_share(g, k, q0, v0);
  return gives_back(g, q0, v0);
}

void vs_glide_rest(const vs_glide *g, double from_s, double to_s, vs_rest *rest) {
  const vs_model *m = g->model;
  *rest = (vs_rest){.from_s = from_s, .to_s = to_s};
  rest->travel.middle = vs_mechanics_travel(m, g->middle);
  for (int i = 0; i < m->dof; i++) rest->q[i].middle = g->middle[i];
  for (int k = 0; k < 2 * m->dof; k++) {
    const double rate = creal(g->s[k]), size = cabs(g->s[k]);
    const double left = exp(rate * ((rate > 0 ? to_s : from_s) - g->began_s)) * WIDER;
    double complex travel = 0;
    for (int i = 0; i < m->dof; i++) {
      const double way = left * cabs(g->share[k][i]);
      travel += m->along[i] * g->share[k][i];
      rest->q[i].way += way;
      rest->rate2[i] += size * size * way;
    }
    rest->travel.way += left * cabs(travel);
  }
}

bool vs_glide_is_clear(const vs_glide *g, const vs_rest *rest) {
  const vs_model *m = g->model;
  const double least = rest->travel.middle - rest->travel.way,
               most = rest->travel.middle + rest->travel.way;
  if (m->coil.law->beyond) return false;
  if (m->coil.law->poles && least <= -m->actuator.gap_m) return false;
  return vs_stops_nearness(&m->stops, least) < 1 && vs_stops_nearness(&m->stops, most) < 1;
}

/* (exp(x) - 1)/x */
static double complex mean_growth(double complex x) {
  if (cabs(x) < 1e-3) return 1 + x / 2 * (1 + x / 3 * (1 + x / 4 * (1 + x / 5)));
  return (cexp(x) - 1) / x;
}

/* q' = sum of w exp(s t), w being s share exp(s from), and the integral of each product follows:
 *   int q'.B q' = h sum over k, l of w_k.B w_l (exp(x) - 1)/x,  x = (s_k + s_l) h */
double vs_glide_lost(const vs_glide *g, double from_s, double to_s) {
  const vs_model *m = g->model;
  const double h = to_s - from_s;
  double complex w[VS_MOST_STATES][VS_MOST_DOF];
  double lost = 0;
  for (int k = 0; k < 2 * m->dof; k++) {
    const double complex now = g->s[k] * cexp(g->s[k] * (from_s - g->began_s));
    for (int i = 0; i < m->dof; i++) w[k][i] = now * g->share[k][i];
  }
  for (int k = 0; k < 2 * m->dof; k++)
    for (int l = 0; l <= k; l++) {
      double complex form = 0;
      for (int i = 0; i < m->dof; i++)
        for (int j = 0; j < m->dof; j++)
          if (m->damping[i][j] != 0) form += w[k][i] * m->damping[i][j] * w[l][j];
      lost += (l < k ? 2 : 1) * h * creal(form * mean_growth((g->s[k] + g->s[l]) * h));
    }
  return lost;
}
