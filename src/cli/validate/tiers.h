/* SPDX-License-Identifier: GPL-3.0-or-later
 * Comparisons: tier against tier, where both are valid. */
#ifndef VS_CLI_TIERS_H
#define VS_CLI_TIERS_H

#include "validate/experiment.h"

extern const vs_comparisons vs_tiers_comparisons;

#endif
