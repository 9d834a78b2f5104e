/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "control/sampled_system.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "engine/channel.h"

/* ---- what an instrument measures ---- */

/* Fills row, of_force and constant of q" of that coordinate (Eq. 83). */
static void measure_acceleration(const vs_model *m, int coordinate, vs_sensor *s) {
  for (int j = 0; j < m->dof; j++) {
    s->row[j] = -m->mk_column[j][coordinate];
    s->row[m->dof + j] = -m->mb_column[j][coordinate];
  }
  s->of_force = m->mf[coordinate];
  s->constant = m->loaded ? m->m0[coordinate] : 0;
}

/* Fills row, of_force and constant. Returns false where the channel is not linear in these. */
static bool measure_channel(const vs_model *m, int channel, vs_sensor *s) {
  int of_motion = channel - VS_CH_Q;
  *s = (vs_sensor){0};
  if (channel == VS_CH_Z) {
    memcpy(s->row, m->along, (size_t)m->dof * sizeof *s->row);
    s->constant = m->coil.gap_rest_m;
    return true;
  }
  if (of_motion < 0 || of_motion >= 3 * m->dof) return false;
  if (of_motion < 2 * m->dof)
    s->row[of_motion] = 1;
  else
    measure_acceleration(m, of_motion - 2 * m->dof, s);
  return true;
}

bool vs_sampled_system_takes(const vs_model *model, const vs_instrument *instrument) {
  vs_sensor s;
  return measure_channel(model, instrument->channel, &s);
}

static void add_sensor(vs_sampled_system *p, const vs_model *m, const vs_instrument *i) {
  const double falls[VS_LOWPASS_TERMS] = {1, -1}, rises[VS_LOWPASS_TERMS] = {0, 1};
  vs_sensor *s = &p->sensor[p->sensors++];
  measure_channel(m, i->channel, s);
  s->instrument = i;
  for (int k = 0; k < 2; k++) s->range[k] = i->v.range[k] / vs_units_factor(i->unit);
  s->lowpass = vs_lowpass_make(i->v.bandwidth_hz, i->v.order, i->v.damping);
  s->states = s->lowpass.rate > 0 ? i->v.order : 0;
  s->at = p->states;
  p->states += s->states;
  for (int k = 0; k < 2 && s->states; k++) {
    vs_lowpass moved = s->lowpass;
    vs_lowpass_advance(&moved, p->period_s, k ? rises : falls);
    memcpy(s->response[k], moved.x, sizeof moved.x);
  }
}

/* ---- scales ---- */

static void set_scales(vs_sampled_system *p, const vs_model *m) {
  p->rad_s = m->fastest_rad_s > 0 ? m->fastest_rad_s : 1 / p->period_s;
  for (int i = 0; i < m->dof; i++) {
    p->scale[m->dof + i] = 1 / sqrt(m->mass[i][i]);
    p->scale[i] = p->scale[m->dof + i] / p->rad_s;
  }
  for (int k = 0; k < p->sensors; k++) {
    const vs_sensor *s = &p->sensor[k];
    double sum = 0;
    for (int j = 0; j < 2 * m->dof; j++) sum += pow(s->row[j] * p->scale[j], 2);
    p->y_scale[k] = sum > 0 ? sqrt(sum) : 1; /* a free mass has no acceleration of its own */
    for (int j = 0; j < s->states; j++) p->scale[s->at + j] = p->y_scale[k];
  }
}

/* ---- the exponential ---- */

/* The columns behind those of x: F, by how much F rises in one period, and 1. */
enum { FORCE, RISE, ONE, INPUTS };

static void fill_motion_matrix(gsl_matrix *g, const vs_model *m) {
  size_t dof = (size_t)m->dof, inputs = g->size1 - INPUTS;
  for (size_t i = 0; i < dof; i++) {
    gsl_matrix_set(g, i, dof + i, 1);
    for (size_t j = 0; j < dof; j++) {
      gsl_matrix_set(g, dof + i, j, -m->mk_column[j][i]);
      gsl_matrix_set(g, dof + i, dof + j, -m->mb_column[j][i]);
    }
    gsl_matrix_set(g, dof + i, inputs + FORCE, m->mf[i]);
    if (m->loaded) gsl_matrix_set(g, dof + i, inputs + ONE, m->m0[i]);
  }
}

/* x' = w (M x + b u) of a low-pass, whose input u is what the sensor measures. */
static void fill_lowpass(gsl_matrix *g, const vs_sensor *s, int dof) {
  const vs_lowpass *l = &s->lowpass;
  size_t at = (size_t)s->at, driven = at + (size_t)l->works_on, inputs = g->size1 - INPUTS;
  for (size_t i = 0; i < (size_t)s->states; i++)
    for (size_t j = 0; j < (size_t)s->states; j++)
      gsl_matrix_set(g, at + i, at + j, l->rate * l->m[i][j]);
  for (int j = 0; j < 2 * dof; j++) gsl_matrix_set(g, driven, (size_t)j, l->rate * s->row[j]);
  gsl_matrix_set(g, driven, inputs + FORCE, l->rate * s->of_force);
  gsl_matrix_set(g, driven, inputs + ONE, l->rate * s->constant);
}

static double scale_of_state(const vs_sampled_system *p, size_t k) {
  return k < (size_t)p->states ? p->scale[k] : 1;
}

/* With (x, F, rise, 1)' = G (x, F, rise, 1), where F' = rise/T, the state one period on is
 * exp(G T) (x, F, rise, 1). The exponential is taken in scaled states (see
 * engine/ideal/propagator.c). */
