/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "monodromy.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* ---- independent states ---- */

/* M, of which each pivot's row is taken from the rows below it. */
typedef struct elimination {
  int n;
  double *a;            /* n x n */
  double *row, *column; /* the largest sizes of each, of M itself */
  double *factor;       /* n x n: how much of pivot k's row was in row i */
  bool *used, *done;    /* rows; columns */
} elimination;

/* Less than this beside its row and column in M is rounding: capacitances of a loop. */
static const double NOTHING = 1e-10;

/* The largest entry that is left beside its row's and column's size, in the machine's rows first;
 * false: none is left. */
static bool find_pivot(const elimination *l, const vs_equations *e, int *row, int *column) {
  double most = NOTHING;
  for (int i = 0; i < l->n; i++)
    for (int j = 0; j < l->n && !l->used[i]; j++) {
      if (l->done[j] || l->a[i * l->n + j] == 0) continue;
      const bool moves = i >= e->machine && i < e->machine + e->states;
      const double size = fabs(l->a[i * l->n + j]) / sqrt(l->row[i] * l->column[j]);
      if (!(size > most) && !moves) continue;
      most = moves ? INFINITY : size;
      *row = i;
      *column = j;
      if (moves) return true;
    }
  return most > NOTHING;
}

static void eliminate(elimination *l, int r, int c, int k) {
  l->used[r] = l->done[c] = true;
  l->factor[r * l->n + k] = 1;
  for (int i = 0; i < l->n; i++) {
    const double ratio = l->a[i * l->n + c] / l->a[r * l->n + c];
    if (l->used[i] || ratio == 0) continue;
    l->factor[i * l->n + k] = ratio;
    for (int j = 0; j < l->n; j++) l->a[i * l->n + j] -= ratio * l->a[r * l->n + j];
  }
}

/* M y = embedded z: row i of it is e_i with e_i F = f_i, where F has the pivots' factors. */
static void embed(vs_monodromy *m, const elimination *l) {
  const int n = l->n, states = m->states;
  for (int i = 0; i < n; i++)
    for (int k = states - 1; k >= 0; k--) {
      double left = l->factor[i * n + k];
      for (int j = k + 1; j < states; j++)
        left -= m->embedded[i * states + j] * l->factor[m->row[j] * n + k];
      m->embedded[i * states + k] = left;
    }
}

static void find_states(vs_monodromy *m) {
  const vs_equations *e = m->e;
  const size_t n = (size_t)e->rows;
  elimination l = {e->rows,
                   vs_alloc(n * n, sizeof(double)),
                   vs_alloc(n, sizeof(double)),
                   vs_alloc(n, sizeof(double)),
                   vs_alloc(n * n, sizeof(double)),
                   vs_alloc(n, sizeof(bool)),
                   vs_alloc(n, sizeof(bool))};
  for (int k = 0; k < e->masses; k++) {
    const vs_entry *at = &e->mass[k];
    l.a[at->row * e->rows + at->column] = at->value;
    l.row[at->row] = fmax(l.row[at->row], fabs(at->value));
    l.column[at->column] = fmax(l.column[at->column], fabs(at->value));
  }
  m->row = vs_alloc(n, sizeof *m->row);
  int column;
  while (m->states < e->rows && find_pivot(&l, e, &m->row[m->states], &column)) {
    eliminate(&l, m->row[m->states], column, m->states);
    m->states++;
  }
  m->embedded = vs_alloc(n * (size_t)m->states + 1, sizeof *m->embedded);
  embed(m, &l);
  free(l.a);
  free(l.row);
  free(l.column);
  free(l.factor);
  free(l.used);
  free(l.done);
}

