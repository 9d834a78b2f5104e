/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "full_newton.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

void vs_full_newton_free(vs_full_newton *f) {
  free(f->phi);
  free(f->scale);
  free(f->step);
  free(f->factors);
  free(f->order);
  free(f->part);
  free(f->from);
  *f = (vs_full_newton){0};
}

static void allocate(vs_full_newton *f, int states) {
  const size_t n = (size_t)states;
  if (f->states == states) return;
  vs_full_newton_free(f);
  f->states = states;
  f->phi = vs_alloc(n * n, sizeof *f->phi);
  f->scale = vs_alloc(n, sizeof *f->scale);
  f->step = vs_alloc(n, sizeof *f->step);
  f->factors = vs_alloc(n * n, sizeof *f->factors);
  f->order = vs_alloc(n, sizeof *f->order);
  f->part = vs_alloc(n, sizeof *f->part);
  f->from = vs_alloc(2 * n, sizeof *f->from);
  f->to = f->from + n;
}

/* ---- Phi ---- */

/* The machine's states, and all that they hang on by more than this, in parts of the sizes. What
 * nothing hangs on, as the square of a fuse's current that is summed up for ever, need not come
 * back. */
static const double NOTHING = 1e-6;

static void find_parts(vs_full_newton *f, int machine) {
  const int n = f->states;
  bool *in = vs_alloc((size_t)n, sizeof *in);
  f->parts = 0;
  for (int k = 0; k < machine; k++) in[f->part[f->parts++] = k] = true;
  for (int k = 0; k < f->parts; k++)
    for (int j = 0; j < n; j++)
      if (!in[j] && fabs(f->phi[f->part[k] * n + j]) > NOTHING) in[f->part[f->parts++] = j] = true;
  free(in);
}

/* A pivot of I - Phi that is less than this beside the largest is rounding: an orbit turns back
 * here, or a charge has no way to anywhere. */
static const double SINGULAR = 1e-13;

static bool factor(vs_full_newton *f) {
  const size_t n = (size_t)f->parts;
  double most = 0, least = INFINITY;
  int sign;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      f->factors[i * n + j] = (i == j) - f->phi[f->part[i] * f->states + f->part[j]];
  gsl_matrix_view a = gsl_matrix_view_array(f->factors, n, n);
  gsl_permutation p = {n, f->order};
  if (gsl_linalg_LU_decomp(&a.matrix, &p, &sign)) return false;
  for (size_t i = 0; i < n; i++) {
    most = fmax(most, fabs(f->factors[i * n + i]));
    least = fmin(least, fabs(f->factors[i * n + i]));
  }
  return least > SINGULAR * most;
}

/* A circuit of capacitors, coils and junctions makes no state so much larger than another: where
 * Phi has more, the steps along which it was taken were too long for a junction. */
static const double HUGE_PHI = 1e9;

static bool take_phi(vs_full_newton *f, const vs_circuit_map *map, int machine) {
  const int n = f->states;
  memcpy(f->scale, map->size, (size_t)n * sizeof *f->scale);
  for (int k = 0; k < n * n; k++) {
    f->phi[k] = map->slope[k] * map->size[k % n] / map->size[k / n];
    if (!(fabs(f->phi[k]) < HUGE_PHI)) return false;
  }
  find_parts(f, machine);
  return factor(f);
}

/* ---- passes ---- */

/* In the first passes the machine is put back to where it was, so that the circuit comes to what it
 * does there. A correction takes each state by LONGEST sizes at most. Phi is found anew, MOST_PHI
 * times at most, behind a correction that is FAR, or has not fallen to SLOW of the one before, or
 * is CLOSE, but for one that was taken NEAR the orbit. */
enum { SETTLES = 2, MOST = 60, MOST_PHI = 12 };
static const double LONGEST = 1, FAR = 0.3, SLOW = 0.05, CLOSE = 1e-5, NEAR = 1e-4;

static void settle(const vs_full_newton *f, vs_circuit_map *map, int machine, double *size) {
  memcpy(map->next, map->end, (size_t)map->states * sizeof *map->next);
  memcpy(map->next, map->start, (size_t)machine * sizeof *map->next);
  map->wants_slope = f->passes == SETTLES;
  *size = INFINITY;
}

/* What no part hangs on goes on from where it is, or, if it forgets within LASTS passes, from where
 * it comes to. */
static const double LASTS = 100;

static void follow_others(const vs_full_newton *f, vs_circuit_map *map) {
  for (int k = 0; k < f->states; k++) {
    const double keeps = f->phi[k * f->states + k];
    map->next[k] = map->end[k];
    if (fabs(1 - keeps) * LASTS > 1)
      map->next[k] = map->start[k] + (map->end[k] - map->start[k]) / (1 - keeps);
  }
}

/* Fills step, by the last Phi, in parts of the sizes, and the largest of it. False: none is found.
 */
static bool find_step(vs_full_newton *f, const vs_circuit_map *map, double *size) {
  const size_t n = (size_t)f->parts;
  for (size_t k = 0; k < n; k++) {
    const int of = f->part[k];
    f->step[k] = (map->end[of] - map->start[of]) / f->scale[of];
  }
  gsl_matrix_view a = gsl_matrix_view_array(f->factors, n, n);
  gsl_vector_view b = gsl_vector_view_array(f->step, n);
  gsl_permutation p = {n, f->order};
  if (gsl_linalg_LU_svx(&a.matrix, &p, &b.vector)) return false;
  *size = 0;
  for (size_t k = 0; k < n; k++)
    if (!(fabs(f->step[k]) <= *size)) *size = fabs(f->step[k]);
  return isfinite(*size);
}

