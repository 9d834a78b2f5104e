/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "process_copies.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

enum { MOST = VS_COPIES_MOST + 1 };

/* ---- out ---- */

/* The circuit sees the machine by its gap alone. So the copy whose push moves the gap most is the
 * one that shows most of the circuit's memory. */
static int leader_of(const vs_model *m, const double *scale) {
  int leader = 0;
  double most = -1;
  for (int j = 0; j < m->dof; j++) {
    double q[VS_MOST_STATES] = {0};
    q[j] = scale[j];
    double moves = fabs(vs_mechanics_travel(m, q));
    if (moves <= most) continue;
    most = moves;
    leader = j;
  }
  return leader;
}

/* Copies the process, c->count times. Behind it c->inside tells who is who. */
static vs_status fork_all(vs_process_copies *c, vs_error *err) {
  for (int j = 0; j < c->count; j++) {
    vs_status status = vs_child_fork(&c->copy[j], err);
    for (int k = 0; status && k < j; k++) {
      vs_error why = {0};
      vs_process_copies_told told;
      vs_child_hear(&c->copy[k], &told, sizeof told, &why);
    }
    if (status) return status;
    if (c->copy[j].pid) continue;
    c->inside = true;
    c->mine = j;
    return VS_OK;
  }
  return VS_OK;
}

vs_status vs_process_copies_fork(vs_process_copies *c, const vs_model *m, const double *scale,
                                 double part, double *x, vs_error *err) {
  *c = (vs_process_copies){.count = 2 * m->dof, .leader = leader_of(m, scale)};
  for (int j = 0; j < c->count; j++) c->push[j] = part * scale[j];
  vs_status status = fork_all(c, err);
  if (!status && c->inside) x[c->mine] += c->push[c->mine];
  return status;
}

vs_status vs_process_copies_send(vs_process_copies *c, int count, double start[][VS_MOST_STATES],
                                 double *x, vs_error *err) {
  *c = (vs_process_copies){.count = count, .leader = -1};
  vs_status status = fork_all(c, err);
  if (!status && c->inside) memcpy(x, start[c->mine], sizeof *start);
  return status;
}

void vs_process_copies_pass(vs_process_copies *c, const vs_knot *end) {
  double *z = c->told.z[c->periods++];
  memcpy(z, end->x, sizeof end->x);
  if (c->leader >= 0) z[c->count] = end->flux_wb;
  if (c->periods == (c->mine == c->leader ? VS_COPIES_PERIODS : VS_COPIES_PERIODS - 1))
    vs_child_tell(&c->copy[c->mine], &c->told, sizeof c->told);
}

void vs_process_copies_fail(const vs_process_copies *c) {
  vs_child_tell(&c->copy[c->mine], NULL, 0);
}

/* ---- back ---- */

/* The pushes behind a period and behind the next one, in parts of the states' scales; [j] is the
 * column of copy j, the last one the leader's a period later. */
typedef struct pairs {
  double from[MOST][MOST], to[MOST][MOST];
} pairs;

static void take_pair(const vs_process_copies_told *told, int period, const double *orbit,
                      const double *unit, int rows, double *from, double *to) {
  for (int i = 0; i < rows; i++) {
    from[i] = (told->z[period][i] - orbit[i]) / unit[i];
    to[i] = (told->z[period + 1][i] - orbit[i]) / unit[i];
  }
}

/* R of n columns: R from = to. Returns false where the columns do not tell n states apart: the last
 * one adds no more than `lost` to what the others show. */
static bool solve_for_map(const pairs *p, size_t n, double lost, double r[][VS_VARIATION_MOST]) {
  double a[MOST * MOST], least = INFINITY, most = 0;
  size_t order[MOST];
  int sign;
  for (size_t i = 0; i < n; i++) /* by rows, R_i . from_j = to_j[i]: the matrix of the from_j */
    for (size_t j = 0; j < n; j++) a[j * n + i] = p->from[j][i];
  gsl_matrix_view matrix = gsl_matrix_view_array(a, n, n);
  gsl_permutation permutation = {n, order};
  if (gsl_linalg_LU_decomp(&matrix.matrix, &permutation, &sign)) return false;
  for (size_t i = 0; i < n; i++) {
    least = fmin(least, fabs(a[i * n + i]));
    most = fmax(most, fabs(a[i * n + i]));
  }
  if (!(least > lost * most)) return false;
  for (size_t i = 0; i < n; i++) {
    double b[MOST], row[MOST];
    for (size_t j = 0; j < n; j++) b[j] = p->to[j][i];
    gsl_vector_view right = gsl_vector_view_array(b, n), left = gsl_vector_view_array(row, n);
    if (gsl_linalg_LU_solve(&matrix.matrix, &permutation, &right.vector, &left.vector))
      return false;
    memcpy(r[i], row, n * sizeof *row);
  }
  return true;
}

void vs_process_copies_await(const vs_process_copies *c, vs_process_copies_told told[],
                             bool came[]) {
  for (int j = 0; j < c->count; j++) {
    vs_error why = {0};
    came[j] = !vs_child_hear(&c->copy[j], &told[j], sizeof told[j], &why);
  }
}

vs_status vs_process_copies_map(const vs_process_copies *c, double base[][VS_MOST_STATES],
                                const double *scale, double r[][VS_VARIATION_MOST], vs_error *err) {
  vs_process_copies_told told[VS_COPIES_MOST];
  bool came[VS_COPIES_MOST];
  pairs p;
  vs_process_copies_await(c, told, came);
  for (int j = 0; j < c->count; j++) {
    if (!came[j]) return vs_fail(err, VS_RUN, "a copy of the run has failed");
    for (int i = 0; i < c->count; i++) {
      p.from[j][i] = (told[j].z[0][i] - base[0][i]) / scale[i];
      p.to[j][i] = (told[j].z[1][i] - base[1][i]) / scale[i];
    }
  }
  if (!solve_for_map(&p, (size_t)c->count, 0, r))
    return vs_fail(err, VS_RUN, "the derivatives of a period cannot be found");
  for (int i = 0; i < c->count; i++)
    for (int j = 0; j < c->count; j++) r[i][j] *= scale[i] / scale[j];
  return VS_OK;
}

vs_status vs_process_copies_hear(const vs_process_copies *c, const double *orbit,
                                 const double *scale, double lost, vs_multiplier *out, int *found,
                                 vs_error *err) {
  vs_process_copies_told told[VS_COPIES_MOST];
  vs_status status = VS_OK;
  double unit[MOST], ones[MOST];
  double r[VS_VARIATION_MOST][VS_VARIATION_MOST];
  pairs p;
  int n = c->count;
  for (int j = 0; j < n; j++) {
    vs_status own = vs_child_hear(&c->copy[j], &told[j], sizeof told[j], err);
    status = status ? status : own;
  }
  if (status) return status;
  double part = c->push[0] / scale[0]; /* so that the matrices are of order 1 */
  for (int i = 0; i <= n; i++) unit[i] = scale[i] * part;
  for (int j = 0; j < n; j++) take_pair(&told[j], 0, orbit, unit, n + 1, p.from[j], p.to[j]);
  take_pair(&told[c->leader], 1, orbit, unit, n + 1, p.from[n], p.to[n]);
  for (int j = 0; j <= n; j++) ones[j] = 1;
  *found = solve_for_map(&p, (size_t)n + 1, lost, r) ? n + 1 : n;
  if ((*found == n && !solve_for_map(&p, (size_t)n, 0, r)) ||
      !vs_multipliers_find(*found, r, ones, out))
    return vs_fail(err, VS_RUN, "the orbit's multipliers cannot be found");
  return VS_OK;
}
