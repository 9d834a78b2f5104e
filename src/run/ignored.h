/* SPDX-License-Identifier: GPL-3.0-or-later
 * What of a scene a tier would ignore, or could not hold: keys, events, the coil's law. */
#ifndef VS_RUN_IGNORED_H
#define VS_RUN_IGNORED_H

#include "engine/tiers.h"

/* Error, where it stands: the tier would ignore something that the scene with that root says. The
 * name of the deck alone is no such thing, as it says what the tiers stand for. why: why the scene
 * has this tier. A check carries on. */
vs_status vs_ignored_check(const vs_node *root, const vs_setup *setup, const vs_tier *tier,
                           const char *why, vs_error *err);

#endif