/* Goes so far of the way from `from` to `to`. */
static void go_part(const vs_full_newton *f, vs_circuit_map *map) {
  for (int k = 0; k < f->states; k++)
    map->next[k] = f->to[k] - (1 - f->taken) * (f->to[k] - f->from[k]);
}

/* A whole step leads there. */
static void set_next(const vs_full_newton *f, vs_circuit_map *map) {
  follow_others(f, map);
  for (int k = 0; k < f->parts; k++) {
    const int of = f->part[k];
    map->next[of] = map->start[of] + f->step[k] * f->scale[of];
  }
}

static bool correct(vs_full_newton *f, vs_circuit_map *map, double *size) {
  if (!find_step(f, map, size)) return false;
  set_next(f, map);
  memcpy(f->from, map->start, (size_t)f->states * sizeof *f->from);
  memcpy(f->to, map->next, (size_t)f->states * sizeof *f->to);
  f->taken = *size > LONGEST ? LONGEST / *size : 1;
  go_part(f, map);
  return true;
}

/* Deuflhard's damping (Newton Methods for Nonlinear Problems, section 3.2): behind a part of a
 * correction, the same Phi is to find a smaller one left. Where it does not, as a transformer has
 * come to saturate, a shorter part is tried, which is as a parabola would have it, and SHORTER of
 * this one at most. One that was less than TRUSTED is not judged. */
static const double TRUSTED = 0.05, SHORTER = 0.5, SHORTEST = 0.05;
enum { MOST_SHORTER = 12 };

static bool goes_too_far(vs_full_newton *f, vs_circuit_map *map) {
  double left;
  if (f->shorter == MOST_SHORTER || !(f->taken * f->size > TRUSTED)) return false;
  if (find_step(f, map, &left) && left <= (1 - f->taken / 4) * f->size) return false;
  double bend = 0;
  for (int k = 0; k < f->parts; k++) {
    const int of = f->part[k];
    const double whole = (f->to[of] - f->from[of]) / f->scale[of];
    bend = fmax(bend, fabs(f->step[k] - (1 - f->taken) * whole));
  }
  const double best = f->taken * f->taken * f->size / (2 * bend);
  f->taken *= best > SHORTEST * f->taken ? fmin(best / f->taken, SHORTER) : SHORTEST;
  f->shorter++;
  map->returns = true;
  go_part(f, map);
  return true;
}

bool vs_full_newton_turn(vs_full_newton *f, vs_circuit_map *map, int machine, const double *x,
                         const double *scale, double *size) {
  map->tell(map->solver);
  memcpy(map->end, x, (size_t)machine * sizeof *x);
  memcpy(map->size, scale, (size_t)machine * sizeof *scale);
  allocate(f, map->states);
  f->passes++;
  map->begins = true;
  if (f->passes <= SETTLES) {
    settle(f, map, machine, size);
    return true;
  }
  if (f->passes > SETTLES + 1 && goes_too_far(f, map)) {
    *size = f->size;
    return true;
  }
  f->shorter = 0;
  const bool anew = map->wants_slope;
  f->phis += anew;
  f->failed = f->passes > MOST || f->phis > MOST_PHI ||
              (anew && !(map->knows_slope && take_phi(f, map, machine))) || !correct(f, map, size);
  map->begins = !f->failed;
  if (anew) f->phi_off = *size;
  const bool slow = f->passes > SETTLES + 1 && *size > SLOW * f->size && f->phi_off > NEAR;
  map->wants_slope = *size > FAR || slow || (*size < CLOSE && f->phi_off > NEAR);
  f->size = *size;
  return !f->failed;
}

bool vs_full_newton_close(vs_full_newton *f, vs_circuit_map *map, int machine, const double *x,
                          double *size) {
  map->tell(map->solver);
  memcpy(map->end, x, (size_t)machine * sizeof *x);
  if (map->states != f->states || !find_step(f, map, size)) return false;
  set_next(f, map);
  return true;
}

bool vs_full_newton_ends(const vs_full_newton *f, vs_circuit_map *map, bool closed, bool precise) {
  const bool ends = closed && (!precise || f->phi_off <= NEAR);
  if (closed) map->wants_slope = !ends; /* the run that follows wants none */
  return ends;
}

double vs_full_newton_kept(const vs_full_newton *f, int state) {
  double most = 0;
  for (int k = 0; k < f->states; k++) most = fmax(most, fabs(f->phi[k * f->states + state]));
  return most;
}

/* ---- multipliers ---- */

int vs_full_newton_multipliers(const vs_full_newton *f, int most, vs_multiplier *out) {
  const size_t n = (size_t)f->parts;
  double *matrix = vs_alloc(n * n, sizeof *matrix);
  vs_multiplier *all = vs_alloc(n, sizeof *all);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) matrix[i * n + j] = f->phi[f->part[i] * f->states + f->part[j]];
  const int found = !vs_multipliers_of(f->parts, matrix, all) ? 0
                    : f->parts < most                         ? f->parts
                                                              : most;
  memcpy(out, all, (size_t)found * sizeof *out);
  free(matrix);
  free(all);
  return found;
}