static void fill_samples(vs_sampled_system *p, const vs_model *m) {
  size_t states = (size_t)p->states, size = states + INPUTS;
  gsl_matrix *g = vs_checked(gsl_matrix_calloc(size, size)),
             *e = vs_checked(gsl_matrix_alloc(size, size));
  fill_motion_matrix(g, m);
  for (int k = 0; k < p->sensors; k++)
    if (p->sensor[k].states) fill_lowpass(g, &p->sensor[k], p->dof);
  gsl_matrix_set(g, states + FORCE, states + RISE, 1 / p->period_s);
  for (size_t i = 0; i < size; i++)
    for (size_t j = 0; j < size; j++)
      gsl_matrix_set(g, i, j,
                     gsl_matrix_get(g, i, j) * p->period_s * scale_of_state(p, j) /
                         scale_of_state(p, i));
  gsl_linalg_exponential_ss(g, e, GSL_PREC_DOUBLE);
  for (size_t i = 0; i < states; i++) {
    for (size_t j = 0; j < states; j++)
      p->a[i][j] = gsl_matrix_get(e, i, j) * p->scale[i] / p->scale[j];
    double held = gsl_matrix_get(e, i, states + FORCE), rise = gsl_matrix_get(e, i, states + RISE);
    p->b[0][i] = (held - rise) * p->scale[i];
    p->b[1][i] = rise * p->scale[i];
    p->constant[i] = gsl_matrix_get(e, i, states + ONE) * p->scale[i];
  }
  gsl_matrix_free(g);
  gsl_matrix_free(e);
}

void vs_sampled_system_make(vs_sampled_system *p, const vs_model *m,
                            const vs_instrument *const *instruments, int count, double period_s) {
  *p = (vs_sampled_system){.period_s = period_s, .dof = m->dof, .states = 2 * m->dof};
  for (int k = 0; k < count; k++) add_sensor(p, m, instruments[k]);
  set_scales(p, m);
  fill_samples(p, m);
  for (int k = 0; k < count; k++) {
    const vs_sensor *s = &p->sensor[k];
    if (s->states) {
      p->c[k][s->at] = 1;
      continue;
    }
    memcpy(p->c[k], s->row, sizeof s->row);
    p->d[k] = s->of_force;
    p->e[k] = s->constant;
  }
}

/* ---- the scaled system, and poles ---- */

vs_scaled vs_sampled_system_scale(const vs_sampled_system *p) {
  size_t n = (size_t)p->states, m = (size_t)p->sensors;
  vs_scaled s = {vs_checked(gsl_matrix_alloc(n, n)), vs_checked(gsl_matrix_alloc(m, n)),
                 vs_checked(gsl_matrix_alloc(n, n)), vs_checked(gsl_matrix_alloc(n, m)),
                 p->period_s * p->rad_s};
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      double one = p->a[i][j] * p->scale[j] / p->scale[i];
      gsl_matrix_set(s.full, i, j, one);
      gsl_matrix_set(s.at, j, i, (one - (i == j ? 1 : 0)) / s.unit_s);
    }
  for (size_t k = 0; k < m; k++)
    for (size_t j = 0; j < n; j++)
      gsl_matrix_set(s.c, k, j, p->c[k][j] * p->scale[j] / p->y_scale[k]);
  gsl_blas_dgemm(CblasTrans, CblasTrans, 1, s.full, s.c, 0, s.cat);
  return s;
}

void vs_sampled_system_unscale(vs_scaled *s) {
  gsl_matrix_free(s->full);
  gsl_matrix_free(s->c);
  gsl_matrix_free(s->at);
  gsl_matrix_free(s->cat);
}

/* exp(s T) - 1 is computed so that it is right where s T is small. */
gsl_complex vs_sampled_system_difference(const vs_sampled_system *p, vs_pole s) {
  double re = s.re_1_s * p->period_s, im = s.im_rad_s * p->period_s, half = sin(im / 2);
  gsl_complex d = gsl_complex_rect(expm1(re) * cos(im) - 2 * half * half, exp(re) * sin(im));
  return gsl_complex_div_real(d, p->period_s * p->rad_s);
}

static int slowest_first(const void *left, const void *right) {
  const vs_pole *a = left, *b = right;
  if (a->re_1_s != b->re_1_s) return a->re_1_s > b->re_1_s ? -1 : 1;
  return (a->im_rad_s < b->im_rad_s) - (a->im_rad_s > b->im_rad_s);
}

bool vs_sampled_system_poles(const vs_sampled_system *p, const vs_scaled *s, const gsl_matrix *gain,
                             vs_pole poles[VS_SAMPLED_MOST]) {
  size_t n = (size_t)p->states;
  gsl_matrix *closed = vs_checked(gsl_matrix_alloc(n, n));
  gsl_vector_complex *d = vs_checked(gsl_vector_complex_alloc(n));
  gsl_eigen_nonsymm_workspace *work = vs_checked(gsl_eigen_nonsymm_alloc(n));
  gsl_matrix_memcpy(closed, s->at);
  gsl_blas_dgemm(CblasNoTrans, CblasTrans, -1 / s->unit_s, s->cat, gain, 1, closed);
  gsl_eigen_nonsymm_params(0, 1, work);
  bool good = !gsl_eigen_nonsymm(closed, d, work);
  for (size_t k = 0; k < n; k++) {
    gsl_complex one = gsl_complex_mul_real(gsl_vector_complex_get(d, k), s->unit_s);
    double re = GSL_REAL(one), im = GSL_IMAG(one); /* s T = ln(1 + one), where it may be small */
    poles[k].re_1_s = log1p(re * (2 + re) + im * im) / 2 / p->period_s;
    poles[k].im_rad_s = atan2(im, 1 + re) / p->period_s;
  }
  qsort(poles, n, sizeof *poles, slowest_first);
  gsl_eigen_nonsymm_free(work);
  gsl_vector_complex_free(d);
  gsl_matrix_free(closed);
  return good;
}
