/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/residual_tests.h"

#include <gsl/gsl_cdf.h>
#include <math.h>

enum { FEWEST = 20, MOST_LAGS = 10 };
/* Below this probability a pattern is told of. */
static const double UNLIKELY = 1e-3;
/* Residuals so far below their errors do not matter, whatever their pattern. */
static const double SMALL = 0.1;

/* With n+ residuals above 0, n- below, n of both: the number of runs has the mean 1 + 2 n+ n-/n
 * and the variance 2 n+ n- (2 n+ n- - n)/(n^2 (n - 1)). */
static void test_runs(const double *residual, size_t count, vs_residual_tests *p) {
  double above = 0, below = 0;
  int before = 0;
  for (size_t k = 0; k < count; k++) {
    int sign = (residual[k] > 0) - (residual[k] < 0);
    if (!sign) continue;
    if (sign > 0)
      above++;
    else
      below++;
    p->runs += sign != before;
    before = sign;
  }
  double n = above + below, twice = 2 * above * below;
  p->runs_expected = 1 + twice / n;
  double variance = twice * (twice - n) / (n * n * (n - 1));
  if (count < FEWEST) return;
  p->runs_probability =
      variance > 0
          ? 2 * gsl_cdf_ugaussian_Q(fabs((double)p->runs - p->runs_expected) / sqrt(variance))
          : 0; /* all are of one sign */
}

static void test_lags(const double *residual, size_t count, vs_residual_tests *p) {
  double mean = 0, square = 0, apart = 0, n = (double)count, sum = 0;
  for (size_t k = 0; k < count; k++) mean += residual[k] / n;
  for (size_t k = 0; k < count; k++) square += pow(residual[k] - mean, 2);
  for (size_t k = 1; k < count; k++) apart += pow(residual[k] - residual[k - 1], 2);
  p->durbin_watson = apart / (p->rms * p->rms * n);
  p->lags = count / 5 < MOST_LAGS ? (int)(count / 5) : MOST_LAGS;
  if (count < FEWEST) return;
  for (int lag = 1; lag <= p->lags; lag++) {
    double product = 0;
    for (size_t k = (size_t)lag; k < count; k++)
      product += (residual[k] - mean) * (residual[k - (size_t)lag] - mean);
    sum += pow(product / square, 2) / (n - lag);
  }
  p->ljung_box = n * (n + 2) * sum;
  p->ljung_box_probability = gsl_cdf_chisq_Q(p->ljung_box, p->lags);
}

vs_residual_tests vs_residual_tests_of(const double *residual, size_t count) {
  vs_residual_tests p = {
      .count = count, .runs_probability = NAN, .ljung_box = NAN, .ljung_box_probability = NAN};
  double sum = 0;
  for (size_t k = 0; k < count; k++) sum += residual[k] * residual[k];
  p.rms = count ? sqrt(sum / (double)count) : 0;
  test_runs(residual, count, &p);
  test_lags(residual, count, &p);
  p.found = p.rms > SMALL && (p.runs_probability < UNLIKELY || p.ljung_box_probability < UNLIKELY);
  return p;
}
