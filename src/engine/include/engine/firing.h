/* SPDX-License-Identifier: GPL-3.0-or-later
 * The angle of each firing of a run. Firings are counted from 0. The n-th belongs to a cycle of the
 * mains, which begins at their rising zero crossing, and lies behind that instant by its angle.
 *
 * The angle is firing.angle; or what that is over time, at the instant at which the cycle begins;
 * or what a control decides then. Before, a decision is not known, and a tier must end a step at
 * that instant. */
#pragma once

#include "engine/timeline.h"

/* When the cycle of the n-th firing begins, s. */
double vs_firing_cycle_s(const vs_timeline *timeline, double n);

/* True if all angles are alike: there is no table and no control. */
bool vs_firing_is_even(const vs_timeline *timeline);

/* The angle of the n-th firing, rad; NaN: it is left out. It must be decided. */
double vs_firing_angle(const vs_timeline *timeline, double n);

/* True once the angle of the n-th firing is known. */
bool vs_firing_is_decided(const vs_timeline *timeline, double n);

/* The instant up to which all firings are known: that of the next decision; INFINITY: all are. */
double vs_firing_known_s(const vs_timeline *timeline);

/* The least and the largest angle that a firing of the run may have, rad. */
void vs_firing_range(const vs_timeline *timeline, double range[2]);
