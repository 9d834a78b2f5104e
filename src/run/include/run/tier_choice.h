/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which tier runs a scene: the one that is asked for, or the simplest that has all it names; and
 * whether that tier would ignore something that the scene says. */
#pragma once

#include "engine/tiers.h"

enum { VS_TIER_CHOICE_WHY = 256 };

/* Chooses the tier of the scene with that root of its tree, and writes why. named: the word of
 * --tier, which counts before run.tier; NULL: not given. Error: there is no tier of that name;
 * *tier is then NULL. Where run.tier is no tier, which a check carries on from, it is the one with
 * all probes, and why stays as it was. */
vs_status vs_tier_choice_make(const vs_node *root, const vs_setup *setup, const char *named,
                              const vs_tier **tier, char why[VS_TIER_CHOICE_WHY], vs_error *err);

/* False: run.tier is no tier, so that it is not known which one is meant. A check carries on. */
bool vs_tier_choice_is_known(const vs_node *root, const vs_setup *setup);

/* Error, where it stands: the tier would ignore something that the scene with that root says. The
 * name of the deck alone is no such thing, as it says what the tiers stand for. why: why the scene
 * has this tier. A check carries on. */
vs_status vs_tier_choice_check(const vs_node *root, const vs_setup *setup, const vs_tier *tier,
                               const char *why, vs_error *err);
