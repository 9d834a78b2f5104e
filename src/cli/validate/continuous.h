/* SPDX-License-Identifier: GPL-3.0-or-later
 * Comparisons: continuous firing on the switched tier (periodic orbits, start-up, the pole cover,
 * the stop), and what the first peak of one pulse depends on. */
#ifndef VS_CLI_CONTINUOUS_H
#define VS_CLI_CONTINUOUS_H

#include "validate/experiment.h"

extern const vs_comparisons vs_continuous_comparisons;

#endif
