/* SPDX-License-Identifier: GPL-3.0-or-later
 * The way down to the least sum of squares, chi2, by GSL's trust region (gsl_multifit_nlinear,
 * Levenberg and Marquardt's step, solved by singular values), from one start or from several. It
 * works in the unknowns' coordinate t, in which no step leaves the bounds (fit/unknown.h). */
#ifndef VS_FIT_DESCENTS_H
#define VS_FIT_DESCENTS_H

#include "fit/prediction.h"

struct vs_slopes_kind; /* slopes.h */

/* A minimum of chi2, or where a search ended without one. */
typedef struct vs_descent {
  double s[VS_INQUIRY_UNKNOWNS];
  double chi2;
  double decrement; /* by how much chi2 would fall in one more step of Gauss and Newton */
  bool bound[VS_INQUIRY_UNKNOWNS]; /* the unknown lies on a bound, and chi2 falls beyond it */
  bool converged;
  int iterations;
  char why[256]; /* why it did not converge; empty where it did */
} vs_descent;

/* Who finds minima: the runs, their slopes, and which unknowns stay as they are. */
typedef struct vs_descender {
  vs_prediction *prediction;
  const struct vs_slopes_kind *slopes;
  bool held[VS_INQUIRY_UNKNOWNS];
  bool by_parts; /* first the begin of each recording is fitted, then more and more of it: for
                    starts that are far from the minimum */
} vs_descender;

/* Goes down from start[n_unknowns]. A minimum has converged where its decrement is below 1e-4, or
 * below 1e-4 of chi2: then no unknown is further from the minimum than 1 % of its standard
 * error. The search goes on to 1e-12 as long as GSL finds a step. */
void vs_descent_from(vs_descender *descender, const double *start, vs_descent *descent);

/* Several searches. */
typedef struct vs_descents {
  vs_descent *item; /* [count]; the first begins at the unknowns' starts; owned */
  size_t count;
  double first_chi2; /* at the unknowns' starts; NaN: the run fails there */
  size_t best;       /* the converged one of the least chi2; count: none converged */
} vs_descents;

/* Goes down from the inquiry's starts. The further ones are points of Sobol's sequence between the
 * bounds; an unknown without a bound starts within a factor of 2, or half its scale, of its first
 * start. Errors: VS_INPUT, signs that have no ratio, or an
 * unknown without any effect; VS_RUN, none converged; that of vs_descents_spent. vs_descents_free
 * even then. */
vs_status vs_descents_search(vs_descender *descender, vs_descents *descents, vs_error *err);
/* The budget of the prediction is spent at that stage: says so, VS_BUDGET, and how far the searches
 * came. */
vs_status vs_descents_spent(const vs_descender *descender, const vs_descents *descents,
                            const char *stage, vs_error *err);
void vs_descents_free(vs_descents *descents);

#endif
