/* SPDX-License-Identifier: GPL-3.0-or-later
 * How warm the winding is where the machine is at work. Its loss on the orbit heats it, its
 * resistance follows, and that changes the orbit; over minutes the loss of a period counts as its
 * mean.
 *
 *   C_w dT_w/dt = P_copper(T_w) - (T_w - T_c)/R_wc
 *   C_c dT_c/dt = P_eddy(T_w) + (T_w - T_c)/R_wc - (T_c - T_a)/R_ca */
#pragma once

#include "run/scene.h"

/* Makes the scene's winding as warm as it becomes on the scene's orbit of so many firing periods
 * without its events: the least temperature above the ambient that keeps itself, to 1 mK. A scene
 * of a tier without orbits takes that of another one (vs_tiers_of_orbit). Where the scene rates
 * coil.t_max and the winding becomes warmer, the scene is warned, with the time that this takes.
 * Where the winding has no thermal resistance, nothing is done. calm: the scene
 * without its events, as if it began at rest, of which all that a run needs is changed here.
 * Errors: those of vs_shooting_find; VS_RUN, the winding has no such temperature, with the time
 * that it takes to run away. */
vs_status vs_warmth_settle(vs_scene *scene, vs_scene *calm, int periods, vs_error *err);
