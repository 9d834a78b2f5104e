/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "matrix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* Kinds of operations of the elimination, in `source`: the next pivot is inverted; the factor of a
 * row is made; else it is a place. */
enum { INVERT = -1, RATIO = -2 };

void vs_matrix_begin(vs_matrix *m, int n) {
  *m = (vs_matrix){.n = n, .place = vs_alloc((size_t)n * (size_t)n, sizeof *m->place)};
  for (int k = 0; k < n * n; k++) m->place[k] = -1;
}

int vs_matrix_place(vs_matrix *m, int row, int column) {
  int *p = &m->place[row * m->n + column];
  if (*p < 0) *p = m->count++;
  m->filled = m->count;
  return *p;
}

/* ---- the order of pivots ---- */

/* A pivot is at least this part of the largest of its column, each row scaled to 1. */
static const double THRESHOLD = 1e-3, NOTHING = 1e-200;

typedef struct ordering {
  int n;
  double *a;          /* n x n, the rows scaled */
  bool *there;        /* n x n, the pattern with fill-in */
  bool *row, *column; /* what is used up */
} ordering;

static void scale_rows(ordering *o) {
  for (int i = 0; i < o->n; i++) {
    double most = 0;
    for (int j = 0; j < o->n; j++) most = fmax(most, fabs(o->a[i * o->n + j]));
    for (int j = 0; j < o->n && most > 0; j++) o->a[i * o->n + j] /= most;
  }
}

static int count_row(const ordering *o, int i) {
  int count = 0;
  for (int j = 0; j < o->n; j++) count += !o->column[j] && o->there[i * o->n + j];
  return count;
}

static int count_column(const ordering *o, int j) {
  int count = 0;
  for (int i = 0; i < o->n; i++) count += !o->row[i] && o->there[i * o->n + j];
  return count;
}

static double largest_of_column(const ordering *o, int j) {
  double most = 0;
  for (int i = 0; i < o->n; i++)
    if (!o->row[i]) most = fmax(most, fabs(o->a[i * o->n + j]));
  return most;
}

/* The pivot of the least (row's others) x (column's others) among those that are large enough. */
static bool find_pivot(const ordering *o, int *pivot_row, int *pivot_column) {
  double best = INFINITY, best_size = 0;
  int *in_row = vs_alloc((size_t)o->n, sizeof *in_row);
  for (int i = 0; i < o->n; i++) in_row[i] = o->row[i] ? 0 : count_row(o, i);
  for (int j = 0; j < o->n; j++) {
    if (o->column[j]) continue;
    const double most = largest_of_column(o, j), least = fmax(THRESHOLD * most, NOTHING);
    const int others = count_column(o, j) - 1;
    for (int i = 0; i < o->n; i++) {
      const double size = fabs(o->a[i * o->n + j]);
      if (o->row[i] || !(size >= least)) continue;
      const double cost = (double)(in_row[i] - 1) * others;
      if (cost > best || (cost == best && size / most <= best_size)) continue;
      best = cost;
      best_size = size / most;
      *pivot_row = i;
      *pivot_column = j;
    }
  }
  free(in_row);
  return isfinite(best);
}

static void eliminate(ordering *o, int r, int c) {
  o->row[r] = o->column[c] = true;
  for (int i = 0; i < o->n; i++) {
    if (o->row[i] || !o->there[i * o->n + c]) continue;
    const double ratio = o->a[i * o->n + c] / o->a[r * o->n + c];
    for (int j = 0; j < o->n; j++) {
      if (o->column[j] || !o->there[r * o->n + j]) continue;
      o->there[i * o->n + j] = true;
      o->a[i * o->n + j] -= ratio * o->a[r * o->n + j];
    }
  }
}

/* ---- the operations that follow from it ---- */

static void add_op(vs_matrix_op **list, int *count, int target, int factor, int source) {
  *list = vs_alloc_grow(*list, (size_t)*count, sizeof **list);
  (*list)[(*count)++] = (vs_matrix_op){target, factor, source};
}

