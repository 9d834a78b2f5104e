/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "rodas.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* RODASP's coefficients, in the form that needs no product with the Jacobian. */
static const double GAMMA = 0.25;
static const double A[5][5] = {
    {3},
    {1.831036793486759, 0.4955183967433795},
    {2.304376582692669, -0.05249275245743001, -1.176798761832782},
    {-7.170454962423024, -4.741636671481785, -16.31002631330971, -1.062004044111401},
    {0}};
static const double C[5][5] = {
    {-12},
    {-8.791795173947035, -2.207865586973518},
    {10.81793056857153, 6.780270611428266, 19.53485944642410},
    {34.19095006749676, 15.49671153725963, 54.74760875964130, 14.16005392148534},
    {34.62605830930532, 15.30084976114473, 56.99955578662667, 18.40807009793095,
     -5.714285714285717}};
const double vs_rodas_at[6] = {0, 0.75, 0.21, 0.63, 1, 1};
const double vs_rodas_rate[4] = {0.25, -0.5, -0.023504, -0.0362};
/* Of the dense output: a cubic that has order 3 in the states, and in unknowns without a memory
 * that are functions of states and time. These are five linear equations for the weights of each
 * of its two parts: the stages of y' = 1, 2t, 3t^2, of y' = 6v with v' = t, and of z = t x with
 * x' = 2t, over a step of 1 from 0, must give the exact cubic. rodas.f has others, with which the
 * last one's order is 2, and a current between two coils is off by 3.9 tolerances between steps
 * instead of 0.7. */
static const double D[2][5] = {
    {25.298191647914937, 11.530361062899392, 29.523625464514680, -3.7170141543899504, -11.0 / 14},
    {1.8492100276864303, -0.83241254848834050, 9.5707748646877770, 18.054068749893810, -19.0 / 7}};

double vs_rodas_stage(int stage, int of) {
  return A[stage - 1][of];
}

double vs_rodas_coupling(int stage, int of) {
  return C[stage - 1][of];
}

enum { VECTORS = 15 };

void vs_rodas_begin(vs_rodas *r, vs_equations *e, const vs_rodas_drive *drive) {
  const size_t n = (size_t)e->n, rows = (size_t)e->rows, values = rows * rows,
               sources = (size_t)e->sources + 1;
  *r = (vs_rodas){.e = e, .drive = *drive, .culprit = -1};
  double *next = r->memory = vs_alloc(VECTORS * n + 3 * values + 4 * sources, sizeof *next);
  double **vectors[VECTORS] = {&r->y,    &r->next,    &r->error,   &r->bend[0], &r->bend[1],
                               &r->k[0], &r->k[1],    &r->k[2],    &r->k[3],    &r->k[4],
                               &r->k[5], &r->work[0], &r->work[1], &r->work[2], &r->f};
  for (int k = 0; k < VECTORS; k++, next += n) *vectors[k] = next;
  for (int k = e->follow; k < e->n; k++)
    r->y[k] = r->next[k] = r->work[2][k] = e->rest[k - e->rows];
  r->jacobian = next;
  r->factors = next + values;
  r->matrix = next + 2 * values;
  for (int k = 0; k < 4; k++) r->source[k] = next + 3 * values + (size_t)k * sources;
}

void vs_rodas_free(vs_rodas *r) {
  free(r->memory);
  *r = (vs_rodas){0};
}

/* ---- the matrix ---- */

/* M/(gamma h) - df/dy, by place. */
static void set_matrix(vs_rodas *r, double per_h) {
  const vs_equations *e = r->e;
  for (int k = 0; k < e->matrix.count; k++) r->matrix[k] = -r->jacobian[k];
  for (int k = 0; k < e->masses; k++) r->matrix[e->mass[k].place] += e->mass[k].value * per_h;
}

static bool order_pivots(vs_rodas *r) {
  r->ordered = vs_matrix_order(&r->e->matrix, r->matrix, &r->culprit);
  if (r->ordered) r->culprit = -1;
  return r->ordered;
}

/* Factors the matrix, with another order of pivots where that of before does not serve. */
static bool factor(vs_rodas *r) {
  vs_matrix *m = &r->e->matrix;
  for (int turn = 0; turn < 2; turn++) {
    if ((turn || !r->ordered) && !order_pivots(r)) return false;
    memcpy(r->factors, r->matrix, (size_t)m->count * sizeof *r->factors);
    if (vs_matrix_factor(m, r->factors)) return true;
  }
  return false;
}

bool vs_rodas_factor(vs_rodas *r, double per_h) {
  set_matrix(r, per_h);
  return factor(r);
}

/* ---- a step ---- */

/* The slope of what drives over time, from three instants at and behind t_s, which must be so far
 * apart that their times differ. A step of less needs no slope. */
static const double LEAST_APART_S = 1e-13;

static void find_rates(vs_rodas *r, double h) {
  const double d = fmax(1e-3 * h, LEAST_APART_S);
  double *s0 = r->source[0], *s1 = r->source[1], *s2 = r->source[2], *rate = r->source[3];
  r->drive.at(r->drive.ctx, r->t_s + d, s1);
  r->drive.at(r->drive.ctx, r->t_s + 2 * d, s2);
  const double per_s = h >= 2 * d ? 1 / (2 * d) : 0;
  for (int k = 0; k < r->e->sources; k++) rate[k] = (4 * s1[k] - 3 * s0[k] - s2[k]) * per_s;
}

/* Adds factor times df/dt. */
static void add_rates(const vs_rodas *r, double factor, double *b) {
  for (int k = 0; k < r->e->sources; k++)
    b[r->e->source[k].row] += factor * r->e->source[k].factor * r->source[3][k];
}

