/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a machine's file declares by name: coordinates and parameters. */
#pragma once

#include "base/field.h"
#include "plant/machine.h"

/* The keys of a coordinate, and those of a parameter. */
extern const vs_inside vs_declare_coordinate_keys, vs_declare_parameter_keys;

/* Adds a name that formulas may use. Error, at `where`: it is no name, is taken, or is one that
 * formulas have for something else. */
vs_status vs_declare_name(vs_machine *machine, const char *name, vs_machine_name entry,
                          vs_where where, vs_error *err);

/* Checks the name of an output: a coordinate, one of its rates, or a probe. Error: as above. */
vs_status vs_declare_check(const vs_machine *machine, const char *what, const char *name,
                           vs_where where, vs_error *err);

/* Reads `coordinates`, and makes the section start of them. Errors with their place; a check
 * carries on. */
vs_status vs_declare_coordinates(vs_machine *machine, const vs_node *map, vs_error *err);

/* Reads `parameters` into the section machine: {NAME: {default: 20 kg, range: 1e-6 kg .. 1e5 kg,
 * open: true, text: ...}}. The default is a number with its unit, a pair of such, or, with
 * `choices: one|other`, a word. Errors likewise. */
vs_status vs_declare_parameters(vs_machine *machine, const vs_node *map, vs_error *err);

/* Writes the node's text, or nothing where it is NULL, into text[size]. Error: it is no text, or is
 * too long. */
vs_status vs_declare_text(const vs_node *node, const char *what, char *text, size_t size,
                          vs_error *err);
