/* SPDX-License-Identifier: GPL-3.0-or-later
 * Regulator "phase": fires at a phase of the motion, and so keeps pace with the machine's own
 * frequency, whatever the load makes of it. */
#ifndef VS_CONTROL_PHASE_H
#define VS_CONTROL_PHASE_H

#include "control/regulator.h"

extern const vs_regulator vs_phase_regulator;

#endif