/* sum = from + the sum of weight[l] k[l]. With a count that the compiler knows it is a loop over i
 * alone. */
static inline __attribute__((always_inline)) void
add_weighted(int n, int count, const double *weight, double *const *k, const double *restrict from,
             double *restrict sum) {
  for (int i = 0; i < n; i++) {
    double s = from ? from[i] : 0;
    for (int l = 0; l < count; l++) s += weight[l] * k[l][i];
    sum[i] = s;
  }
}

static void add_stages(const vs_rodas *r, int count, const double *weight, const double *from,
                       double *sum) {
  const int n = r->e->rows;
  switch (count) {
  case 1:
    add_weighted(n, 1, weight, r->k, from, sum);
    break;
  case 2:
    add_weighted(n, 2, weight, r->k, from, sum);
    break;
  case 3:
    add_weighted(n, 3, weight, r->k, from, sum);
    break;
  case 4:
    add_weighted(n, 4, weight, r->k, from, sum);
    break;
  default:
    add_weighted(n, 5, weight, r->k, from, sum);
  }
}

bool vs_rodas_try(vs_rodas *r, double h) {
  vs_equations *e = r->e;
  const int n = e->rows;
  double *b = r->work[0], *sum = r->work[1], *at = r->work[2], rate[5];
  r->drive.at(r->drive.ctx, r->t_s, r->source[0]);
  if (!r->fresh) vs_equations_value(e, r->y, r->source[0], false, r->f, r->jacobian);
  r->fresh = true;
  memcpy(b, r->f, (size_t)n * sizeof *b);
  if (!vs_rodas_factor(r, 1 / (GAMMA * h))) return false;
  find_rates(r, h);
  add_rates(r, h * vs_rodas_rate[0], b);
  vs_matrix_solve(&e->matrix, r->factors, b, r->k[0]);
  for (int stage = 1; stage < 6; stage++) {
    if (stage < 5)
      add_stages(r, stage, A[stage - 1], r->y, at);
    else
      for (int i = 0; i < n; i++) at[i] += r->k[4][i];
    vs_equations_follow(e, at, false);
    if (vs_rodas_at[stage] != vs_rodas_at[stage - 1])
      r->drive.at(r->drive.ctx, r->t_s + vs_rodas_at[stage] * h, r->source[0]);
    vs_equations_value(e, at, r->source[0], false, b, NULL);
    for (int l = 0; l < stage; l++) rate[l] = C[stage - 1][l] / h;
    add_stages(r, stage, rate, NULL, sum);
    vs_equations_add_mass(e, sum, b);
    if (stage < 4) add_rates(r, h * vs_rodas_rate[stage], b);
    vs_matrix_solve(&e->matrix, r->factors, b, r->k[stage]);
  }
  for (int i = 0; i < n; i++) {
    r->error[i] = r->k[5][i];
    r->next[i] = at[i] + r->k[5][i];
  }
  vs_equations_follow(e, r->error, true);
  vs_equations_follow(e, r->next, false);
  for (int part = 0; part < 2; part++) {
    add_stages(r, 5, D[part], NULL, r->bend[part]);
    vs_equations_follow(e, r->bend[part], true);
  }
  return true;
}

void vs_rodas_dense(const vs_rodas *r, double part, double *y) {
  for (int k = 0; k < r->e->n; k++) y[k] = vs_rodas_dense_of(r, k, part);
}

/* ---- a restart ---- */

/* Newton's iteration ends where its correction is below this: rounding, where a node has 1e-20 F.
 * Where no junction is limited any more it takes a few turns. What then goes on is rounding, of
 * nodes at some 100 V with next to no path to any other node; 1e-5 V of that are allowed.
 */
enum { ITERATIONS = 200, QUICK = 20, ROUNDING = 1000 };
static const double LEAST_A = 1e-6, LEAST_V = 1e-8, OF_SIZE = 1e-7;

bool vs_rodas_restart(vs_rodas *r, const double *charge, double h, bool chooses) {
  vs_equations *e = r->e;
  const int n = e->rows;
  double *b = r->work[0], *m = r->work[1], *change = r->k[0];
  r->drive.at(r->drive.ctx, r->t_s + h, r->source[0]);
  memcpy(r->next, r->y, (size_t)e->n * sizeof *r->next);
  for (int turn = 0; turn < ITERATIONS; turn++) {
    const bool other = chooses && vs_equations_choose(e, r->next, false);
    /* M (next - y)/h = f(next) */
    bool limited = vs_equations_value(e, r->next, r->source[0], true, b, r->jacobian);
    vs_equations_mass(e, r->next, m);
    for (int i = 0; i < n; i++) b[i] -= (m[i] - charge[i]) / h;
    if (!vs_rodas_factor(r, 1 / h)) return false;
    vs_matrix_solve(&e->matrix, r->factors, b, change);
    double most = 0;
    for (int i = 0; i < n; i++) {
      const double least = e->name[i][0] == 'i' ? LEAST_A : LEAST_V;
      most = fmax(most, fabs(change[i]) / (least + OF_SIZE * fabs(r->next[i])));
      r->next[i] += change[i];
    }
    vs_equations_follow(e, r->next, false);
    if (!isfinite(most)) return false;
    if (most <= (turn < QUICK ? 1 : ROUNDING) && !limited && !other) return true;
  }
  return false;
}

void vs_rodas_take(vs_rodas *r, double h) {
  double *was = r->y;
  r->y = r->next;
  r->next = was;
  r->t_s += h;
  r->fresh = false;
}
