/* SPDX-License-Identifier: GPL-3.0-or-later
 * The periodic orbit of continuous firing on the switched tier. Marching takes minutes of simulated
 * time (the slowest mode decays in 58 s); Newton's method on the map from the machine's state at
 * one firing cycle's begin to the next takes some hundred cycles. */
#ifndef VS_VALIDATE_ORBIT_H
#define VS_VALIDATE_ORBIT_H

#include "validate/experiment.h"

/* Gives p_min, p_max, i_peak, force_peak, power [W]. The scene's run.until is how long it marches
 * first, a whole number of firing cycles: where several orbits live side by side that decides which
 * one is found. No guard ends the run where the armature is beyond the pole cover. Errors: the
 * scene's, the run's; VS_RUN, no orbit is found. */
vs_status vs_orbit_perform(const vs_experiment *experiment, const vs_observer *also,
                           vs_numbers *out, vs_error *err);

/* The same of a scene that was read. */
vs_status vs_orbit_find(vs_scene *scene, const vs_observer *also, vs_numbers *out, vs_error *err);

#endif
