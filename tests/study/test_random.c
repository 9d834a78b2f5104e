/* SPDX-License-Identifier: GPL-3.0-or-later
 * Random numbers by seed and index: evenness, distributions, correlations, and that no number
 * depends on which others are looked up. */
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "study/random.h"
#include "suite.h"

enum { N = 4096 };

static int by_size(const void *a, const void *b) {
  double x = *(const double *)a, y = *(const double *)b;
  return (x > y) - (x < y);
}

/* Largest distance of the sorted sample from its distribution (Kolmogorov and Smirnov). */
static double distance(double *u, size_t n) {
  double largest = 0;
  qsort(u, n, sizeof *u, by_size);
  for (size_t k = 0; k < n; k++)
    largest = fmax(largest, fmax((double)(k + 1) / (double)n - u[k], u[k] - (double)k / (double)n));
  return largest;
}

/* Of x; for two series their correlation as well. */
typedef struct moments {
  double mean, deviation, correlation;
} moments;
static moments moments_of(const double *x, const double *y) {
  double sx = 0, sy = 0, xx = 0, yy = 0, xy = 0;
  for (size_t k = 0; k < N; k++) sx += x[k] / N, sy += y[k] / N;
  for (size_t k = 0; k < N; k++)
    xx += (x[k] - sx) * (x[k] - sx), yy += (y[k] - sy) * (y[k] - sy),
        xy += (x[k] - sx) * (y[k] - sy);
  return (moments){sx, sqrt(xx / N), xy / sqrt(xx * yy)};
}

/* The bounds are four standard errors of 4096 samples: 0.289/64 for the mean, and for the
 * deviation, of a uniform distribution, 0.289*sqrt(0.2)/64; 1/64 for a correlation; 1.63/64 is
 * exceeded by one sample of a hundred (Kolmogorov), 2.2/64 by one of ten thousand. */
static void uniform_by_seed_axis_and_index(void) {
  static double u[6][N];
  for (uint64_t k = 0; k < N; k++) {
    u[0][k] = vs_random_uniform(7, k, 0);
    u[1][k] = vs_random_uniform(7, k, 1);
    u[2][k] = vs_random_uniform(8, k, 0);
    u[3][k] = vs_random_uniform(7, k + 1, 0); /* neighbours in a series */
    u[4][k] = vs_random_uniform(0, 0, k);
    u[5][k] = vs_random_uniform(k, 0, 0);
  }
  for (int a = 0; a < 6; a++) {
    moments m = moments_of(u[a], u[(a + 1) % 6]);
    CLOSE_OF(m.mean, 0.5, 1, 4 * 0.2887 / 64);
    CLOSE_OF(m.deviation, sqrt(1.0 / 12), 1, 4 * 0.2887 * 0.4472 / 64);
    for (int b = 0; b < a; b++) CLOSE_OF(moments_of(u[a], u[b]).correlation, 0, 1, 4.0 / 64);
  }
  for (int a = 0; a < 6; a++) CLOSE_OF(distance(u[a], N), 0, 1, 2.2 / 64);
}

/* One bit of the index turns every bit of the result in half of all cases: 64 x 64 counts of 1024
 * chances each, five standard errors of 16. */
static void every_bit_counts(void) {
  for (int bit = 0; bit < 64; bit++) {
    int turned[64] = {0};
    for (uint64_t k = 0; k < 1024; k++) {
      uint64_t from = vs_random_bits(1, k, 0);
      uint64_t d = vs_random_bits(3, from, 5) ^ vs_random_bits(3, from ^ (uint64_t)1 << bit, 5);
      for (int out = 0; out < 64; out++) turned[out] += (int)(d >> out & 1);
    }
    for (int out = 0; out < 64; out++)
      EXPECT(abs(turned[out] - 512) < 80, "bit %d turns bit %d %d times of 1024", bit, out,
             turned[out]);
  }
}

