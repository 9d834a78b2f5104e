/* SPDX-License-Identifier: GPL-3.0-or-later
 * Everything that a fit came to. */
#pragma once

#include "fit/estimate.h"
#include "fit/residual_tests.h"

/* A point of a profile likelihood: chi2 where the unknown is held at s and all others are fitted
 * anew. */
typedef struct vs_likelihood_point {
  double s, chi2;
} vs_likelihood_point;

enum { VS_LIKELIHOOD_POINTS = 64 }; /* at most */

/* The profile likelihood of an unknown. Its 95 % interval is where chi2 rises by no more than 3.841
 * above the least: truer than the standard error where the model is not linear in the unknown. */
typedef struct vs_likelihood {
  size_t unknown;
  double least, most; /* ends of the interval, in the unit of the key; NaN: it is open there, as
                         chi2 does not rise so far before the bound, or before the search fails */
  bool lower_minimum; /* a chi2 below that of the estimate was met: it is not the least one */
  vs_likelihood_point point[VS_LIKELIHOOD_POINTS]; /* by rising s */
  size_t count;
} vs_likelihood;

/* The residuals of one column of a recording. */
typedef struct vs_fit_result_column {
  size_t run, column; /* of the run's recording */
  vs_residual_tests pattern;
} vs_fit_result_column;

typedef struct vs_fit_result {
  const vs_fit_problem *inquiry; /* borrowed */
  vs_prediction prediction;      /* knows how many runs it took */
  const char *slopes;            /* how the slopes at the minimum were found */
  vs_minimizations descents;
  size_t converged, reached; /* starts that converged, and that came to the least chi2 */
  double next_chi2;          /* of the next higher minimum that was met; NaN: none was */
  vs_estimate estimate;
  vs_likelihood *profiles; /* those that are wanted; owned */
  size_t n_profiles;
  vs_fit_result_column *columns; /* owned */
  size_t n_columns;
  bool told; /* the minimum is found with all that it tells; after an error, too, where the budget
                was spent over the profiles, which are then not all there */
} vs_fit_result;

/* Fits. Errors: those of vs_minimizations_search and vs_estimate_at; VS_BUDGET. vs_fit_result_free
 * even then. */
vs_status vs_fit_result_of(const vs_fit_problem *inquiry, vs_fit_result *outcome, vs_error *err);
void vs_fit_result_free(vs_fit_result *outcome);
