/* SPDX-License-Identifier: GPL-3.0-or-later
 * A machine's file, a YAML map:
 *
 *   title:       TEXT
 *   coordinates: {NAME: {unit: m, text: TEXT}, ...}
 *       one to sixteen; NAME, vNAME and aNAME become columns
 *   parameters:  {NAME: {default: 20 kg, range: 1e-6 kg .. 1e5 kg, open: true, text: TEXT}, ...}
 *       keys of the scene's section machine
 *   let:         {NAME: FORMULA, ...}
 *       names for formulas; each may name those above it
 *   mass, damping, stiffness: [[FORMULA, ...], ...]
 *       M, B and K, a row for each coordinate; of one coordinate a FORMULA alone will do. A machine
 *       without damping has no key damping
 *   bodies, springs: ...
 *       instead of these three, bodies in the plane from which the program finds them: see
 *       machine_file.c
 *   forces:      {COORDINATE: FORMULA, ...}
 *       forces that never change: gravity, preload
 *   gap:         {along: {COORDINATE: FORMULA, ...}}
 *       z = D + d + along.q; the actuator's force acts along it
 *   load:        {adds: PARAMETER, to: [mass, ...], along: FORMULA, up: FORMULA, forward: FORMULA}
 *       where the scene's load goes; and how the trough moves, in m, linear in the coordinates:
 *       along the direction that the paper's throw coefficient is of, upwards, the material's way
 *   probes:      {NAME: {of: FORMULA, unit: m, text: TEXT}, ...}
 *   actuator:    {current: FORMULA, energy: FORMULA, force: FORMULA, KEY: VALUE, ...}
 *       the law's formulas in lambda and z: i = dW/dlambda, W, and F = -dW/dz, which is negative
 *       where it closes the gap; any other key is the default of the scene's
 *   supply, firing: {KEY: VALUE, ...}
 *       what feeds the machine and how it is fired: defaults of the scene's sections. A scene must
 *       say the voltage and the angle that the file does not
 *   instruments: NAME, or {NAME: {...}, ...}
 *       the machine's own set of instruments; see measure/instruments.h, which reads it
 *
 * A FORMULA is as base/formula.h has it, with a pair's NAME.x and NAME.y, or a number with its
 * unit. All is in SI. */
#pragma once

#include "base/field.h"
#include "plant/machine.h"

/* Reads the file into a machine that vs_machine_begin has made. Errors with their place; a check
 * carries on from most of them, and machine->lost is true then. */
vs_status vs_machine_file_read(const char *path, vs_machine *machine, vs_error *err);

/* True if the file has a key that only machines have. */
bool vs_machine_file_has_keys(const vs_tree *file);

/* The keys of a machine's file, with all below them. */
extern const vs_inside vs_machine_file_keys;
