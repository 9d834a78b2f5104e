/* SPDX-License-Identifier: GPL-3.0-or-later
 * Law "reluctance": the gap alone holds the field. i = lambda z/(2a), F = lambda^2/(4a) (Eqs. 66-73
 * and 81). */
#ifndef VS_ACTUATOR_RELUCTANCE_H
#define VS_ACTUATOR_RELUCTANCE_H

#include "actuator/law.h"

extern const vs_law vs_reluctance_law;

#endif
