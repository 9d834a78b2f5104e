/* SPDX-License-Identifier: GPL-3.0-or-later
 * How finely the circuit tier lets its solver go, for the error that is wanted. */
#ifndef VS_COUPLING_PACE_H
#define VS_COUPLING_PACE_H

#include "sim/sim.h"

typedef struct vs_pace {
  double max_step_s;
  double relative, current_a, voltage_v, charge_c; /* tolerances */
  double truncation; /* how much more than tolerated a step's truncation error may be */
} vs_pace;

/* May run the scene on the switched tier, to see whether its stop is met. */
vs_pace vs_pace_of(const vs_setup *setup);

#endif
