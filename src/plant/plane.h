/* SPDX-License-Identifier: GPL-3.0-or-later
 * M, B and K of bodies and springs in the plane (plant/bodies.h), for small motion. */
#ifndef VS_PLANT_PLANE_H
#define VS_PLANT_PLANE_H

#include "plant/machine.h"

/* Fills one of the three with these values of the machine's names. sum: VS_MACHINE_MASS,
 * VS_MACHINE_DAMPING or VS_MACHINE_STIFFNESS. Errors with their place: a value that is not finite,
 * a motion that is not linear, a spring without a direction. */
vs_status vs_plane_matrix(vs_machine *machine, int sum, const double values[VS_MACHINE_NAMES],
                          double out[VS_MACHINE_COORDINATES][VS_MACHINE_COORDINATES],
                          vs_error *err);

/* The slopes of a linear form of the coordinates, which are its terms: its values at unit
 * coordinates; 0 where it has no text. Error with its place: it is not linear, or not 0 at rest. */
vs_status vs_plane_slopes(vs_expression *form, const double values[VS_MACHINE_NAMES], int dof,
                          double out[VS_MACHINE_COORDINATES], vs_error *err);

#endif
