/* SPDX-License-Identifier: GPL-3.0-or-later
 * The periodic orbit of continuous firing on the switched tier (orbit/shooting.h), as an
 * experiment: what is measured over one of its periods. */
#pragma once

#include "validate/experiment.h"

/* Finds the orbit of the experiment's scene, of any machine, whose period is the scene's
 * firing.every cycles. Adds every measure over one period; power and power_copper [W]; i_rms [A];
 * and, where the experiment asks for them, the sizes of the multipliers, multiplier1 ..., the
 * largest first. `also` is shown the steps of that period. Where several orbits live side by side,
 * the scene's start decides which one is found. No guard ends the run where the armature is beyond
 * the pole cover. Errors: those of the scene and of vs_shooting_seek. */
vs_status vs_orbit_perform(const vs_experiment *experiment, const vs_observer *also,
                           vs_numbers *out, vs_error *err);

/* The same for a scene that was read, without multipliers. */
vs_status vs_orbit_find(const vs_scene *scene, const vs_observer *also, vs_numbers *out,
                        vs_error *err);
