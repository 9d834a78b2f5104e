/* SPDX-License-Identifier: GPL-3.0-or-later
 * Comparisons: snubbers on a switch that stops a recovered current, against closed forms. */
#ifndef VS_CLI_SNUBBER_H
#define VS_CLI_SNUBBER_H

#include "validate/experiment.h"

extern const vs_comparisons vs_snubber_comparisons;

#endif
