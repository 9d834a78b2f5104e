/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "threat.h"

#include <math.h>

#include "study/random.h"

size_t vs_threat_numbers(const vs_threat *t) {
  return t->n_ranges + (t->with ? t->with->n_ranges : 0);
}

const vs_axis *vs_threat_range(const vs_threat *t, size_t k) {
  return k < t->n_ranges ? &t->range[k] : &t->with->range[k - t->n_ranges];
}

static bool is_continuous(const vs_axis *axis) {
  return axis->ranged && !axis->n_values;
}

bool vs_threat_is_closed(const vs_threat *t) {
  bool closed = true;
  for (size_t k = 0; k < vs_threat_numbers(t); k++)
    closed = closed && !is_continuous(vs_threat_range(t, k));
  return closed;
}

uint64_t vs_threat_combinations(const vs_threat *t) {
  uint64_t count = 1;
  for (size_t k = 0; k < vs_threat_numbers(t); k++) {
    const vs_axis *axis = vs_threat_range(t, k);
    if (!is_continuous(axis) && count <= UINT32_MAX) count *= axis->n_values;
  }
  return count;
}

double vs_threat_value(const vs_axis *axis, double u) {
  if (!is_continuous(axis)) {
    const double n = (double)axis->n_values;
    return axis->value[(size_t)fmin(fmax(floor(u * n), 0), n - 1)];
  }
  return vs_text_rounded(vs_axis_between(axis, u), 12); /* as study.csv and the scene have it */
}

/* The last list runs fastest. */
void vs_threat_listed(const vs_threat *t, uint64_t index, double *value) {
  for (size_t k = vs_threat_numbers(t); k-- > 0;) {
    const vs_axis *axis = vs_threat_range(t, k);
    value[k] =
        is_continuous(axis) ? vs_threat_value(axis, 0.5) : axis->value[index % axis->n_values];
    if (!is_continuous(axis)) index /= axis->n_values;
  }
}

/* FNV-1a, 64 bits: keys are names, so that a threat more or less leaves the others' numbers alone.
 */
uint64_t vs_threat_key(const char *name, const char *key) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const char *s = name; *s; s++) hash = (hash ^ (unsigned char)*s) * 0x100000001b3u;
  hash = (hash ^ '.') * 0x100000001b3u;
  for (const char *s = key; *s; s++) hash = (hash ^ (unsigned char)*s) * 0x100000001b3u;
  return hash;
}

void vs_threat_draw(const vs_threat *t, uint64_t seed, uint64_t index, double *value) {
  for (size_t k = 0; k < vs_threat_numbers(t); k++) {
    const vs_axis *axis = vs_threat_range(t, k);
    value[k] =
        vs_threat_value(axis, vs_random_uniform(seed, index, vs_threat_key(t->name, axis->key)));
  }
}

void vs_threat_stratum(const vs_threat *t, uint64_t seed, uint64_t index, uint64_t count,
                       double *value) {
  vs_threat_listed(t, index % vs_threat_combinations(t), value);
  for (size_t k = 0; k < vs_threat_numbers(t); k++) {
    const vs_axis *axis = vs_threat_range(t, k);
    if (is_continuous(axis))
      value[k] = vs_threat_value(
          axis, vs_random_latin(seed, index, count, vs_threat_key(t->name, axis->key)));
  }
}
