/* SPDX-License-Identifier: GPL-3.0-or-later
 * load.fraction: auto. The share of the material that rides, lambda_t, follows from the throw
 * coefficient K by the paper's empirical range (vs_model_fraction); K is that of the machine's
 * orbit; and the orbit is that of a machine which carries this share. */
#pragma once

#include "run/scene.h"

/* Finds the share for a scene that wants it, on its orbit of so many firing periods without its
 * events: from the lower end of the paper's range on by the secant's rule, until it changes by less
 * than 1e-11, with a circuit by less than run.tolerance. There the search begins at the shares that
 * the ideal tier's orbits ask for, where these are found. A heavier trough may swing further, so
 * that more than one share may ask for itself: setup.other_fraction is what is found from the upper
 * end on, where that is another. The scene's models then carry it; setup.throw_coefficient is K. A
 * scene of a tier without orbits takes that of another one (vs_tiers_of_orbit). Where nothing is
 * wanted, nothing is done. Errors, with the share that was tried: those of vs_shooting_seek, and
 * with a circuit those of vs_picard_new and its run; VS_RUN, no share is found, or the search's
 * budget of cycles is spent before, with how far it came. Where it is spent in the search for
 * another share the scene is warned. */
vs_status vs_fraction_settle(vs_scene *scene, int periods, vs_error *err);