static void permutations(void) {
  for (uint64_t n = 1; n < 300; n++) {
    bool seen[300] = {0};
    for (uint64_t k = 0; k < n; k++) {
      uint64_t at = vs_random_permuted(1, n, k, n);
      EXPECT(at < n && !seen[at], "%d of %d goes to %d, which is taken", (int)k, (int)n, (int)at);
      if (at < n) seen[at] = true;
    }
  }
  /* Every of the 6 orders of 3 comes up about as often: 1000 of 6000, five standard errors. */
  int orders[27] = {0};
  for (uint64_t seed = 0; seed < 6000; seed++)
    orders[9 * vs_random_permuted(seed, 0, 0, 3) + 3 * vs_random_permuted(seed, 0, 1, 3) +
           vs_random_permuted(seed, 0, 2, 3)]++;
  for (int k = 0; k < 27; k++)
    if (orders[k]) EXPECT(abs(orders[k] - 1000) < 145, "order %d: %d times", k, orders[k]);
}

static void one_point_in_every_part(void) {
  static double x[N], y[N];
  bool seen[N] = {0};
  for (uint64_t k = 0; k < N; k++) {
    x[k] = vs_random_latin(7, k, N, 0);
    y[k] = vs_random_latin(7, k, N, 1);
    size_t part = (size_t)(x[k] * N);
    EXPECT(!seen[part], "two points in part %zu", part);
    seen[part] = true;
  }
  moments m = moments_of(x, y);
  CLOSE_OF(m.correlation, 0, 1, 4.0 / 64);
  CLOSE_OF(m.mean, 0.5, 1, 1e-5); /* within its part each is random: 0.289/4096/64, five of them */
  CLOSE_OF(vs_random_latin(7, 0, 1, 0), 0.5, 1, 0.5);
}

/* Unshifted, point k + 1 is GSL's point k; to the middle of a part of 2^-52. */
static void sobol_is_gsl_s(void) {
  enum { AXES = 7, POINTS = 1500 };
  vs_sobol s;
  double point[AXES];
  CU_ASSERT_FATAL(vs_random_sobol_begin(&s, AXES, POINTS + 1, 1));
  memset(s.shift, 0, sizeof s.shift);
  gsl_qrng *q = gsl_qrng_alloc(gsl_qrng_sobol, AXES);
  for (uint64_t k = 0; k < POINTS; k++) {
    gsl_qrng_get(q, point);
    for (size_t d = 0; d < AXES; d++)
      CLOSE_OF(vs_random_sobol_at(&s, k + 1, d), point[d], 1, 0x1p-52);
  }
  gsl_qrng_free(q);
  CU_ASSERT(!vs_random_sobol_begin(&s, VS_SOBOL_AXES + 1, 10, 1));
  CU_ASSERT(!vs_random_sobol_begin(&s, 1, ((uint64_t)1 << VS_SOBOL_BITS) + 1, 1));
  CU_ASSERT(vs_random_sobol_begin(&s, 0, 10, 1));
}

/* The shift keeps a net a net: of 2^m points one lies in each of 2^m equal parts of every axis, and
 * of the first two axes one in each of 2^a x 2^(m-a) boxes. */
static void a_shifted_net_is_one(void) {
  enum { M = 10 };
  vs_sobol s;
  for (uint64_t seed = 0; seed < 5; seed++) {
    CU_ASSERT_FATAL(vs_random_sobol_begin(&s, 12, 1 << M, seed));
    for (size_t d = 0; d < 12; d++) {
      bool seen[1 << M] = {0};
      for (uint64_t k = 0; k < 1 << M; k++)
        seen[(size_t)(vs_random_sobol_at(&s, k, d) * (1 << M))] = true;
      for (size_t k = 0; k < 1 << M; k++) EXPECT(seen[k], "axis %zu: part %zu is empty", d, k);
    }
    for (int a = 0; a <= M; a++) {
      bool seen[1 << M] = {0};
      for (uint64_t k = 0; k < 1 << M; k++) {
        size_t x = (size_t)(vs_random_sobol_at(&s, k, 0) * (1 << a)),
               y = (size_t)(vs_random_sobol_at(&s, k, 1) * (1 << (M - a)));
        seen[(x << (M - a)) + y] = true;
      }
      for (size_t k = 0; k < 1 << M; k++) EXPECT(seen[k], "%d: box %zu is empty", a, k);
    }
  }
}

