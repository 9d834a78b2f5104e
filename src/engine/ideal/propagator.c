/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/propagator.h"

#include <gsl/gsl_linalg.h>
#include <string.h>

/* A = [0 I; -M^-1 K  -M^-1 B]; constant forces add a column M^-1 f0 for a state that is always 1.
 * The exponential is taken for (w q, q') with the fastest mode's w, in which the matrix is of one
 * order of magnitude throughout: GSL's result is then right to 2e-15 to 5e-15, for 2e-14 to 1e-12
 * without (h from 50 us to 0.8 ms, Table 1). */
void vs_propagator_make(vs_propagator *p, const vs_model *m, bool held, double h_s) {
  size_t dof = (size_t)m->dof, states = 2 * dof, size = states + m->loaded;
  double w = m->fastest_rad_s > 0 ? m->fastest_rad_s : 1 / h_s;
  double k[VS_MOST_DOF], b[VS_MOST_DOF], f[VS_MOST_DOF];
  gsl_matrix *a = vs_checked(gsl_matrix_calloc(size, size)),
             *e = vs_checked(gsl_matrix_alloc(size, size));
  for (size_t j = 0; j < dof; j++) {
    gsl_matrix_set(a, j, dof + j, h_s * w);
    memcpy(k, m->mk_column[j], sizeof k);
    memcpy(b, m->mb_column[j], sizeof b);
    if (held) {
      vs_mechanics_hold(m, k);
      vs_mechanics_hold(m, b);
    }
    for (size_t i = 0; i < dof; i++) {
      gsl_matrix_set(a, dof + i, j, -h_s * k[i] / w);
      gsl_matrix_set(a, dof + i, dof + j, -h_s * b[i]);
    }
  }
  memcpy(f, m->m0, sizeof f);
  if (held) vs_mechanics_hold(m, f);
  for (size_t i = 0; m->loaded && i < dof; i++) gsl_matrix_set(a, dof + i, states, h_s * f[i]);
  gsl_linalg_exponential_ss(a, e, GSL_PREC_DOUBLE);
  *p = (vs_propagator){.states = (int)states, .loaded = m->loaded};
  for (size_t i = 0; i < states; i++) {
    double row = i < dof ? 1 / w : 1;
    for (size_t j = 0; j < states; j++) {
      p->column[j][i] = gsl_matrix_get(e, i, j);
      if (i < dof && j >= dof) p->column[j][i] /= w;
      if (i >= dof && j < dof) p->column[j][i] *= w;
    }
    if (m->loaded) p->constant[i] = row * gsl_matrix_get(e, i, states);
  }
  gsl_matrix_free(a);
  gsl_matrix_free(e);
}

void vs_propagator_recall(vs_propagator *p, vs_propagator_memo *memo, const vs_model *m, bool held,
                          double h_s) {
  if (!memo || held) {
    vs_propagator_make(p, m, held, h_s);
    return;
  }
  struct vs_propagator_source *of = &memo->of;
  const bool same =
      of->dof == m->dof && of->loaded == m->loaded && of->h_s == h_s &&
      of->fastest_rad_s == m->fastest_rad_s && !memcmp(of->k, m->mk_column, sizeof of->k) &&
      !memcmp(of->b, m->mb_column, sizeof of->b) && !memcmp(of->f, m->m0, sizeof of->f);
  if (!same) {
    vs_propagator_make(&memo->made, m, false, h_s);
    *of = (struct vs_propagator_source){
        .fastest_rad_s = m->fastest_rad_s, .h_s = h_s, .dof = m->dof, .loaded = m->loaded};
    memcpy(of->k, m->mk_column, sizeof of->k);
    memcpy(of->b, m->mb_column, sizeof of->b);
    memcpy(of->f, m->m0, sizeof of->f);
  }
  *p = memo->made;
}

static void step_by_blocks(const vs_propagator *p, const double *x, double *restrict y) {
  for (int first = 0; first < p->states; first += VS_ROWS) {
    double sum[VS_ROWS] = {0};
    int j = 0;
    for (; j + VS_ROWS <= p->states; j += VS_ROWS) {
      const double(*e)[VS_MOST_STATES] = p->column + j, *at = x + j;
      for (int i = 0; i < VS_ROWS; i++) {
        int row = first + i;
        sum[i] =
            sum[i] + e[0][row] * at[0] + e[1][row] * at[1] + e[2][row] * at[2] + e[3][row] * at[3];
      }
    }
    for (; j < p->states; j++)
      for (int i = 0; i < VS_ROWS; i++) sum[i] += p->column[j][first + i] * x[j];
    memcpy(y + first, sum, sizeof sum);
  }
}

/* E x. */
static inline void multiply_matrix(const vs_propagator *p, const double *x, double *restrict y) {
  const double(*e)[VS_MOST_STATES] = p->column;
  double sum[2 * VS_ROWS];
  if (p->states == 2 * VS_ROWS) {
    for (int i = 0; i < 2 * VS_ROWS; i++)
      sum[i] = e[0][i] * x[0] + e[1][i] * x[1] + e[2][i] * x[2] + e[3][i] * x[3] + e[4][i] * x[4] +
               e[5][i] * x[5] + e[6][i] * x[6] + e[7][i] * x[7];
    memcpy(y, sum, sizeof sum);
  } else {
    step_by_blocks(p, x, y);
  }
}

void vs_propagator_step(const vs_propagator *p, const double *x, double *restrict y) {
  multiply_matrix(p, x, y);
  for (int i = 0; p->loaded && i < p->states; i++) y[i] += p->constant[i];
}

/* Makes the propagator of twice the length: E E, and E c + c for what constant forces add. */
static void redouble(const vs_propagator *once, vs_propagator *twice) {
  twice->states = once->states;
  twice->loaded = once->loaded;
  for (int j = 0; j < once->states; j++) multiply_matrix(once, once->column[j], twice->column[j]);
  if (once->loaded) vs_propagator_step(once, once->constant, twice->constant);
}

static void leap(const vs_propagator *p, unsigned long long left, const double *x,
                 double *restrict y) {
  vs_propagator power[2]; /* in turn, each of twice the other's length */
  double at[VS_MOST_STATES];
  memcpy(y, x, (size_t)p->states * sizeof *y);
  for (int now = 0; left; left >>= 1, now = 1 - now) {
    if (left & 1) {
      memcpy(at, y, (size_t)p->states * sizeof *at);
      vs_propagator_step(p, at, y);
    }
    if (left > 1) redouble(p, &power[now]);
    p = &power[now];
  }
}

void vs_propagator_leap(const vs_propagator *p, double count, const double *x, double *restrict y) {
  if (count == 1)
    vs_propagator_step(p, x, y);
  else
    leap(p, (unsigned long long)count, x, y);
}
