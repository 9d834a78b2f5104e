/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "reduction.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* A circuit with more unknowns is left as it is: the search goes through all rows and columns. */
enum { MOST_UNKNOWNS = 300 };

typedef struct reducing {
  vs_equations *e;
  int n, values;
  double *a;      /* n x n: df/dy of what is linear */
  double *b;      /* n x values: f by what drives */
  int *value;     /* which of the values each source of the equations' has */
  int *source;    /* a source that has it, of each */
  int *row_of;    /* of each column: the row that gives it; -1: it stays */
  bool *row_ends; /* a row may give no unknown, or it has done so */
  bool *stays;    /* a column does */
  bool *wanted;   /* by a device or as a signal */
  int *in_row, *in_column;
} reducing;

/* ---- what there is ---- */

static void want(bool *list, int k) {
  if (k >= 0) list[k] = true;
}

static void note_device(reducing *q, const vs_compiled_device *d) {
  for (int k = 0; k < 3; k++) {
    want(q->wanted, d->pin[k]);
    if (d->kind != VS_DEVICE_PROGRAM || d->branch < 0) want(q->row_ends, d->row[k]);
  }
  want(q->row_ends, d->branch);
  for (int k = 0; k < 2; k++) {
    want(q->row_ends, d->charge[k]);
    want(q->wanted, d->control[k]);
  }
  for (int k = 0; d->kind == VS_DEVICE_PROGRAM && k < d->program.signals; k++) {
    want(q->wanted, d->program.signal[k].plus);
    want(q->wanted, d->program.signal[k].minus);
  }
}

static bool is_same_value(const vs_compiled_source *a, const vs_compiled_source *b) {
  return a->port == b->port && a->course == b->course;
}

static void note_sources(reducing *q) {
  const vs_equations *e = q->e;
  for (int k = 0; k < e->sources; k++) {
    int v = 0;
    while (v < q->values && !is_same_value(&e->source[q->source[v]], &e->source[k])) v++;
    if (v == q->values) q->source[q->values++] = k;
    q->value[k] = v;
  }
  q->b = vs_alloc((size_t)q->n * (size_t)(q->values + 1), sizeof *q->b);
  for (int k = 0; k < e->sources; k++)
    q->b[e->source[k].row * q->values + q->value[k]] += e->source[k].factor;
}

static void note_all(reducing *q, const int *signal, size_t signals) {
  const vs_equations *e = q->e;
  const int n = q->n;
  for (int k = 0; k < n; k++) q->row_of[k] = -1;
  for (int k = 0; k < e->linears; k++)
    q->a[e->linear[k].row * n + e->linear[k].column] += e->linear[k].value;
  for (int k = 0; k < e->masses; k++)
    q->row_ends[e->mass[k].row] = q->stays[e->mass[k].column] = true;
  for (int k = 0; k < e->states; k++) q->row_ends[e->machine + k] = q->stays[e->machine + k] = true;
  if (e->states) want(q->stays, e->flux);
  for (int k = 0; k < e->devices; k++) note_device(q, &e->device[k]);
  for (size_t k = 0; k < signals; k++) want(q->wanted, signal[k]);
  note_sources(q);
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) {
      q->in_row[i] += q->a[i * n + j] != 0;
      q->in_column[j] += q->a[i * n + j] != 0;
    }
}

/* ---- the unknowns that go ---- */

static bool is_driven(const reducing *q, int row) {
  bool is = false;
  for (int v = 0; v < q->values; v++) is = is || q->b[row * q->values + v] != 0;
  return is;
}

static bool wanted_has(const reducing *q, int column) {
  for (int j = 0; j < q->n; j++)
    if (q->row_of[j] >= 0 && q->wanted[j] && q->a[q->row_of[j] * q->n + column] != 0) return true;
  return false;
}

/* A pivot is at least this part of its row. What is wanted may have so many shares. An unknown goes
 * where that fills no more places of the matrix than it empties. */
static const double THRESHOLD = 0.01;
enum { MOST_SHARES = 4 };

static bool find_next(const reducing *q, int *row, int *column) {
  int best = 0; /* places won */
  bool found = false;
  for (int i = 0; i < q->n; i++) {
    if (q->row_ends[i] || !q->in_row[i]) continue;
    const double *a = q->a + i * q->n;
    const bool driven = is_driven(q, i);
    double most = 0;
    for (int j = 0; j < q->n; j++) most = fmax(most, fabs(a[j]));
    for (int j = 0; j < q->n; j++) {
      const int others = q->in_row[i] - 1, rows = q->in_column[j] - 1;
      const int wins = 1 + others + rows - others * rows;
      if (q->stays[j] || q->row_of[j] >= 0 || !(fabs(a[j]) >= THRESHOLD * most) || a[j] == 0)
        continue;
      if (q->wanted[j] && (driven || others > MOST_SHARES)) continue;
      if (wins < 0 || (found && wins <= best) || (driven && wanted_has(q, j))) continue;
      best = wins;
      *row = i;
      *column = j;
      found = true;
    }
  }
  return found;
}

