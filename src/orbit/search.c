/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "search.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <string.h>

enum { MOST = VS_MOST_STATES };

/* It is found in parts of each state's scale. */
bool vs_search_invert(vs_search *s) {
  const vs_orbit *o = s->orbit;
  size_t n = (size_t)o->count, order[MOST];
  double matrix[MOST * MOST], found[MOST * MOST];
  int sign;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++)
      matrix[i * n + j] = (i == j) - o->monodromy[i][j] * o->scale[j] / o->scale[i];
  gsl_matrix_view a = gsl_matrix_view_array(matrix, n, n);
  gsl_matrix_view b = gsl_matrix_view_array(found, n, n);
  gsl_permutation p = {n, order};
  if (gsl_linalg_LU_decomp(&a.matrix, &p, &sign) || gsl_linalg_LU_invert(&a.matrix, &p, &b.matrix))
    return false;
  for (size_t i = 0; i < n; i++)
    for (size_t j = 0; j < n; j++) s->inverse[i][j] = found[i * n + j] * o->scale[i] / o->scale[j];
  return true;
}

/* A state that hardly moves is told from one that does not move at all to this part of the largest
 * of its kind: of the coordinates, or of their rates. */
static const double UNMOVED = 1e-6;

void vs_search_scale(vs_search *s) {
  double largest[3] = {0};
  int dof = s->count / 2;
  for (int j = 0; j <= s->count; j++) largest[j / dof] = fmax(largest[j / dof], s->peak[j]);
  for (int j = 0; j <= s->count; j++) {
    double least = largest[j / dof] > 0 ? UNMOVED * largest[j / dof] : 1;
    s->scale[j] = fmax(s->peak[j], least);
    s->peak[j] = 0;
  }
}

void vs_search_go_on(vs_search *s, const double *x) {
  memcpy(s->next, x, sizeof s->x);
}

vs_status vs_search_take(vs_search *s, int passes, vs_error *err) {
  return vs_budget_take(s->budget, true, (long)passes * s->orbit->n * s->of_mains, err);
}

void vs_search_begin(vs_search *s, const vs_setup *setup) {
  vs_orbit *orbit = s->orbit;
  *s = (vs_search){.setup = setup,
                   .orbit = orbit,
                   .guessed = s->guessed,
                   .own_phi = s->own_phi,
                   .budget = s->budget,
                   .of_mains = s->of_mains,
                   .next = s->next,
                   .between = s->between,
                   .count = 2 * setup->model.dof};
  vs_corrections_begin(&s->corrections, setup->run.tolerance);
  memcpy(s->x, orbit->x, sizeof s->x);
  vs_search_go_on(s, s->x);
  vs_search_invert(s);
}
