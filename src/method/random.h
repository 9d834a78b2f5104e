/* SPDX-License-Identifier: GPL-3.0-or-later
 * Random numbers that are looked up, not drawn: each is a function of seed, case, axis and nothing
 * else, so that a case is the same in every order, shard and process. What they are made into:
 * points that fill a cube evenly, distributions, correlations. */
#ifndef VS_METHOD_RANDOM_H
#define VS_METHOD_RANDOM_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* 64 random bits: the finaliser of splitmix64 (Steele, Lea, Flood, OOPSLA 2014), once for each
 * number that it is asked by. Two indices never give the same bits at the same seed and axis. */
uint64_t vs_random_bits(uint64_t seed, uint64_t index, uint64_t axis);
double vs_random_uniform(uint64_t seed, uint64_t index,
                         uint64_t axis); /* within 0..1, ends never */

/* Where index goes in a random permutation of 0..count-1; index < count. */
uint64_t vs_random_permuted(uint64_t seed, uint64_t axis, uint64_t index, uint64_t count);

/* Latin hypercube: of count points one lies in each of count equal parts of every axis. */
double vs_random_latin(uint64_t seed, uint64_t index, uint64_t count, uint64_t axis);

/* Sobol's sequence by GSL, its first point the origin (which GSL leaves out), shifted: the bits of
 * each coordinate are reversed where those of a random number are set, which keeps its evenness. */
enum { VS_SOBOL_AXES = 40, VS_SOBOL_BITS = 30 }; /* GSL's */
typedef struct vs_sobol {
  size_t axes;
  uint64_t count;
  uint32_t direction[VS_SOBOL_BITS][VS_SOBOL_AXES]; /* as parts of 2^30 */
  uint64_t shift[VS_SOBOL_AXES];                    /* as parts of 2^64 */
} vs_sobol;
/* For up to count points, at most 2^30. false: more points or axes than there are. Takes a time
 * that goes with count, once: GSL's sequence is asked for its direction numbers. */
bool vs_random_sobol_begin(vs_sobol *sobol, size_t axes, uint64_t count, uint64_t seed);
double vs_random_sobol_at(const vs_sobol *sobol, uint64_t index,
                          size_t axis); /* within 0..1, ends never */

/* Distribution of one axis, about 0. */
typedef enum vs_shape { VS_SHAPE_UNIFORM, VS_SHAPE_NORMAL } vs_shape;
typedef struct vs_spread {
  vs_shape shape;
  double width;    /* uniform: half of it; normal: the standard deviation, before truncation */
  double truncate; /* normal: to so many of these on either side; 0: nowhere */
} vs_spread;
/* The value below which the part u of all lies; 0 < u < 1. */
double vs_random_spread_at(const vs_spread *spread, double u);

/* Correlated axes: of the normal scores, so the correlation asked for is Pearson's between normal
 * axes; uniform ones get 6/pi asin(rho/2), and keep their own distribution. */
typedef struct vs_correlation {
  size_t axes;
  double factor[]; /* axes*axes: lower triangular, by Cholesky */
} vs_correlation;
/* matrix: axes*axes, symmetric, ones on its diagonal. NULL: no such correlations are possible, it
 * is not positive definite. free() it. */
vs_correlation *vs_random_correlation(size_t axes, const double *matrix);
/* Makes independent uniform numbers correlated ones. Axes without correlation keep theirs to the
 * last bit. */
void vs_random_correlate(const vs_correlation *correlation, double *u);

#endif
