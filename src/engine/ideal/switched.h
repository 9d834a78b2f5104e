/* SPDX-License-Identifier: GPL-3.0-or-later
 * The tier "switched": an ideal thyristor and the machine, solved exactly. */
#ifndef VS_ENGINE_SWITCHED_H
#define VS_ENGINE_SWITCHED_H

#include "engine/sim.h"

extern const vs_tier vs_switched_tier;

#endif
