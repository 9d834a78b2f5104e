/* SPDX-License-Identifier: GPL-3.0-or-later
 * A number that a run gave. */
#ifndef VS_STRESS_VALUE_H
#define VS_STRESS_VALUE_H

#include <stdbool.h>

/* In SI, with the instant it belongs to. */
typedef struct vs_value {
  bool known;         /* false: the run had nothing to measure, as no firing or too few extremes */
  double value, at_s; /* at_s: NaN where the value belongs to no instant */
} vs_value;

#endif
