/* SPDX-License-Identifier: GPL-3.0-or-later
 * Bodies and springs in the plane, which a machine's file may have instead of matrices:
 *
 *   bodies:  {NAME: {mass: FORMULA, inertia: FORMULA, at: [x, y], on: BODY,
 *                    moves: {x: FORMULA, y: FORMULA, turn: FORMULA}}, ...}
 *       at: its centre of mass at rest. moves: its small motion, linear in the coordinates; what is
 *       left out is 0, and so is the inertia. on: a body above it, whose motion it shares besides
 *   springs: {NAME: {from: {BODY: [x, y]}, to: {BODY: [x, y]}, along: [x, y],
 *                    stiffness: FORMULA, damping: FORMULA}, ...}
 *       from: without it, the ground at the same point; BODY may be `ground`. The spring pulls
 * along the line between its points, or along the direction `along`; with stiffness: [x, y] and
 *       damping: [x, y] along both axes. Springs are without force at rest */
#ifndef VS_PLANT_BODIES_H
#define VS_PLANT_BODIES_H

#include "base/field.h"
#include "plant/machine.h"

/* The keys of a body, and those of a spring. */
extern const vs_outline vs_bodies_keys[], vs_bodies_spring_keys[];

/* Reads both keys. Errors with their place; a check carries on. */
vs_status vs_bodies_read(vs_machine *machine, vs_error *err);

#endif
