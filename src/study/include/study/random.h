/* SPDX-License-Identifier: GPL-3.0-or-later
 * Random numbers that are looked up, not drawn. Each is a function of seed, case and axis alone, so
 * a case is the same in every order, shard and process. The numbers are made into points that fill
 * a cube evenly, into distributions and into correlated ones. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Returns 64 random bits: the finaliser of splitmix64 (Steele, Lea, Flood, OOPSLA 2014), applied
 * once for each of seed, index and axis. Two indices never give the same bits at the same seed and
 * axis. */
uint64_t vs_random_bits(uint64_t seed, uint64_t index, uint64_t axis);
/* Returns a number that is even between 0 and 1 and never one of those. */
double vs_random_uniform(uint64_t seed, uint64_t index, uint64_t axis);

/* Returns where index goes in a random permutation of 0..count-1; index < count. For tests. */
uint64_t vs_random_permuted(uint64_t seed, uint64_t axis, uint64_t index, uint64_t count);

/* Returns a coordinate of a point of a Latin hypercube. Each axis is cut into `count` equal pieces,
 * and of `count` points one lies in each piece. */
double vs_random_latin(uint64_t seed, uint64_t index, uint64_t count, uint64_t axis);

/* Sobol's sequence as GSL has it, but for two things. Its first point is the origin, which GSL
 * leaves out. And it is shifted at random: where a bit of `shift` is set, that bit of the
 * coordinate is inverted, which keeps the points as even as they were. */
enum { VS_SOBOL_AXES = 40, VS_SOBOL_BITS = 30 }; /* GSL's own limits */
typedef struct vs_sobol {
  size_t axes;
  uint64_t count;
  uint32_t direction[VS_SOBOL_BITS][VS_SOBOL_AXES]; /* direction numbers, in units of 2^-30 */
  uint64_t shift[VS_SOBOL_AXES];                    /* in units of 2^-64 */
} vs_sobol;
/* Prepares up to count points, at most 2^30. Returns false where GSL has not as many points or
 * axes. It takes a time proportional to count, as GSL tells its direction numbers only by its
 * points. */
bool vs_random_sobol_begin(vs_sobol *sobol, size_t axes, uint64_t count, uint64_t seed);
/* Returns a coordinate of point `index`, between 0 and 1 and never one of those. */
double vs_random_sobol_at(const vs_sobol *sobol, uint64_t index, size_t axis);

/* How one axis is distributed about 0. */
typedef enum vs_shape { VS_SHAPE_UNIFORM, VS_SHAPE_NORMAL } vs_shape;
typedef struct vs_spread {
  vs_shape shape;
  double width;    /* uniform: half the width; normal: the standard deviation before truncation */
  double truncate; /* normal: it is cut off at so many standard deviations; 0: it is not cut off */
} vs_spread;
/* Returns the value below which the share u of the distribution lies; 0 < u < 1. */
double vs_random_spread_at(const vs_spread *spread, double u);

/* Correlates axes by their normal scores: each uniform number is turned into that of a normal
 * distribution, those are correlated, and turned back. So each axis keeps its own distribution. The
 * correlation rho that is asked for is Pearson's between normal axes; between uniform ones it
 * becomes 6/pi asin(rho/2), which is its rank correlation. */
typedef struct vs_correlation {
  size_t axes;
  double factor[]; /* [axes][axes], lower triangular, by Cholesky */
} vs_correlation;
/* matrix[axes][axes] is symmetric with ones on its diagonal. NULL: it is not positive definite, and
 * no numbers can be correlated like this. The result is the caller's to free(). */
vs_correlation *vs_random_correlation(size_t axes, const double *matrix);
/* Makes u[axes], which are independent and uniform, correlated ones. An axis without correlation
 * keeps its number to the last bit. */
void vs_random_correlate(const vs_correlation *correlation, double *u);
