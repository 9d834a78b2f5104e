/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "floquet.h"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

#include "plant/coil.h"

typedef struct map {
  const scheme *scheme;
  const vs_model *model;
  const vs_timeline *timeline;
  long n;
  double scale[VS_STATES]; /* of (q, q') */
  double mean;             /* of F/z, while one period is shown */
  double p_min_m, p_max_m;
} map;

static const vs_mode *working_mode(const vs_mode modes[VS_STATES]) {
  const vs_mode *best = &modes[0];
  for (int k = 1; k < VS_STATES; k++)
    if (modes[k].drive * modes[k].frequency_hz > best->drive * best->frequency_hz) best = &modes[k];
  return best;
}

double floquet_mass(const vs_model *model) {
  vs_mode modes[VS_MOST_STATES];
  if (!vs_mechanics_modes(model, modes)) return NAN;
  const vs_mode *w = working_mode(modes);
  return 1 / (2 * w->drive * 2 * M_PI * w->frequency_hz);
}

/* F/z by the trapezoidal rule: the integrand is zero at both ends of the period. */
static void add(void *ctx, const vs_knot *from, const vs_knot *to) {
  map *m = ctx;
  double f0 =
      vs_coil_force(&m->model->coil, from->flux_wb, NAN) / conveyor_gap(m->model, from->x[P]);
  double f1 = vs_coil_force(&m->model->coil, to->flux_wb, NAN) / conveyor_gap(m->model, to->x[P]);
  m->mean += (to->t_s - from->t_s) * (f0 + f1) / 2 / m->timeline->period_s;
}

/* One period from x; false: it did not come to its end. */
static bool period(map *m, const double x[VS_STATES], double y[VS_STATES], bool look) {
  cosim c;
  cosim_begin(&c, m->scheme, m->model, m->timeline, m->timeline->period_s / (double)m->n);
  cosim_place(&c, x);
  if (look) c.show = add, c.ctx = m;
  bool good = cosim_run(&c, m->timeline->period_s) && !c.now.on;
  memcpy(y, c.now.x, sizeof c.now.x);
  m->p_min_m = c.p_min_m;
  m->p_max_m = c.p_max_m;
  cosim_end(&c);
  return good;
}

/* The map's derivative at x by central differences, in the scaled coordinates. */
static bool derivative(map *m, const double x[VS_STATES], gsl_matrix *j) {
  static const double PART = 1e-4; /* of the scale */
  for (size_t k = 0; k < VS_STATES; k++) {
    double side[2][VS_STATES], from[VS_STATES];
    for (int s = 0; s < 2; s++) {
      memcpy(from, x, sizeof from);
      from[k] += (s ? PART : -PART) * m->scale[k];
      if (!period(m, from, side[s], false)) return false;
    }
    for (size_t i = 0; i < VS_STATES; i++)
      gsl_matrix_set(j, i, k, (side[1][i] - side[0][i]) / (2 * PART * m->scale[i]));
  }
  return true;
}

/* x - (J - 1)^-1 (map(x) - x); gives the largest change, in scaled coordinates. NAN: none. */
static double newton(map *m, double x[VS_STATES], gsl_matrix *j) {
  double y[VS_STATES], residual[VS_STATES], largest = 0;
  if (!period(m, x, y, false) || !derivative(m, x, j)) return NAN;
  for (int i = 0; i < VS_STATES; i++) residual[i] = -(y[i] - x[i]) / m->scale[i];
  gsl_matrix *lu = gsl_matrix_alloc(VS_STATES, VS_STATES);
  gsl_permutation *p = gsl_permutation_alloc(VS_STATES);
  gsl_vector_view r = gsl_vector_view_array(residual, VS_STATES);
  int sign;
  gsl_matrix_memcpy(lu, j);
  for (size_t i = 0; i < VS_STATES; i++) gsl_matrix_set(lu, i, i, gsl_matrix_get(j, i, i) - 1);
  bool good = !gsl_linalg_LU_decomp(lu, p, &sign) && !gsl_linalg_LU_svx(lu, p, &r.vector);
  for (int i = 0; i < VS_STATES && good; i++) {
    x[i] += m->scale[i] * residual[i];
    largest = fmax(largest, fabs(residual[i]));
  }
  gsl_permutation_free(p);
  gsl_matrix_free(lu);
  return good ? largest : NAN;
}

/* The multiplier whose mode has most part in p: the product of its shape there and of what of it a
 * push on p wakes. */
static bool find_multiplier(gsl_matrix *j, orbit *o) {
  gsl_vector_complex *values = gsl_vector_complex_alloc(VS_STATES);
  gsl_matrix_complex *v = gsl_matrix_complex_alloc(VS_STATES, VS_STATES);
  gsl_matrix_complex *lu = gsl_matrix_complex_alloc(VS_STATES, VS_STATES);
  gsl_matrix_complex *inverse = gsl_matrix_complex_alloc(VS_STATES, VS_STATES);
  gsl_permutation *p = gsl_permutation_alloc(VS_STATES);
  gsl_eigen_nonsymmv_workspace *work = gsl_eigen_nonsymmv_alloc(VS_STATES);
  int sign;
  bool good = !gsl_eigen_nonsymmv(j, values, v, work);
  gsl_matrix_complex_memcpy(lu, v);
  good = good && !gsl_linalg_complex_LU_decomp(lu, p, &sign) &&
         !gsl_linalg_complex_LU_invert(lu, p, inverse);
  double most = -1;
  o->largest = 0;
  for (size_t k = 0; k < VS_STATES && good; k++) {
    double part = 0;
    o->largest = fmax(o->largest, gsl_complex_abs(gsl_vector_complex_get(values, k)));
    for (size_t i = P; i < VS_STATES; i += VS_DOF)
      part += gsl_complex_abs(
          gsl_complex_mul(gsl_matrix_complex_get(v, i, k), gsl_matrix_complex_get(inverse, k, i)));
    if (part <= most) continue;
    most = part;
    o->multiplier = gsl_complex_abs(gsl_vector_complex_get(values, k));
    o->angle_rad = fabs(gsl_complex_arg(gsl_vector_complex_get(values, k)));
  }
  gsl_eigen_nonsymmv_free(work);
  gsl_permutation_free(p);
  gsl_matrix_complex_free(inverse);
  gsl_matrix_complex_free(lu);
  gsl_matrix_complex_free(v);
  gsl_vector_complex_free(values);
  return good;
}

bool floquet_orbit(const scheme *s, const vs_model *model, const vs_timeline *timeline, long n,
                   orbit *o) {
  map m = {.scheme = s, .model = model, .timeline = timeline, .n = n};
  double x[VS_STATES], y[VS_STATES], change = INFINITY;
  for (int i = 0; i < VS_DOF; i++) {
    m.scale[i] = 1e-3 * (i == PHI ? 10 : 1);
    m.scale[VS_DOF + i] = m.scale[i] * model->working_rad_s;
  }
  memcpy(x, o->x, sizeof x);
  gsl_matrix *j = gsl_matrix_alloc(VS_STATES, VS_STATES);
  for (int k = 0; k < 30 && change > 1e-9; k++) change = newton(&m, x, j);
  bool good = change <= 1e-9 && find_multiplier(j, o) && period(&m, x, y, true);
  gsl_matrix_free(j);
  if (!good) return false;
  memcpy(o->x, x, sizeof x);
  o->damping_ns_m = -2 * floquet_mass(model) * log(o->multiplier) / timeline->period_s;
  o->force_over_z_n_m = m.mean;
  o->p_min_m = m.p_min_m;
  o->p_max_m = m.p_max_m;
  return true;
}
