/* SPDX-License-Identifier: GPL-3.0-or-later
 * When two runs part. Two setups that differ in their events alone make the same run, to the last
 * bit, until the first question of the run to which what drives them answers differently. Here
 * these questions are asked of both: the next edge, the longest step, the voltages of the deck's
 * ports, the instants at which the armature jams or the load changes. */
#pragma once

#include "engine/setup.h"

/* Two instants that are as near, s, count as one: ngspice ends a step on an edge but for rounding,
 * which is far less, and takes no other step that ends as near before an edge. */
extern const double vs_divergence_near_s;

/* Returns the instant, s, behind which the two runs are no longer the same: t = 0 or an edge of
 * both, at which a step of the solver ends. INFINITY: they are the same to run.until. The setups
 * must have the same deck, supply, firing and run, and as many events. */
double vs_divergence_of(const vs_setup *a, const vs_setup *b);
