/* SPDX-License-Identifier: GPL-3.0-or-later
 * The linear model (orbit/linear.h) of a machine behind a circuit on tier compiled. A search finds
 * the orbit of both; then the run goes through its period once for each state, moved a little to
 * either side, and for the angle, with the same steps each time. The angle moves all firings of the
 * period. */
#pragma once

#include "orbit/linear.h"

/* Finds it with the usual outputs. orbit: as vs_steady_begin leaves it. Errors: those of
 * vs_linear_check; VS_RUN, no orbit is found, or not by Newton's method for machine and circuit
 * together; a run beside it needs other steps; more states are remembered than there is room for.
 */
vs_status vs_linear_circuit_find(const vs_scene *scene, const vs_orbit *orbit, vs_linear *linear,
                                 vs_error *err);