void vs_monodromy_begin(vs_monodromy *m, vs_equations *e) {
  *m = (vs_monodromy){.e = e};
  find_states(m);
  const size_t n = (size_t)e->rows, all = n * (size_t)m->states, values = (size_t)e->matrix.count;
  double *next = m->s =
      vs_alloc(10 * all + 6 * values + 2 * n + (size_t)e->n + (size_t)m->states, sizeof *next);
  m->charge = next += all;
  for (int k = 0; k < 6; k++) m->k[k] = next += all;
  m->at = next += all;
  m->b = next += all;
  next += all;
  for (int k = 0; k < 6; k++, next += values) m->jacobian[k] = next;
  m->y = next;
  m->rate = next += e->n;
  m->jump = next += n;
  m->moved = next + n;
  m->entry = vs_alloc(3 * values, sizeof *m->entry);
  for (int k = 0; k < e->rows * e->rows; k++) {
    if (e->matrix.place[k] < 0) continue;
    const int entry[] = {k / e->rows, k % e->rows, e->matrix.place[k]};
    memcpy(m->entry + 3 * (size_t)m->entries++, entry, sizeof entry);
  }
}

void vs_monodromy_free(vs_monodromy *m) {
  free(m->row);
  free(m->entry);
  free(m->embedded);
  free(m->s);
  *m = (vs_monodromy){0};
}

void vs_monodromy_state(const vs_monodromy *m, const double *charge, double *z) {
  for (int k = 0; k < m->states; k++) z[k] = charge[m->row[k]];
}

void vs_monodromy_charge(const vs_monodromy *m, const double *z, double *charge) {
  for (int i = 0; i < m->e->rows; i++) {
    charge[i] = 0;
    for (int k = 0; k < m->states; k++) charge[i] += m->embedded[i * m->states + k] * z[k];
  }
}

/* ---- products ---- */

/* row of to += factor times row of from. */
static void add_row(int count, double factor, const double *restrict from, double *restrict to) {
  for (int k = 0; k < count; k++) to[k] += factor * from[k];
}

/* to += values times from. */
static void add_product(const vs_monodromy *m, double factor, const double *values,
                        const double *from, double *to) {
  for (int k = 0; k < m->entries; k++) {
    const int *at = m->entry + 3 * (size_t)k, count = m->states;
    if (values[at[2]] != 0)
      add_row(count, factor * values[at[2]], from + at[1] * count, to + at[0] * count);
  }
}

/* to += factor M from. */
static void add_mass(const vs_monodromy *m, double factor, const double *from, double *to) {
  for (int k = 0; k < m->e->masses; k++) {
    const vs_entry *at = &m->e->mass[k];
    add_row(m->states, factor * at->value, from + at->column * m->states, to + at->row * m->states);
  }
}

/* ---- a step ---- */

/* The slope over time at the step's beginning, of the polynomial through all stages. */
static void find_slope(vs_monodromy *m) {
  double weight[5] = {0};
  for (int j = 1; j < 5; j++) {
    const double x = vs_rodas_at[j];
    weight[j] = 1 / x;
    weight[0] -= 1 / x;
    for (int l = 1; l < 5; l++)
      if (l != j) weight[j] *= vs_rodas_at[l] / (vs_rodas_at[l] - x);
  }
  for (int k = 0; k < m->e->matrix.count; k++) {
    double sum = 0;
    for (int j = 0; j < 5; j++) sum += weight[j] * m->jacobian[j][k];
    m->jacobian[5][k] = sum;
  }
}

/* Between a step's ends the dense output may take a junction beyond what it has at either, and so
 * its exponential. Where a slope is more than BEYOND times that of both ends, the straight line
 * between them has the state. */
static const double BEYOND = 10;

static bool is_beyond(const vs_monodromy *m, const double *jacobian) {
  for (int k = 0; k < m->e->matrix.count; k++) {
    const double most = fmax(fabs(m->jacobian[0][k]), fabs(m->jacobian[4][k]));
    if (!(fabs(jacobian[k]) <= BEYOND * most)) return true;
  }
  return false;
}

static void find_jacobian(vs_monodromy *m, vs_rodas *r, int stage) {
  const double part = vs_rodas_at[stage];
  vs_rodas_dense(r, part, m->y);
  vs_equations_value(m->e, m->y, r->source[0], false, r->work[0], m->jacobian[stage]);
  if (!is_beyond(m, m->jacobian[stage])) return;
  for (int k = 0; k < m->e->n; k++) m->y[k] = r->y[k] + part * (r->next[k] - r->y[k]);
  vs_equations_value(m->e, m->y, r->source[0], false, r->work[0], m->jacobian[stage]);
}

