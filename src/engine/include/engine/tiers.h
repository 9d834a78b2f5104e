/* SPDX-License-Identifier: GPL-3.0-or-later
 * The table of tiers. A tier is a constant in a file of its own; a row of VS_TIER_LIST
 * (engine/setup.h) puts it into this table, into the choices of run.tier and into what --tier
 * takes.
 */
#pragma once

#include "engine/sim.h"

/* In the order of VS_TIER_LIST. */
extern const vs_tier *const vs_tiers_all[VS_TIERS];

/* The tier of that name; NULL: there is none. */
const vs_tier *vs_tiers_find(const char *name);

/* The tier that run.tier: auto takes for a scene that needs a circuit, or for one that does not. */
const vs_tier *vs_tiers_automatic(bool circuit);

/* The name of the one with a circuit, for messages that say what to take instead. */
const char *vs_tiers_circuit(void);

/* The tier whose orbits a scene of this tier has: this one, or where it knows none, the one that
 * run.tier: auto takes for a scene without a circuit. */
const vs_tier *vs_tiers_of_orbit(const vs_tier *tier);

/* Error, at `where`: the tier is not one that knows periodic orbits. who: what wants one; why: why
 * the scene has this tier. */
vs_status vs_tiers_require_orbits(const char *who, const vs_tier *tier, const char *why,
                                  vs_where where, vs_error *err);

/* "auto, analytic, switched, circuit": what may be asked for. */
#define VS_TIER_WORD(id, file, word) ", " word
#define VS_TIER_WORDS "auto" VS_TIER_LIST(VS_TIER_WORD)
extern const char vs_tiers_words[];

/* How the message of a run begins whose coil carries a current at its deck's operating point: it
 * cannot begin because of what its circuit is made of. */
extern const char vs_tiers_on_at_rest[];

/* What a run of the product has: ngspice for its solver, the one-port
 * (engine/macromodel/oneport_macromodel.c) for its macromodel, no rawfile. */
extern const vs_run_order vs_tiers_order;