static void subtract_row(reducing *q, int from, int row, double factor) {
  const int n = q->n;
  for (int j = 0; j < n; j++) {
    const double by = factor * q->a[row * n + j], was = q->a[from * n + j];
    if (by == 0) continue;
    double *value = &q->a[from * n + j];
    *value = fabs(was - by) <= 4 * DBL_EPSILON * fabs(was) ? 0 : was - by;
    q->in_row[from] += (*value != 0) - (was != 0);
    q->in_column[j] += (*value != 0) - (was != 0);
  }
  for (int v = 0; v < q->values; v++)
    q->b[from * q->values + v] -= factor * q->b[row * q->values + v];
  q->e->level[from] -= factor * q->e->level[row];
}

/* The row gives the column's unknown. It stays in the others' way only if that is wanted. */
static void eliminate(reducing *q, int row, int column) {
  const int n = q->n;
  const double pivot = q->a[row * n + column];
  q->row_ends[row] = true;
  for (int i = 0; i < n; i++)
    if (i != row && q->a[i * n + column] != 0) {
      subtract_row(q, i, row, q->a[i * n + column] / pivot);
      if (q->a[i * n + column] != 0) {
        q->a[i * n + column] = 0;
        q->in_row[i]--;
        q->in_column[column]--;
      }
    }
  q->row_of[column] = row;
  q->a[row * n + column] = 0;
  for (int j = 0; j < n; j++) {
    double *value = &q->a[row * n + j];
    if (!q->wanted[column] && *value != 0) q->in_column[j]--;
    *value = q->wanted[column] ? *value / -pivot : 0;
  }
  q->e->level[row] /= -pivot;
}

/* ---- the equations that are left ---- */

typedef struct numbers {
  int *row, *column; /* the new one of each old one; -1: it is gone */
} numbers;

/* The only share of an unknown that is another one's equal; -1: it has others. */
static int equal_of(const reducing *q, int column) {
  const double *a = q->a + q->row_of[column] * q->n;
  int other = -1;
  if (q->e->level[q->row_of[column]] != 0) return -1;
  for (int j = 0; j < q->n; j++)
    if (a[j] != 0) {
      if (a[j] != 1 || other >= 0) return -1;
      other = j;
    }
  return other;
}

static bool has_shares(const reducing *q, int column) {
  for (int j = 0; j < q->n; j++)
    if (q->a[q->row_of[column] * q->n + j] != 0) return true;
  return false;
}

/* An unknown that equals another one has its number. */
static void number_anew(reducing *q, numbers *to) {
  vs_equations *e = q->e;
  bool *gives = vs_alloc((size_t)q->n, sizeof *gives);
  e->rows = 0;
  for (int j = 0; j < q->n; j++) {
    to->column[j] = q->row_of[j] < 0 ? e->rows++ : -1;
    if (q->row_of[j] >= 0) gives[q->row_of[j]] = true;
  }
  e->n = e->rows;
  for (int constant = 0; constant < 2; constant++) {
    e->follow = e->n;
    for (int j = 0; j < q->n; j++) {
      if (q->row_of[j] < 0 || !q->wanted[j] || has_shares(q, j) == constant) continue;
      const int equal = equal_of(q, j);
      to->column[j] = equal >= 0 ? to->column[equal] : e->n++;
    }
  }
  for (int i = 0, row = 0; i < q->n; i++) to->row[i] = gives[i] ? -1 : row++;
  free(gives);
}

static void put_entry(vs_entry **list, int *count, vs_entry entry) {
  *list = vs_alloc_grow(*list, (size_t)*count, sizeof **list);
  (*list)[(*count)++] = entry;
}

static int old_number(const reducing *q, const numbers *to, int column) {
  int k = 0;
  while (k < q->n && to->column[k] != column) k++;
  return k;
}

static void put_linear(reducing *q, const numbers *to) {
  vs_equations *e = q->e;
  const int n = q->n;
  int shares = 0;
  e->linears = 0;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n && to->row[i] >= 0; j++)
      if (q->a[i * n + j] != 0)
        put_entry(&e->linear, &e->linears,
                  (vs_entry){to->row[i], to->column[j], -1, q->a[i * n + j]});
  e->first = vs_alloc((size_t)(e->n - e->rows) + 1, sizeof *e->first);
  e->rest = vs_alloc((size_t)(e->n - e->rows) + 1, sizeof *e->rest);
  for (int other = e->rows; other < e->n; other++) {
    const int row = q->row_of[old_number(q, to, other)];
    e->rest[other - e->rows] = e->level[row];
    for (int j = 0; j < n; j++)
      if (q->a[row * n + j] != 0)
        put_entry(&e->share, &shares, (vs_entry){other, to->column[j], -1, q->a[row * n + j]});
    e->first[other - e->rows + 1] = shares;
  }
}

