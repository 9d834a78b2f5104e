/* SPDX-License-Identifier: GPL-3.0-or-later
 * Regulator "amplitude": a PI controller that holds half the peak to peak value of a sensor at a
 * set point. */
#ifndef VS_CONTROL_AMPLITUDE_H
#define VS_CONTROL_AMPLITUDE_H

#include "control/regulator.h"

extern const vs_regulator vs_amplitude_regulator;

#endif
