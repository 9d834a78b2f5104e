/* SPDX-License-Identifier: GPL-3.0-or-later
 * The periodic orbit of continuous firing on the switched tier. Marching to it would take minutes
 * of simulated time, as the slowest mode decays in 58 s. Newton's method, on the map from the
 * machine's state at the beginning of one firing cycle to that of the next, takes some hundred
 * cycles. */
#ifndef VS_VALIDATE_ORBIT_H
#define VS_VALIDATE_ORBIT_H

#include "validate/experiment.h"

/* Finds the orbit of the experiment's scene and adds p_min, p_max, i_peak, force_peak and power [W]
 * over it. First the scene is marched for its run.until, rounded to whole firing cycles; where
 * several orbits live side by side, that decides which one is found. No guard ends the run where
 * the armature is beyond the pole cover. Errors: those of the scene and of the run; VS_RUN, no
 * orbit is found. */
vs_status vs_orbit_perform(const vs_experiment *experiment, const vs_observer *also,
                           vs_numbers *out, vs_error *err);

/* The same for a scene that was read. */
vs_status vs_orbit_find(const vs_scene *scene, const vs_observer *also, vs_numbers *out,
                        vs_error *err);

#endif
