/* SPDX-License-Identifier: GPL-3.0-or-later
 * Comparisons: phase control of R-L on the analytic tier, against the closed form. */
#ifndef VS_CLI_PHASE_CONTROL_H
#define VS_CLI_PHASE_CONTROL_H

#include "validate/experiment.h"

extern const vs_comparisons vs_phase_control_comparisons;

#endif
