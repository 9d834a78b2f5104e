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

static bool correct(vs_full_newton *f, vs_circuit_map *map, double *size) {
  const size_t n = (size_t)f->parts;
  for (size_t k = 0; k < n; k++) {
    const int of = f->part[k];
    f->step[k] = (map->end[of] - map->start[of]) / f->scale[of];
  }
  gsl_matrix_view a = gsl_matrix_view_array(f->factors, n, n);
  gsl_vector_view b = gsl_vector_view_array(f->step, n);
  gsl_permutation p = {n, f->order};
  if (gsl_linalg_LU_svx(&a.matrix, &p, &b.vector)) return false;
  follow_others(f, map);
  *size = 0;
  for (size_t k = 0; k < n; k++)
    if (!(fabs(f->step[k]) <= *size)) *size = fabs(f->step[k]);
  const double part = *size > LONGEST ? LONGEST / *size : 1;
  for (size_t k = 0; k < n; k++)
    map->next[f->part[k]] = map->start[f->part[k]] + part * f->step[k] * f->scale[f->part[k]];
  return isfinite(*size);
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
