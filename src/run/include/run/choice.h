/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which tier runs a scene: the one that is asked for, or the simplest that has all it names. */
#ifndef VS_RUN_CHOICE_H
#define VS_RUN_CHOICE_H

#include "engine/tiers.h"

enum { VS_CHOICE_WHY = 256 };

/* Chooses the tier of the scene with that root of its tree, and writes why. named: the word of
 * --tier, which counts before run.tier; NULL: not given. Error: there is no tier of that name;
 * *tier is then NULL. Where run.tier is no tier, which a check carries on from, it is the one with
 * all probes, and why stays as it was. */
vs_status vs_choice_make(const vs_node *root, const vs_setup *setup, const char *named,
                         const vs_tier **tier, char why[VS_CHOICE_WHY], vs_error *err);

/* False: run.tier is no tier, so that it is not known which one is meant. A check carries on. */
bool vs_choice_is_known(const vs_node *root, const vs_setup *setup);

/* True if switches of the scene's deck are modulated, which no ideal tier can do. */
bool vs_choice_is_modulated(const vs_setup *setup);

/* Returns the scene's value of that key, or its machine's. NULL: they do not have the key, or has
 * another word there, or every tier obeys it, as `measure` in a scene that asks for the quality of
 * currents. */
const vs_node *vs_choice_node(const vs_node *root, const vs_setup *setup, const vs_tier_key *key);

#endif