/* Mean of the product of 1 + (x - 1/2), which is 1, over 5 axes; rms of 32 seeds, 1024 points.
 * Monte Carlo: sqrt((1 + 1/12)^5 - 1)/32 = 0.0219, and that must come out of it. */
static double error_of(int method, uint64_t seed) {
  enum { AXES = 5, POINTS = 1024 };
  vs_sobol s;
  double sum = 0;
  vs_random_sobol_begin(&s, AXES, POINTS, seed);
  for (uint64_t k = 0; k < POINTS; k++) {
    double f = 1;
    for (size_t d = 0; d < AXES; d++)
      f *= 0.5 + (method == 0   ? vs_random_uniform(seed, k, d)
                  : method == 1 ? vs_random_latin(seed, k, POINTS, d)
                                : vs_random_sobol_at(&s, k, d));
    sum += f / POINTS;
  }
  return sum - 1;
}

static void sobol_beats_latin_beats_monte_carlo(void) {
  double rms[3] = {0};
  for (int method = 0; method < 3; method++) {
    for (uint64_t seed = 0; seed < 32; seed++) rms[method] += pow(error_of(method, seed), 2) / 32;
    rms[method] = sqrt(rms[method]);
  }
  CLOSE_OF(rms[0], 0.0219, 0.0219, 0.5); /* four standard errors of an rms of 32: 4/sqrt(64) */
  EXPECT(rms[1] < rms[0] / 2, "Latin hypercube %.3g, Monte Carlo %.3g", rms[1], rms[0]);
  EXPECT(rms[2] < rms[0] / 20, "Sobol %.3g, Monte Carlo %.3g", rms[2], rms[0]);
  EXPECT(rms[2] < rms[1] / 5, "Sobol %.3g, Latin hypercube %.3g", rms[2], rms[1]);
}

/* ---- distributions ---- */

static void quantiles(void) {
  const vs_spread normal = {VS_SHAPE_NORMAL, 2, 0}, uniform = {VS_SHAPE_UNIFORM, 3, 0},
                  cut = {VS_SHAPE_NORMAL, 2, 1.5};
  CLOSE_OF(vs_random_spread_at(&normal, 0.5), 0, 1, 1e-15);
  CLOSE(vs_random_spread_at(&normal, 0.975), 2 * 1.959963984540054,
        1e-12); /* tables of the normal */
  CLOSE(vs_random_spread_at(&normal, 0.001), -2 * 3.090232306167813, 1e-12);
  CLOSE(vs_random_spread_at(&uniform, 0.25), -1.5, 1e-15);
  CLOSE(vs_random_spread_at(&cut, 1e-300), -3, 1e-12); /* the cut itself */
  CLOSE(vs_random_spread_at(&cut, 1 - 0x1p-53), 3, 1e-12);
  CLOSE_OF(vs_random_spread_at(&cut, 0.5), 0, 1, 1e-15);
  /* The part of a normal between -1.5 and 1 of that between -1.5 and 1.5 */
  double below = gsl_cdf_ugaussian_P(-1.5);
  CLOSE(vs_random_spread_at(&cut, (gsl_cdf_ugaussian_P(1) - below) / (1 - 2 * below)), 2, 1e-12);
}

/* 4096 samples; four standard errors. Truncated at 2: 1 - 2*2*phi(2)/(2*Phi(2) - 1) = 0.77374 of
 * the variance is left. */
