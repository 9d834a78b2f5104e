/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/random.h"

#include <assert.h>
#include <gsl/gsl_cdf.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

static uint64_t mix_bits(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ x >> 30) * 0xbf58476d1ce4e5b9u;
  x = (x ^ x >> 27) * 0x94d049bb133111ebu;
  return x ^ x >> 31;
}

uint64_t vs_random_bits(uint64_t seed, uint64_t index, uint64_t axis) {
  return mix_bits(mix_bits(mix_bits(seed) ^ axis) ^ index);
}

/* Returns the middle of one of 2^52 equal pieces; with 2^53 of them the last one's would round
 * to 1. */
static double within(uint64_t bits) {
  return ((double)(bits >> 12) + 0.5) * 0x1p-52;
}

double vs_random_uniform(uint64_t seed, uint64_t index, uint64_t axis) {
  return within(vs_random_bits(seed, index, axis));
}

/* ---- permutation, Latin hypercube ---- */

enum { ROUNDS = 8, SALT_ORDER = 1, SALT_SHIFT }; /* salts keep the uses of one seed apart */

/* A Feistel network permutes the pairs (left, right) of side*side >= count places; where it leads
 * to a place that is not below count, it is applied again until it leads to one that is (Black and
 * Rogaway, CT-RSA 2002). */
uint64_t vs_random_permuted(uint64_t seed, uint64_t axis, uint64_t index, uint64_t count) {
  assert(index < count);
  const uint64_t key = vs_random_bits(seed, SALT_ORDER, axis);
  uint64_t side = (uint64_t)sqrt((double)count);
  while (side * side < count) side++;
  do {
    uint64_t left = index / side, right = index % side;
    for (uint64_t round = 0; round < ROUNDS; round++) {
      uint64_t next = (left + vs_random_bits(key, right, round) % side) % side;
      left = right;
      right = next;
    }
    index = left * side + right;
  } while (index >= count);
  return index;
}

double vs_random_latin(uint64_t seed, uint64_t index, uint64_t count, uint64_t axis) {
  uint64_t part = vs_random_permuted(seed, axis, index, count);
  double x = ((double)part + vs_random_uniform(seed, index, axis)) / (double)count;
  return fmin(x, 1 - 0x1p-53);
}

/* ---- Sobol ---- */

bool vs_random_sobol_begin(vs_sobol *s, size_t axes, uint64_t count, uint64_t seed) {
  *s = (vs_sobol){.axes = axes, .count = count};
  if (axes > VS_SOBOL_AXES || count > (uint64_t)1 << VS_SOBOL_BITS) return false;
  for (size_t d = 0; d < axes; d++) s->shift[d] = vs_random_bits(seed, SALT_SHIFT, d);
  gsl_qrng *q = axes ? vs_checked(gsl_qrng_alloc(gsl_qrng_sobol, (unsigned)axes)) : NULL;
  if (!q) return !axes;
  /* Point k is the sum without carry of the direction numbers at the bits of k ^ k/2: point 2^j has
   * those at bits j and j-1. */
  double point[VS_SOBOL_AXES];
  uint64_t k = 0;
  for (int j = 0; j < VS_SOBOL_BITS && (uint64_t)1 << j < count; j++) {
    for (; k < (uint64_t)1 << j; k++) gsl_qrng_get(q, point);
    for (size_t d = 0; d < axes; d++)
      s->direction[j][d] = (uint32_t)(point[d] * 0x1p30) ^ (j ? s->direction[j - 1][d] : 0);
  }
  gsl_qrng_free(q);
  return true;
}

double vs_random_sobol_at(const vs_sobol *s, uint64_t index, size_t axis) {
  assert(index < s->count && axis < s->axes);
  uint64_t x = 0, gray = index ^ index >> 1;
  for (int j = 0; gray; j++, gray >>= 1)
    if (gray & 1) x ^= s->direction[j][axis];
  return within(x << (64 - VS_SOBOL_BITS) ^ s->shift[axis]);
}

/* ---- distributions ---- */

double vs_random_spread_at(const vs_spread *s, double u) {
  if (s->shape == VS_SHAPE_UNIFORM) return s->width * (2 * u - 1);
  if (s->truncate == 0) return s->width * gsl_cdf_ugaussian_Pinv(u);
  double below = gsl_cdf_ugaussian_P(-s->truncate);
  /* by the half of the distribution in which P is small, where it has all its digits */
  double z = u < 0.5 ? gsl_cdf_ugaussian_Pinv(below + u * (1 - 2 * below))
                     : -gsl_cdf_ugaussian_Pinv(below + (1 - u) * (1 - 2 * below));
  return s->width * fmin(fmax(z, -s->truncate), s->truncate);
}

vs_correlation *vs_random_correlation(size_t axes, const double *matrix) {
  vs_correlation *c = vs_alloc(1, sizeof *c + axes * axes * sizeof *c->factor);
  c->axes = axes;
  memcpy(c->factor, matrix, axes * axes * sizeof *matrix);
  if (!axes) return c;
  gsl_matrix_view m = gsl_matrix_view_array(c->factor, axes, axes);
  if (gsl_linalg_cholesky_decomp1(&m.matrix) == GSL_SUCCESS) return c;
  free(c);
  return NULL;
}

void vs_random_correlate(const vs_correlation *c, double *u) {
  for (size_t i = c->axes;
       i-- >
       0;) { /* from the last to the first, as u[k] with k < i must still be the independent ones */
    const double *row = &c->factor[i * c->axes];
    double z = 0;
    bool alone = true;
    for (size_t k = 0; k < i; k++)
      if (row[k] != 0) {
        alone = false;
        z += row[k] * gsl_cdf_ugaussian_Pinv(u[k]);
      }
    if (alone) continue;
    double p = gsl_cdf_ugaussian_P(z + row[i] * gsl_cdf_ugaussian_Pinv(u[i]));
    u[i] = fmin(fmax(p, 0x1p-53), 1 - 0x1p-53);
  }
}
