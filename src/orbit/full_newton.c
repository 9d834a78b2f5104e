/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "full_newton.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void vs_full_newton_free(vs_full_newton *f) {
  free(f->phi);
  free(f->scale);
  free(f->factors);
  free(f->order);
  *f = (vs_full_newton){0};
}

static void allocate(vs_full_newton *f, int states) {
  const size_t n = (size_t)states;
  if (f->states == states) return;
  vs_full_newton_free(f);
  f->states = states;
  f->phi = vs_alloc(n * n, sizeof *f->phi);
  f->scale = vs_alloc(n, sizeof *f->scale);
  f->factors = vs_alloc(n * n, sizeof *f->factors);
  f->order = vs_alloc(n, sizeof *f->order);
}

/* A pivot of I - Phi that is less than this beside the largest is rounding: the orbit turns back
 * here, or a charge has no way to anywhere. */
static const double SINGULAR = 1e-13;

static bool take_phi(vs_full_newton *f, const vs_circuit_map *map) {
  const size_t n = (size_t)f->states;
  double most = 0, least = INFINITY;
  int sign;
  memcpy(f->scale, map->size, n * sizeof *f->scale);
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) {
      f->phi[i * n + j] = map->slope[i * n + j] * map->size[j] / map->size[i];
      if (!isfinite(f->phi[i * n + j])) {if(getenv("DBG")) fprintf(stderr,"nan %zu %zu %g size %g %g\n",i,j,map->slope[i*n+j],map->size[j],map->size[i]);return false;}
      f->factors[i * n + j] = (i == j) - f->phi[i * n + j];
    }
  gsl_matrix_view a = gsl_matrix_view_array(f->factors, n, n);
  gsl_permutation p = {n, f->order};
  if (gsl_linalg_LU_decomp(&a.matrix, &p, &sign)) return false;
  for (size_t i = 0; i < n; i++) {
    most = fmax(most, fabs(f->factors[i * n + i]));
    least = fmin(least, fabs(f->factors[i * n + i]));
  }
  if(getenv("DBG")) { fprintf(stderr,"least %g most %g\n",least,most); for(size_t i=0;i<n;i++) fprintf(stderr,"%zu size %g diag %g phi %g\n",i,map->size[i],f->factors[i*n+i],f->phi[i*n+i]); }
  return least > SINGULAR * most;
}

/* In the first passes the machine is put back to where it was, so that the circuit comes to what it
 * does there. A correction that is larger than WILD sizes is none; nor is one in the MOST-th pass.
 * Phi is found anew behind a correction that has not fallen to SLOW of the one before, but for one
 * that was taken NEAR the orbit. */
enum { SETTLES = 2, MOST = 30 };
static const double WILD = 3, SLOW = 0.05, NEAR = 1e-4;

static void settle(const vs_full_newton *f, vs_circuit_map *map, int machine, double *size) {
  memcpy(map->next, map->end, (size_t)map->states * sizeof *map->next);
  memcpy(map->next, map->start, (size_t)machine * sizeof *map->next);
  map->wants_slope = f->passes == SETTLES;
  *size = INFINITY;
}

static bool correct(vs_full_newton *f, vs_circuit_map *map, double *size) {
  const size_t n = (size_t)f->states;
  double *step = map->next;
  for (size_t k = 0; k < n; k++) step[k] = (map->end[k] - map->start[k]) / f->scale[k];
  gsl_matrix_view a = gsl_matrix_view_array(f->factors, n, n);
  gsl_vector_view b = gsl_vector_view_array(step, n);
  gsl_permutation p = {n, f->order};
  if (gsl_linalg_LU_svx(&a.matrix, &p, &b.vector)) return false;
  *size = 0;
  for (size_t k = 0; k < n; k++) {
    if (!(fabs(step[k]) <= *size)) *size = fabs(step[k]);
    step[k] = map->start[k] + step[k] * f->scale[k];
  }
  return *size < WILD;
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
  f->failed = f->passes > MOST || (anew && !(map->knows_slope && take_phi(f, map))) ||
              !correct(f, map, size);
  if(getenv("DBG")) { fprintf(stderr,"anew %d knows %d size %g\n",anew,map->knows_slope,*size); for(int k=0;k<f->states;k++) fprintf(stderr,"z%d start %g end %g size %g next %g\n",k,map->start[k],map->end[k],map->size[k],map->next[k]);}
  map->begins = !f->failed;
  if (anew) f->phi_off = *size;
  map->wants_slope = f->passes > SETTLES + 1 && *size > SLOW * f->size && f->phi_off > NEAR;
  f->size = *size;
  return !f->failed;
}

bool vs_full_newton_is_near(const vs_full_newton *f) {
  return f->phi_off <= NEAR;
}

bool vs_full_newton_multipliers(const vs_full_newton *f, int most, vs_multiplier *out, int *found) {
  const size_t n = (size_t)f->states;
  double *matrix = vs_alloc(n * n, sizeof *matrix);
  vs_multiplier *all = vs_alloc(n, sizeof *all);
  memcpy(matrix, f->phi, n * n * sizeof *matrix);
  const bool good = vs_multipliers_of(f->states, matrix, all);
  *found = f->states < most ? f->states : most;
  memcpy(out, all, (size_t)*found * sizeof *out);
  free(matrix);
  free(all);
  return good;
}
