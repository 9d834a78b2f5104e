/* SPDX-License-Identifier: GPL-3.0-or-later
 * The way down to the least sum of squares, chi2, by GSL's trust region (gsl_multifit_nlinear,
 * Levenberg and Marquardt's step, solved by singular values), from one start or from several. It
 * works in the unknowns' coordinate t, in which no step leaves the bounds (fit/unknown.h). */
#pragma once

#include "fit/prediction.h"

struct vs_jacobian_kind; /* jacobian.h */

/* A minimum of chi2, or where a search ended without one. */
typedef struct vs_minimization {
  double s[VS_INQUIRY_UNKNOWNS];
  double chi2;
  double decrement; /* by how much chi2 would fall in one more step of Gauss and Newton */
  bool bound[VS_INQUIRY_UNKNOWNS]; /* the unknown lies on a bound, and chi2 falls beyond it */
  bool converged;
  int iterations;
  char why[256]; /* why it did not converge; empty where it did */
} vs_minimization;

/* Who finds minima: the runs, their slopes, and which unknowns stay as they are. */
typedef struct vs_minimizer {
  vs_prediction *prediction;
  const struct vs_jacobian_kind *slopes;
  bool held[VS_INQUIRY_UNKNOWNS];
  bool by_parts; /* first the begin of each recording is fitted, then more and more of it: for
                    starts that are far from the minimum */
} vs_minimizer;

/* Goes down from start[n_unknowns]. A minimum has converged where its decrement is below 1e-4, or
 * below 1e-4 of chi2: then no unknown is further from the minimum than 1 % of its standard
 * error. The search goes on to 1e-12 as long as GSL finds a step. */
void vs_minimization_from(vs_minimizer *descender, const double *start, vs_minimization *descent);

/* Several searches. */
typedef struct vs_minimizations {
  vs_minimization *item; /* [count]; the first begins at the unknowns' starts; owned */
  size_t count;
  double first_chi2; /* at the unknowns' starts; NaN: the run fails there */
  size_t best;       /* the converged one of the least chi2; count: none converged */
} vs_minimizations;

/* Goes down from the inquiry's starts. The further ones are points of Sobol's sequence between the
 * bounds; an unknown without a bound starts within a factor of 2, or half its scale, of its first
 * start. Errors: VS_INPUT, signs that have no ratio, or an
 * unknown without any effect; VS_RUN, none converged; that of vs_minimizations_spent.
 * vs_minimizations_free even then. */
vs_status vs_minimizations_search(vs_minimizer *descender, vs_minimizations *descents,
                                  vs_error *err);
/* The budget of the prediction is spent at that stage: says so, VS_BUDGET, and how far the searches
 * came. */
vs_status vs_minimizations_spent(const vs_minimizer *descender, const vs_minimizations *descents,
                                 const char *stage, vs_error *err);
void vs_minimizations_free(vs_minimizations *descents);
