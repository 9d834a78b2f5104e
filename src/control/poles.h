/* SPDX-License-Identifier: GPL-3.0-or-later
 * The poles that a scene wants an observer's error to have, as its key `poles` has them.
 *
 *   poles: [-200, [-150, 300], [-150, -300], ...]
 *
 * A real pole is a number in 1/s; a complex one a pair of its real part in 1/s and its imaginary
 * part in rad/s, and its conjugate stands in the list, too. */
#ifndef VS_CONTROL_POLES_H
#define VS_CONTROL_POLES_H

#include "control/sampled.h"

/* Fills `pole` with one for each state of the system, each pair one after the other, that with the
 * positive imaginary part first. The list in the observer's map may have as many; or one for each
 * coordinate and each rate, and the sensors' low-passes keep their own poles. Errors: no list, or
 * one of another length; a pole that is none, does not decay, or is faster than half the rate of
 * samples; a set that is not its own conjugate; a pole that stands more often than there are
 * sensors. */
vs_status vs_poles_read(const vs_node *map, const vs_sampled *system, vs_pole pole[VS_SAMPLED_MOST],
                        vs_error *err);

/* How far the poles that are reached are from those wanted: the largest distance, relative to its
 * pole's size. */
double vs_poles_missed(const vs_pole *wanted, const vs_pole *reached, int count);

#endif