static void sampled_distributions(void) {
  static double x[N], y[N];
  const vs_spread normal = {VS_SHAPE_NORMAL, 1, 0}, cut = {VS_SHAPE_NORMAL, 1, 2};
  for (uint64_t k = 0; k < N; k++) {
    x[k] = vs_random_spread_at(&normal, vs_random_uniform(11, k, 0));
    y[k] = vs_random_spread_at(&cut, vs_random_uniform(11, k, 1));
    EXPECT(fabs(y[k]) <= 2, "%g is beyond its cut", y[k]);
  }
  moments m = moments_of(x, y);
  CLOSE_OF(m.mean, 0, 1, 4.0 / 64);
  CLOSE_OF(m.deviation, 1, 1, 4.0 / 64 / sqrt(2));
  CLOSE_OF(m.correlation, 0, 1, 4.0 / 64);
  m = moments_of(y, x);
  CLOSE_OF(m.mean, 0, 1, 4.0 / 64);
  CLOSE_OF(m.deviation, sqrt(0.77374), 1, 4.0 / 64 / sqrt(2));
}

static void correlations(void) {
  static double x[N], y[N], z[N];
  const double matrix[] = {1, 0, 0.8, 0, 1, 0, 0.8, 0, 1}, impossible[] = {1, 1, 1, 1};
  const vs_spread normal = {VS_SHAPE_NORMAL, 3, 0}, uniform = {VS_SHAPE_UNIFORM, 1, 0};
  vs_correlation *c = vs_random_correlation(3, matrix);
  CU_ASSERT_PTR_NOT_NULL_FATAL(c);
  for (uint64_t k = 0; k < N; k++) {
    double u[3], alone[3];
    for (uint64_t d = 0; d < 3; d++) alone[d] = u[d] = vs_random_uniform(5, k, d);
    vs_random_correlate(c, u);
    CU_ASSERT(u[0] == alone[0] && u[1] == alone[1]); /* to the last bit */
    x[k] = vs_random_spread_at(&normal, u[0]);
    y[k] = vs_random_spread_at(&normal, u[2]);
    z[k] = vs_random_spread_at(&uniform, u[1]);
  }
  free(c);
  /* standard error of a correlation rho: (1 - rho^2)/64 */
  CLOSE_OF(moments_of(x, y).correlation, 0.8, 1, 4 * 0.36 / 64);
  CLOSE_OF(moments_of(x, z).correlation, 0, 1, 4.0 / 64);
  CLOSE_OF(moments_of(y, x).deviation, 3, 3, 4.0 / 64 / sqrt(2));
  for (size_t k = 0; k < N; k++) { /* what uniform ones get: 6/pi asin(rho/2) = 0.7859 */
    x[k] = gsl_cdf_ugaussian_P(x[k] / 3);
    y[k] = gsl_cdf_ugaussian_P(y[k] / 3);
  }
  CLOSE_OF(moments_of(x, y).correlation, 0.7859, 1, 4 * 0.38 / 64);
  CLOSE_OF(distance(y, N), 0, 1, 2.2 / 64); /* and they stay uniform */
  CU_ASSERT_PTR_NULL(vs_random_correlation(2, impossible));
}

static const vs_test TESTS[] = {
    {"uniform by seed, axis and index: mean, deviation, correlation",
     uniform_by_seed_axis_and_index},
    {"every bit of the index turns every bit of the result", every_bit_counts},
    {"a permutation is one, and none is preferred", permutations},
    {"Latin hypercube: one point in every part", one_point_in_every_part},
    {"Sobol's points are GSL's", sobol_is_gsl_s},
    {"shifted they are still a net", a_shifted_net_is_one},
    {"a known integral: Sobol, Latin hypercube, Monte Carlo", sobol_beats_latin_beats_monte_carlo},
    {"quantiles of normal, uniform, truncated", quantiles},
    {"samples of them: mean and deviation", sampled_distributions},
    {"correlations, between normal and uniform axes", correlations},
};
VS_SUITE_MAIN("random", TESTS)