static void list_operations(vs_matrix *m) {
  const int n = m->n;
  int *place = vs_alloc((size_t)n * (size_t)n, sizeof *place);
  bool *row = vs_alloc((size_t)n, sizeof *row), *column = vs_alloc((size_t)n, sizeof *column);
  memcpy(place, m->place, (size_t)n * (size_t)n * sizeof *place);
  m->filled = m->count;
  m->eliminations = m->forwards = m->backs = 0;
  for (int k = 0; k < n; k++) {
    const int r = m->row[k], c = m->column[k], pivot = place[r * n + c];
    row[r] = column[c] = true;
    add_op(&m->eliminate, &m->eliminations, pivot, k, INVERT);
    for (int i = 0; i < n; i++) {
      if (row[i] || place[i * n + c] < 0) continue;
      const int ratio = place[i * n + c];
      add_op(&m->eliminate, &m->eliminations, ratio, pivot, RATIO);
      add_op(&m->forward, &m->forwards, i, ratio, r);
      for (int j = 0; j < n; j++) {
        if (column[j] || place[r * n + j] < 0) continue;
        int *target = &place[i * n + j];
        if (*target < 0) *target = m->filled++;
        add_op(&m->eliminate, &m->eliminations, *target, ratio, place[r * n + j]);
      }
    }
  }
  for (int k = n - 1; k >= 0; k--) { /* x_c = (b_r - sum of later columns)/pivot */
    const int r = m->row[k];
    for (int l = k + 1; l < n; l++)
      if (place[r * n + m->column[l]] >= 0)
        add_op(&m->back, &m->backs, r, place[r * n + m->column[l]], m->column[l]);
    add_op(&m->back, &m->backs, m->column[k], place[r * n + m->column[k]], -1 - r);
  }
  free(place);
  free(row);
  free(column);
}

bool vs_matrix_order(vs_matrix *m, const double *values, int *culprit) {
  const int n = m->n;
  ordering o = {n, vs_alloc((size_t)n * (size_t)n, sizeof(double)),
                vs_alloc((size_t)n * (size_t)n, sizeof(bool)), vs_alloc((size_t)n, sizeof(bool)),
                vs_alloc((size_t)n, sizeof(bool))};
  bool whole = true;
  if (!m->row) m->row = vs_alloc((size_t)n, sizeof *m->row);
  if (!m->column) m->column = vs_alloc((size_t)n, sizeof *m->column);
  for (int k = 0; k < n * n; k++) {
    if (m->place[k] < 0) continue;
    o.there[k] = true;
    o.a[k] = values[m->place[k]];
  }
  scale_rows(&o);
  for (int k = 0; k < n && whole; k++) {
    whole = find_pivot(&o, &m->row[k], &m->column[k]);
    if (whole) eliminate(&o, m->row[k], m->column[k]);
  }
  for (int j = 0; j < n && !whole; j++)
    if (!o.column[j]) *culprit = j;
  if (whole) list_operations(m);
  free(o.a);
  free(o.there);
  free(o.row);
  free(o.column);
  return whole;
}

/* ---- factors and solutions ---- */

bool vs_matrix_factor(const vs_matrix *m, double *a) {
  double inverse = 0, ratio = 0;
  bool fine = true;
  for (int k = m->count; k < m->filled; k++) a[k] = 0;
  for (int k = 0; k < m->eliminations; k++) {
    const vs_matrix_op *op = &m->eliminate[k];
    if (op->source >= 0) {
      a[op->target] -= ratio * a[op->source];
    } else if (op->source == RATIO) {
      ratio = a[op->target] *= inverse;
    } else {
      inverse = a[op->target] = 1 / a[op->target];
      fine = fine && isfinite(inverse);
    }
  }
  return fine;
}

void vs_matrix_solve(const vs_matrix *m, const double *a, double *b, double *x) {
  for (int k = 0; k < m->forwards; k++) {
    const vs_matrix_op *op = &m->forward[k];
    b[op->target] -= a[op->factor] * b[op->source];
  }
  for (int k = 0; k < m->backs; k++) {
    const vs_matrix_op *op = &m->back[k];
    if (op->source >= 0)
      b[op->target] -= a[op->factor] * x[op->source];
    else
      x[op->target] = b[-1 - op->source] * a[op->factor];
  }
}

void vs_matrix_free(vs_matrix *m) {
  free(m->place);
  free(m->eliminate);
  free(m->forward);
  free(m->back);
  free(m->row);
  free(m->column);
  *m = (vs_matrix){0};
}
