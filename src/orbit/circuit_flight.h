/* SPDX-License-Identifier: GPL-3.0-or-later
 * Flights of machine and circuit as one (poincare_map.h), where the solver can tell and set the
 * whole state and knows the monodromy matrix (vs_circuit_map). The state x of a flight has the
 * machine's states and those of the circuit that they hang on, as the search for the first orbit
 * has found them (full_newton.h). Each flight begins with the rest of the circuit's states where
 * the last one with derivatives would have them come back, or, if they hardly forget, as a fuse's
 * heat, at their value of the first orbit.
 *
 * A flight is a run with a pilot. In a first firing period, which nobody is shown, all is at rest
 * but what drives gates, as the pilot takes the mains' voltage away; then the solver is put at x.
 */
#pragma once

#include "poincare_map.h"

/* Begin with {0}, end with vs_circuit_flight_free. */
typedef struct vs_circuit_flight {
  int states;                    /* of x */
  double x[VS_FLIGHT_STATES];    /* of the first orbit */
  double size[VS_FLIGHT_STATES]; /* how large each was over its period, > 0 */
  int of[VS_FLIGHT_STATES];      /* which of the circuit's states each is */
  double *whole;                 /* these, where a period begins; owned, with the next: */
  double *next;                  /* and where the next flight with derivatives has them begin */
  int all;                       /* so many */
  vs_circuit_steps steps;        /* of the last period that noted its steps */
} vs_circuit_flight;

void vs_circuit_flight_free(vs_circuit_flight *flight);

/* Finds the scene's orbit of that many firing periods. Errors: those of vs_picard_new and of its
 * pilot; VS_RUN, the solver cannot set the circuit's state, or x has no room for it. */
vs_status vs_circuit_flight_seek(vs_circuit_flight *flight, const vs_scene *scene, int periods,
                                 vs_error *err);

/* vs_poincare_map_go with a circuit: a run from x of map->states numbers. takes: it goes by the
 * steps of the last flight that did not, and else notes its own. Errors: those of the run, which
 * include an armature beyond the pole cover; VS_RUN, it meets a stop, a state that x has not counts
 * by now, or with `takes`, other steps are needed; the budget is spent. */
vs_status vs_circuit_flight_go(vs_circuit_flight *flight, vs_poincare_map *map, const double *x,
                               int periods, bool takes, bool derives, vs_error *err);
