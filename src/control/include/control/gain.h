/* SPDX-License-Identifier: GPL-3.0-or-later
 * How an observer's gain is found: one plug for each kind. */
#ifndef VS_CONTROL_GAIN_H
#define VS_CONTROL_GAIN_H

#include "control/sampled.h"

/* The values of the keys that not all kinds have. */
typedef struct vs_gain_values {
  double force_noise_n; /* kalman: by how much F is wrong, root mean square in each period */
  double spread; /* kalman: what other forces add to each coordinate's rate, as a part of what the
                    force noise adds to all rates, by energy */
} vs_gain_values;

/* What a gain is found for. */
typedef struct vs_gain_ask {
  const vs_node *map; /* the observer's */
  const vs_gain_values *v;
  const vs_sampled *system;
  const vs_scaled *scaled; /* the same system */
} vs_gain_ask;

typedef struct vs_gain_kind {
  const char *name;
  const char *keys[2]; /* that it alone has; NULL behind the last */
  /* Fills the gain L in scaled states and sensors, states x sensors. Errors: what its keys can be
   * wrong in; there is no such gain. */
  vs_status (*find)(const vs_gain_ask *ask, gsl_matrix *gain, vs_error *err);
} vs_gain_kind;

/* The kinds, in the order of their words; the last has no name. */
#define VS_GAIN_WORDS "kalman|luenberger"
enum { VS_GAIN_KINDS = 2 };
extern const vs_gain_kind vs_gain_kinds[VS_GAIN_KINDS + 1];

#endif
