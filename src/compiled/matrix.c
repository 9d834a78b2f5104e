/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "matrix.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

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

static int add_number(vs_matrix_list *list, int number) {
  list->at = vs_alloc_grow(list->at, (size_t)list->count, sizeof *list->at);
  list->at[list->count] = number;
  return list->count++;
}

/* For each pivot: its place, how many rows it is taken from, how many entries its row has besides,
 * and the places of these; for each of those rows the place of its factor, and the places that the
 * entries are subtracted from. */
static void list_elimination(vs_matrix *m, int *place) {
  const int n = m->n;
  bool *row = vs_alloc((size_t)n, sizeof *row), *column = vs_alloc((size_t)n, sizeof *column);
  for (int k = 0; k < n; k++) {
    const int r = m->row[k], c = m->column[k];
    row[r] = column[c] = true;
    add_number(&m->eliminate, place[r * n + c]);
    const int rows = add_number(&m->eliminate, 0), entries = add_number(&m->eliminate, 0);
    for (int j = 0; j < n; j++)
      if (!column[j] && place[r * n + j] >= 0) {
        add_number(&m->eliminate, place[r * n + j]);
        m->eliminate.at[entries]++;
      }
    for (int i = 0; i < n; i++) {
      if (row[i] || place[i * n + c] < 0) continue;
      m->eliminate.at[rows]++;
      add_number(&m->eliminate, place[i * n + c]);
      for (int j = 0; j < n; j++) {
        if (column[j] || place[r * n + j] < 0) continue;
        int *target = &place[i * n + j];
        if (*target < 0) *target = m->filled++;
        add_number(&m->eliminate, *target);
      }
    }
  }
  free(row);
  free(column);
}

/* For each pivot's row that has factors, in the pivots' order: it, how many, and for each its place
 * and the row that it is of. The other way round for each pivot's column: it, the row, the pivot's
 * place, how many entries, and for each its place and column. */
static void list_solution(vs_matrix *m, const int *place) {
  const int n = m->n;
  for (int k = 0; k < n; k++) {
    const int r = m->row[k];
    int factors = -1;
    for (int l = 0; l < k; l++) {
      if (place[r * n + m->column[l]] < 0) continue;
      if (factors < 0) {
        add_number(&m->forward, r);
        factors = add_number(&m->forward, 0);
      }
      m->forward.at[factors]++;
      add_number(&m->forward, place[r * n + m->column[l]]);
      add_number(&m->forward, m->row[l]);
    }
  }
  for (int k = n - 1; k >= 0; k--) { /* x_c = (b_r - sum of later columns)/pivot */
    const int r = m->row[k];
    add_number(&m->back, m->column[k]);
    add_number(&m->back, r);
    add_number(&m->back, place[r * n + m->column[k]]);
    const int entries = add_number(&m->back, 0);
    for (int l = k + 1; l < n; l++) {
      if (place[r * n + m->column[l]] < 0) continue;
      m->back.at[entries]++;
      add_number(&m->back, place[r * n + m->column[l]]);
      add_number(&m->back, m->column[l]);
    }
  }
}

static void list_operations(vs_matrix *m) {
  const size_t n = (size_t)m->n;
  int *place = vs_alloc(n * n, sizeof *place);
  memcpy(place, m->place, n * n * sizeof *place);
  m->filled = m->count;
  m->eliminate.count = m->forward.count = m->back.count = 0;
  list_elimination(m, place);
  list_solution(m, place);
  free(place);
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
  const int *at = m->eliminate.at;
  bool fine = true;
  for (int k = m->count; k < m->filled; k++) a[k] = 0;
  for (int k = 0; k < m->n; k++) {
    const double inverse = a[at[0]] = 1 / a[at[0]];
    const int rows = at[1], entries = at[2], *source = at + 3;
    fine = fine && isfinite(inverse);
    at = source + entries;
    for (int i = 0; i < rows; i++) {
      const double ratio = a[*at++] *= inverse;
      for (int j = 0; j < entries; j++) a[at[j]] -= ratio * a[source[j]];
      at += entries;
    }
  }
  return fine;
}

void vs_matrix_solve(const vs_matrix *m, const double *restrict a, double *restrict b,
                     double *restrict x) {
  const int *at = m->forward.at, *end = at + m->forward.count;
  while (at < end) {
    double *of = &b[at[0]], left = *of;
    for (int n = (at += 2)[-1]; n; n--, at += 2) left -= a[at[0]] * b[at[1]];
    *of = left;
  }
  for (at = m->back.at, end = at + m->back.count; at < end;) {
    double *of = &x[at[0]], left = b[at[1]];
    const double inverse = a[at[2]];
    for (int n = (at += 4)[-1]; n; n--, at += 2) left -= a[at[0]] * x[at[1]];
    *of = left * inverse;
  }
}

static void subtract_row(int count, double factor, const double *restrict from,
                         double *restrict to) {
  for (int k = 0; k < count; k++) to[k] -= factor * from[k];
}

void vs_matrix_solve_many(const vs_matrix *m, const double *a, int count, double *b, double *x) {
  const int *at = m->forward.at, *end = at + m->forward.count;
  while (at < end) {
    double *of = &b[at[0] * count];
    for (int n = (at += 2)[-1]; n; n--, at += 2)
      subtract_row(count, a[at[0]], &b[at[1] * count], of);
  }
  for (at = m->back.at, end = at + m->back.count; at < end;) {
    double *of = &x[at[0] * count];
    const double inverse = a[at[2]];
    memcpy(of, &b[at[1] * count], (size_t)count * sizeof *of);
    for (int n = (at += 4)[-1]; n; n--, at += 2)
      subtract_row(count, a[at[0]], &x[at[1] * count], of);
    for (int k = 0; k < count; k++) of[k] *= inverse;
  }
}

void vs_matrix_free(vs_matrix *m) {
  free(m->place);
  free(m->eliminate.at);
  free(m->forward.at);
  free(m->back.at);
  free(m->row);
  free(m->column);
  *m = (vs_matrix){0};
}
