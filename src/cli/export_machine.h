/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine as netlist, for `vibrospice export`. Its states are the voltages of nodes "vs_NAME",
 * where NAME is a coordinate or its rate: 1 V is 1 mm, 1 mrad, 1 mm/s, 1 mrad/s. The node vs_f is
 * the coil's force, 1 V for 1 N, and vs_i the current, 1 V for 1 A, unless the coil is square.
 * vs_probe1 and those that follow are the machine's probes in their units. */
#pragma once

#include "base/text.h"
#include "engine/setup.h"

/* The name of a state, k = 0..2 dof-1: a coordinate, or its rate. */
const char *vs_export_machine_state(const vs_model *model, int k);

/* The coordinate that is the gap's travel by itself, as no other moves the gap; -1: there is none.
 */
int vs_export_machine_travel_is(const vs_model *model);
/* What the travel is called: that coordinate, or "travel". */
const char *vs_export_machine_travel(const vs_model *model);
/* The node of the travel, mm, or of its rate, mm/s, behind "vs_". */
const char *vs_export_machine_node(const vs_model *model, bool rate);

/* Adds the source of the EVA's, "NAME n m external", that has the gap or another motion which the
 * deck names (netlist/eva.h). */
void vs_export_machine_motion(vs_text *text, const vs_setup *setup, const char *name,
                              const char *const nodes[2]);

/* Refuses a machine that calls a state as the export calls a node of its own, and a stop that has
 * no text. Errors with the place in the machine's file. */
vs_status vs_export_machine_check(const vs_setup *setup, vs_error *err);

/* Adds the parameters of the stops, if there are any. */
void vs_export_machine_params(vs_text *text, const vs_model *model);

/* Adds the machine: its states, the forces of coil and stops, its probes. */
void vs_export_machine_write(vs_text *text, const vs_setup *setup);
