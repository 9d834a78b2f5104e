/* SPDX-License-Identifier: GPL-3.0-or-later
 * The periodic orbit of continuous firing on the switched tier. Marching to the conveyor's would
 * take minutes of simulated time, as its slowest mode decays in 58 s. Newton's method, on the map
 * from the machine's state at the beginning of one firing cycle to that of the next, takes some
 * hundred cycles. */
#ifndef VS_VALIDATE_ORBIT_H
#define VS_VALIDATE_ORBIT_H

#include "validate/experiment.h"

/* Finds the orbit of the experiment's scene, of any machine, whose period is the scene's
 * firing.every cycles. Adds every measure over one period; power and power_copper [W]; i_rms [A];
 * and, where the experiment asks for them, the sizes of the multipliers, multiplier1 ..., the
 * largest first. First the scene is marched for its run.until, rounded to whole firing cycles;
 * where several orbits live side by side, that decides which one is found, and the machine's scales
 * are taken from there. No guard ends the run where the armature is beyond the pole cover. Errors:
 * those of the scene and of the run; VS_RUN, no orbit is found. */
vs_status vs_orbit_perform(const vs_experiment *experiment, const vs_observer *also,
                           vs_numbers *out, vs_error *err);

/* The same for a scene that was read, without multipliers. */
vs_status vs_orbit_find(const vs_scene *scene, const vs_observer *also, vs_numbers *out,
                        vs_error *err);

#endif
