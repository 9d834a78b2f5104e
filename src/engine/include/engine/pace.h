/* SPDX-License-Identifier: GPL-3.0-or-later
 * How finely the circuit tier lets its solver go, for the error that the scene wants. */
#pragma once

#include "engine/sim.h"

typedef struct vs_pace {
  bool blows;        /* the armature is expected to meet a stop */
  double max_step_s; /* the solver's largest step */
  /* Tolerances of its Newton iteration and of a step's truncation error: relative to each value,
   * and below which a difference of currents, voltages or charges is none. */
  double relative, current_a, voltage_v, charge_c;
  double truncation; /* by how much a step's truncation error may exceed these */
} vs_pace;

/* The pace for this setup. May run it on tier "switched" first, to see whether its stop is met. */
vs_pace vs_pace_of(const vs_setup *setup);

/* The longest step, s, that the circuit tier takes of a scene whose stop is not met: the scene's
 * own run.max_step, or what follows from its tolerance. */
double vs_pace_largest_step(const vs_setup *setup);
