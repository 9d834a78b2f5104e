/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the tiers with a circuit have in common. */
#ifndef VS_ENGINE_COUPLED_H
#define VS_ENGINE_COUPLED_H

#include "engine/sim.h"

/* The keys that they obey and other tiers ignore, as vs_tier has them. */
extern const vs_tier_key vs_coupled_keys[];

#endif
