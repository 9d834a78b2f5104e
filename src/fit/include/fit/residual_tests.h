/* SPDX-License-Identifier: GPL-3.0-or-later
 * Whether residuals in the order of time look like chance. Where a model lacks something, what it
 * lacks repeats from sample to sample: the signs come in runs, and neighbours resemble each other.
 *
 * - Runs test: how many runs of one sign there are, against what chance would give (A. Wald and
 *   J. Wolfowitz, On a test whether two samples are from the same population, Annals of
 * Mathematical Statistics 11 (1940) 147-162), by its normal approximation.
 * - Ljung and Box: the autocorrelations up to a lag h together (G. M. Ljung and G. E. P. Box, On a
 *   measure of lack of fit in time series models, Biometrika 65 (1978) 297-303):
 *   Q = n (n + 2) sum r_k^2/(n - k), which is distributed as chi-squared with h degrees of
 *   freedom. Fitted unknowns are not subtracted, which errs to the side of no pattern.
 * - Durbin and Watson: d = sum (e_t - e_(t-1))^2/sum e_t^2, 2 where neighbours are independent
 *   (Testing for serial correlation in least squares regression I, Biometrika 37 (1950) 409-428).
 */
#pragma once

#include <stdbool.h>
#include <stddef.h>

typedef struct vs_residual_tests {
  size_t count;
  double rms; /* root mean square; 1 where the errors are as stated */
  long runs;  /* of one sign */
  double runs_expected;
  double runs_probability; /* that chance is as far from what is expected; NaN: too few */
  int lags;                /* h */
  double ljung_box, ljung_box_probability; /* NaN: too few */
  double durbin_watson;
  bool found; /* one of the two probabilities is below 0.001, and the rms above 0.1 */
} vs_residual_tests;

/* Tests residual[count], in the order of time. Fewer than 20 are too few for the two tests. */
vs_residual_tests vs_residual_tests_of(const double *residual, size_t count);
