/* SPDX-License-Identifier: GPL-3.0-or-later
 * Regulator "none": fires at firing.angle, whatever the instruments show. For a scene whose control
 * has an observer alone. */
#ifndef VS_CONTROL_PROFILE_H
#define VS_CONTROL_PROFILE_H

#include "control/regulator.h"

extern const vs_regulator vs_profile_regulator;

#endif
