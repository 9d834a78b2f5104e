/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machines that come with the program besides the conveyor, and the laws of actuators. */
#ifndef VS_CLI_MACHINES_H
#define VS_CLI_MACHINES_H

#include "validate/experiment.h"

extern const vs_comparisons vs_machines_comparisons;

#endif
