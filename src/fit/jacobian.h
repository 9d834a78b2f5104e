/* SPDX-License-Identifier: GPL-3.0-or-later
 * How the residuals change with the unknowns: the matrix d residual/d s, by row residual, by column
 * unknown. Who finds it is a plug: exactly, from the derivatives of one run (orbit/tangent.h), or
 * by differences of runs, which take a tenth of the time. */
#pragma once

#include <gsl/gsl_matrix.h>

#include "fit/prediction.h"

typedef struct vs_jacobian_kind {
  const char *name; /* as it is told to the user */
  /* Says whether it can serve all runs and unknowns of the inquiry. */
  bool (*serves)(const vs_prediction *prediction);
  /* Fills column `unknown` of slopes, rows of the data, with d computed/d s at s, where the model
   * says `computed`. Error: the runs that it needs fail. */
  vs_status (*column)(vs_prediction *prediction, size_t unknown, const double *s,
                      const double *computed, double *slope, vs_error *err);
} vs_jacobian_kind;

/* By differences of fourth order, which serve every inquiry. */
extern const vs_jacobian_kind vs_jacobian_exact, vs_jacobian_differences;

/* Fills slopes[n_residuals][n_unknowns] at s, where the model says computed[n_data]. Error: VS_RUN.
 */
vs_status vs_jacobian_fill(const vs_jacobian_kind *kind, vs_prediction *prediction, const double *s,
                           const double *computed, gsl_matrix *slopes, vs_error *err);