static void find_jacobians(vs_monodromy *m, vs_rodas *r) {
  memcpy(m->jacobian[0], r->jacobian, (size_t)m->e->matrix.count * sizeof *r->jacobian);
  vs_equations_value(m->e, r->next, r->source[0], false, r->work[0], m->jacobian[4]);
  for (int stage = 1; stage < 4; stage++) find_jacobian(m, r, stage);
  find_slope(m);
}

/* A step that is shorter than this tells no rate beside its rounding. */
static const double LEAST_S = 1e-9;

static void find_rate(vs_monodromy *m, const vs_rodas *r, double h) {
  for (int k = 0; k < m->e->rows && h > LEAST_S; k++)
    m->rate[k] = (r->next[k] - r->y[k] - r->bend[0][k] - r->bend[1][k]) / h;
}

void vs_monodromy_step(vs_monodromy *m, vs_rodas *r, double h) {
  if (!m->follows || !m->known) return;
  const size_t all = (size_t)m->e->rows * (size_t)m->states;
  find_jacobians(m, r);
  find_rate(m, r, h);
  for (int stage = 0; stage < 6; stage++) {
    const double *jacobian = m->jacobian[stage < 5 ? stage : 4];
    memset(m->b, 0, all * sizeof *m->b);
    if (stage < 5) memcpy(m->at, m->s, all * sizeof *m->at);
    for (int l = 0; l < stage && stage < 5; l++)
      add_row((int)all, vs_rodas_stage(stage, l), m->k[l], m->at);
    if (stage == 5) add_row((int)all, 1, m->k[4], m->at);
    add_product(m, 1, jacobian, m->at, m->b);
    if (stage < 4) add_product(m, vs_rodas_rate[stage], m->jacobian[5], m->s, m->b);
    double *sum = m->k[stage]; /* not in use yet */
    memset(sum, 0, all * sizeof *sum);
    for (int l = 0; l < stage; l++) add_row((int)all, vs_rodas_coupling(stage, l), m->k[l], sum);
    if (stage) add_mass(m, 1 / h, sum, m->b);
    vs_matrix_solve_many(&m->e->matrix, r->factors, m->states, m->b, m->k[stage]);
  }
  for (size_t k = 0; k < all; k++) m->s[k] = m->at[k] + m->k[5][k];
}

/* ---- a jump ---- */

/* A step ends near the instant at which a branch asks to be another one: as near as the step is
 * exact. AHEAD before that, which is small beside what rings and large beside rounding, the state
 * is pushed along a column of S until the branch asks there. The push is known to SHARP of it. */
static const double AHEAD_S = 1e-8, MOST_AHEAD_S = 1e-5, SHARP = 1e-7, LARGEST_PUSH = 1e30;

static void push_state(vs_monodromy *m, const vs_rodas *r, double t_s, double push, int k) {
  memcpy(m->y, r->y, (size_t)m->e->n * sizeof *r->y);
  for (int i = 0; i < m->e->rows; i++)
    m->y[i] += t_s * m->rate[i] + (push != 0 ? push * m->s[i * m->states + k] : 0);
  vs_equations_follow(m->e, m->y, false);
}

static bool asks(vs_monodromy *m, const vs_rodas *r, const vs_monodromy_due *d, double t_s,
                 double push, int k) {
  push_state(m, r, t_s, push, k);
  return vs_equations_asks(m->e, d->device, m->y);
}

/* Finds the device that asks, and when it begins to. */
static bool find_due(vs_monodromy *m, const vs_rodas *r, vs_monodromy_due *d) {
  for (double far_s = AHEAD_S; far_s <= MOST_AHEAD_S; far_s *= 10)
    for (d->device = 0; d->device < m->e->devices; d->device++) {
      if (!asks(m, r, d, far_s, 0, 0) || asks(m, r, d, -far_s, 0, 0)) continue;
      double low = -far_s, high = far_s;
      while (high - low > SHARP * far_s) {
        const double middle = (low + high) / 2;
        *(asks(m, r, d, middle, 0, 0) ? &high : &low) = middle;
      }
      d->at_s = high;
      d->ahead_s = far_s;
      return true;
    }
  return false;
}

