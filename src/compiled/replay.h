/* SPDX-License-Identifier: GPL-3.0-or-later
 * The steps of a run that are noted, or those of another run that are taken once more. Steps of a
 * stretch up to an edge grow with the stretch, so that the same number of them leads there. */
#pragma once

#include "ngspice/circuit.h"

/* A run begins. NULL: its steps are its own, and nobody wants them; also below. */
void vs_replay_begin(vs_circuit_steps *steps);
void vs_replay_note(vs_circuit_steps *steps, const vs_circuit_step *step);
/* The last one was shown in as many parts. Returns in how many it is to be. */
int vs_replay_parts(vs_circuit_steps *steps, int parts);
/* A restart is due behind the last one, or none. Returns whether there is to be one: that may hang
 * on rounding where a step ends on a change of branch. */
bool vs_replay_restarts(const vs_circuit_steps *steps, bool due);

/* The run takes steps of another; and it does so, or notes its own. */
static inline bool vs_replay_follows(const vs_circuit_steps *steps) {
  return steps && steps->are == VS_STEPS_TAKEN;
}
static inline bool vs_replay_is_on(const vs_circuit_steps *steps) {
  return steps && steps->are != VS_STEPS_OWN;
}

/* The step that comes next, where left_s are left up to an edge; NaN: a restart is due. length_s:
 * its length here. NULL: the other run had no such one there. */
const vs_circuit_step *vs_replay_next(vs_circuit_steps *steps, double left_s, double *length_s);