static void put_sources(reducing *q, const numbers *to) {
  vs_equations *e = q->e;
  vs_compiled_source *list = NULL;
  int count = 0;
  for (int v = 0; v < q->values; v++)
    for (int i = 0; i < q->n; i++) {
      const double factor = q->b[i * q->values + v];
      if (to->row[i] < 0 || factor == 0) continue;
      list = vs_alloc_grow(list, (size_t)count, sizeof *list);
      list[count] = e->source[q->source[v]];
      list[count].row = to->row[i];
      list[count++].factor = factor;
    }
  free(e->source);
  e->source = list;
  e->sources = count;
}

static void renumber(const int *to, int *k) {
  if (*k >= 0) *k = to[*k];
}

static void renumber_device(const numbers *to, vs_compiled_device *d) {
  for (int k = 0; k < 3; k++) {
    renumber(to->row, &d->row[k]);
    renumber(to->column, &d->pin[k]);
  }
  renumber(to->row, &d->branch);
  for (int k = 0; k < 2; k++) {
    renumber(to->row, &d->charge[k]);
    renumber(to->column, &d->control[k]);
  }
  for (int k = 0; d->kind == VS_DEVICE_PROGRAM && k < d->program.signals; k++) {
    renumber(to->column, &d->program.signal[k].plus);
    renumber(to->column, &d->program.signal[k].minus);
  }
}

static void put_names(reducing *q, const numbers *to) {
  vs_equations *e = q->e;
  char **name = vs_alloc((size_t)e->n, sizeof *name);
  vs_names_free(&e->number);
  e->number = (vs_names){0};
  for (int k = 0; k < q->n; k++) {
    const int now = to->column[k];
    if (now >= 0) vs_names_put(&e->number, e->name[k], strlen(e->name[k]), (size_t)now);
    if (now >= 0 && (q->row_of[k] < 0 || now >= e->rows))
      name[now] = e->name[k];
    else
      free(e->name[k]);
  }
  free(e->name);
  e->name = name;
}

static void put_all(reducing *q) {
  vs_equations *e = q->e;
  const size_t n = (size_t)q->n;
  numbers to = {vs_alloc(n, sizeof(int)), vs_alloc(n, sizeof(int))};
  number_anew(q, &to);
  put_linear(q, &to);
  put_sources(q, &to);
  for (int k = 0; k < e->masses; k++) {
    renumber(to.row, &e->mass[k].row);
    renumber(to.column, &e->mass[k].column);
  }
  for (int k = 0; k < q->n; k++) {
    if (to.row[k] < 0) continue;
    e->level[to.row[k]] = e->level[k];
    e->charge[to.row[k]] = e->charge[k];
  }
  for (int k = 0; k < e->devices; k++) renumber_device(&to, &e->device[k]);
  if (e->states) renumber(to.column, &e->flux);
  put_names(q, &to);
  free(to.row);
  free(to.column);
}

void vs_reduction_make(vs_equations *e, const int *signal, size_t signals) {
  const size_t n = (size_t)e->n, sources = (size_t)e->sources + 1;
  int row, column;
  if (e->n > MOST_UNKNOWNS) return;
  reducing q = {.e = e,
                .n = e->n,
                .a = vs_alloc(n * n, sizeof *q.a),
                .value = vs_alloc(sources, sizeof *q.value),
                .source = vs_alloc(sources, sizeof *q.source),
                .row_of = vs_alloc(n, sizeof *q.row_of),
                .row_ends = vs_alloc(n, sizeof *q.row_ends),
                .stays = vs_alloc(n, sizeof *q.stays),
                .wanted = vs_alloc(n, sizeof *q.wanted),
                .in_row = vs_alloc(n, sizeof *q.in_row),
                .in_column = vs_alloc(n, sizeof *q.in_column)};
  note_all(&q, signal, signals);
  while (find_next(&q, &row, &column)) eliminate(&q, row, column);
  put_all(&q);
  vs_equations_make_pattern(e);
  free(q.a);
  free(q.b);
  free(q.value);
  free(q.source);
  free(q.row_of);
  free(q.row_ends);
  free(q.stays);
  free(q.wanted);
  free(q.in_row);
  free(q.in_column);
}
