/* SPDX-License-Identifier: GPL-3.0-or-later
 * Orbits of scenes that are nearly the same, along the same steps, so that what differs between
 * them is smooth. On tier compiled the scene's own search finds its orbit. The steps of a period
 * from there are noted; by these the orbit is closed to rounding, with the search's Phi. Each
 * neighbour's period begins at that orbit, and is closed by the same steps and the same Phi. */
#pragma once

#include "full_newton.h"
#include "orbit/picard.h"

/* Begin with {0}, end with vs_alike_free. */
typedef struct vs_alike {
  vs_circuit_steps steps; /* of a period; for the order of each run */
  double *orbit;          /* z of the scene's orbit, of `states`; owned; NULL: not known yet */
  int states;
  vs_full_newton *newton; /* of the scene's own search, which must last */
  vs_picard *picard;      /* of the present run; borrowed */
  vs_orbit_search search; /* its own pilot */
  bool neighbour, on; /* of the run: it is no search; and periods along the steps are under way */
  int periods, parts; /* of these so far; firing periods of the present one */
} vs_alike;

/* Makes the pilot of a run bring it to its orbit so: first of the scene as it is, then of its
 * neighbours. Errors of these runs besides those of a search: VS_RUN, the circuit's state cannot be
 * set, or an orbit does not close. */
void vs_alike_take(vs_alike *alike, vs_picard *picard);
void vs_alike_free(vs_alike *alike);
