/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the tiers with a circuit have in common. */
#pragma once

#include "engine/sim.h"

/* The keys that they obey and other tiers ignore, as vs_tier has them. */
extern const vs_tier_key vs_coupled_keys[];
