/* SPDX-License-Identifier: GPL-3.0-or-later
 * Comparisons: the paper's scene, one current pulse at 100 degrees, on each tier against
 * independent solutions; and the machine's modes. */
#ifndef VS_CLI_SINGLE_SHOT_H
#define VS_CLI_SINGLE_SHOT_H

#include "validate/experiment.h"

extern const vs_comparisons vs_single_shot_comparisons;

#endif
