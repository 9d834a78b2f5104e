/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "compare.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

static const struct {
  const char *name;
  int channel, column;
} PROBE[COMPARED] = {{"p", VS_CH_P, ORACLE_P}, {"u", VS_CH_U, ORACLE_U},
                     {"w", VS_CH_W, ORACLE_W}, {"phi", VS_CH_PHI, ORACLE_PHI},
                     {"i", VS_CH_I, ORACLE_I}, {"force", VS_CH_FORCE, ORACLE_FORCE}};

/* A sample and the end of a run that falls on it may differ by it. */
static const double ROUNDING_S = 1e-13;

comparison *compare_with_run(const oracle_scene *scene) {
  comparison *c = vs_alloc(1, sizeof *c);
  *c = (comparison){.rows = scene->rows, .sample_s = scene->sample_s, .filling = true};
  c->table = vs_alloc(scene->rows * ORACLE_COLUMNS, sizeof *c->table);
  return c;
}

static double *cell_of(const comparison *c, size_t row, int k) {
  return &c->table[row * ORACLE_COLUMNS + (size_t)PROBE[k].column];
}

void compare_again(comparison *c) {
  for (size_t n = 0; n < c->rows && c->filling; n++)
    for (int k = 0; k < COMPARED; k++) c->peak[k] = fmax(c->peak[k], fabs(*cell_of(c, n, k)));
  c->filling = false;
  c->next = 0;
  memset(c->worst, 0, sizeof c->worst);
}

comparison *compare_with(const oracle_scene *scene) {
  comparison *c = compare_with_run(scene);
  bool solved = oracle_run(scene, c->table, NULL);
  compare_again(c);
  if (solved) return c;
  compare_free(c);
  return NULL;
}

void compare_free(comparison *c) {
  if (c) free(c->table);
  free(c);
}

vs_status compare_accept(void *ctx, const vs_step *step, vs_error *err) {
  (void)err;
  comparison *c = ctx;
  double y[VS_CH_MOST], end = step->to->t_s;
  for (; c->next < c->rows; c->next++) {
    double sample = (double)c->next * c->sample_s;
    bool last = c->next + 1 == c->rows;
    if (sample > end + (last ? ROUNDING_S : 0)) break;
    vs_step_groups_at(step, fmin(sample, end), 0, y);
    for (int k = 0; k < COMPARED; k++) {
      double *expected = cell_of(c, c->next, k);
      if (c->filling) *expected = y[PROBE[k].channel];
      double error = fabs(y[PROBE[k].channel] - *expected);
      c->worst[k] = isnan(error) ? INFINITY : fmax(c->worst[k], error);
    }
  }
  return VS_OK;
}

double compare_error(const comparison *c, const char **which) {
  double worst = -1;
  for (int k = 0; k < COMPARED; k++) {
    double error = c->worst[k] / c->peak[k];
    if (error <= worst) continue;
    worst = error;
    if (which) *which = PROBE[k].name;
  }
  return c->next == c->rows ? worst : INFINITY;
}