/* By how much the instant moves with z(0)'s k-th number. */
static double find_move(vs_monodromy *m, const vs_rodas *r, const vs_monodromy_due *d, int k) {
  double most = 0;
  for (int i = 0; i < m->e->rows; i++) most = fmax(most, fabs(m->s[i * m->states + k]));
  const double to_s = d->at_s - d->ahead_s;
  for (double push = 1e-12 / most; push < LARGEST_PUSH && most > 0; push *= 10) {
    const bool up = asks(m, r, d, to_s, push, k);
    if (!up && !asks(m, r, d, to_s, -push, k)) continue;
    double low = 0, high = up ? push : -push;
    while (fabs(high - low) > SHARP * fabs(high)) {
      const double middle = (low + high) / 2;
      *(asks(m, r, d, to_s, middle, k) ? &high : &low) = middle;
    }
    /* another of the device's branches does not come nearer with the instant */
    const bool same = asks(m, r, d, d->at_s - d->ahead_s / 4, high / 3, k);
    return same ? -d->ahead_s / high : 0;
  }
  return 0;
}

void vs_monodromy_look(vs_monodromy *m, const vs_rodas *r, const double *f) {
  if (!m->follows || !m->known) return;
  m->finds = find_due(m, r, &m->due);
  memcpy(m->jump, f, (size_t)m->e->rows * sizeof *f);
}

void vs_monodromy_jump(vs_monodromy *m, const vs_rodas *r) {
  const vs_monodromy_due *d = &m->due;
  if (!m->follows || !m->known) return;
  m->jumps = m->known = m->finds;
  if (!m->known) return;
  push_state(m, r, d->at_s - d->ahead_s, 0, 0);
  vs_equations_turn(m->e, d->device, m->y);
  for (int k = 0; k < m->states; k++) m->moved[k] = find_move(m, r, d, k);
  vs_equations_turn(m->e, d->device, r->y);
}

/* ---- a stretch ---- */

void vs_monodromy_start(vs_monodromy *m, bool follows) {
  m->follows = m->known = follows;
  m->jumps = false;
  memcpy(m->charge, m->embedded, (size_t)m->e->rows * (size_t)m->states * sizeof *m->charge);
}

void vs_monodromy_stop(vs_monodromy *m) {
  if (!m->follows) return;
  memset(m->charge, 0, (size_t)m->e->rows * (size_t)m->states * sizeof *m->charge);
  add_mass(m, 1, m->s, m->charge);
}

/* (M/h - df/dy) S = charge/h, with df/dy at the restart's end. */
void vs_monodromy_restart(vs_monodromy *m, vs_rodas *r, double h) {
  if (!m->follows || !m->known) return;
  const size_t all = (size_t)m->e->rows * (size_t)m->states;
  vs_equations_value(m->e, r->next, r->source[0], false, r->work[0], r->jacobian);
  m->known = vs_rodas_factor(r, 1 / h);
  for (size_t k = 0; k < all; k++) m->b[k] = m->charge[k] / h;
  for (int i = 0; i < m->e->rows && m->jumps; i++)
    add_row(m->states, (m->jump[i] - r->work[0][i]) / h, m->moved, m->b + i * m->states);
  m->jumps = false;
  if (m->known) vs_matrix_solve_many(&m->e->matrix, r->factors, m->states, m->b, m->s);
}

void vs_monodromy_slope(const vs_monodromy *m, double *slope) {
  const int count = m->states;
  memset(m->b, 0, (size_t)m->e->rows * (size_t)count * sizeof *m->b);
  add_mass(m, 1, m->s, m->b);
  for (int k = 0; k < count; k++)
    memcpy(slope + k * count, m->b + m->row[k] * count, (size_t)count * sizeof *slope);
}
