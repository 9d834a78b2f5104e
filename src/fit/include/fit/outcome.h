/* SPDX-License-Identifier: GPL-3.0-or-later
 * Everything that a fit came to. */
#ifndef VS_FIT_OUTCOME_H
#define VS_FIT_OUTCOME_H

#include "fit/likelihood.h"
#include "fit/pattern.h"

/* The residuals of one column of a recording. */
typedef struct vs_outcome_column {
  size_t run, column; /* of the run's recording */
  vs_pattern pattern;
} vs_outcome_column;

typedef struct vs_outcome {
  const vs_inquiry *inquiry; /* borrowed */
  vs_prediction prediction;  /* knows how many runs it took */
  const char *slopes;        /* how the slopes at the minimum were found */
  vs_descents descents;
  size_t converged, reached; /* starts that converged, and that came to the least chi2 */
  double next_chi2;          /* of the next higher minimum that was met; NaN: none was */
  vs_estimate estimate;
  vs_likelihood *profiles; /* those that are wanted; owned */
  size_t n_profiles;
  vs_outcome_column *columns; /* owned */
  size_t n_columns;
  bool told; /* the minimum is found with all that it tells; after an error, too, where the budget
                was spent over the profiles, which are then not all there */
} vs_outcome;

/* Fits. Errors: those of vs_descents_search and vs_estimate_at; VS_BUDGET. vs_outcome_free even
 * then. */
vs_status vs_outcome_of(const vs_inquiry *inquiry, vs_outcome *outcome, vs_error *err);
void vs_outcome_free(vs_outcome *outcome);

#endif
