/* SPDX-License-Identifier: GPL-3.0-or-later
 * What may stand in for the circuit. Behind the last firing little flows, and a simple law can then
 * say what the circuit does, far quicker than its solver. Tier "circuit" shows a macromodel all
 * that the solver shows, asks it whether the solver can be left, and lets it step on in the
 * solver's place. */
#pragma once

#include "engine/setup.h"
#include "engine/step.h"
#include "macromodel/circuit_states.h"

/* `self` is what `begin` returned. */
typedef struct vs_macromodel {
  /* Says why no circuit of this machine, or this circuit not, can be stood in for; NULL: it may be.
   */
  const char *(*declines)(const vs_setup *setup);
  /* Makes the macromodel of one run; setup and frame must outlive it. Returns NULL where the solver
   * of this run is never to be left. */
  void *(*begin)(const vs_setup *setup, const vs_frame *frame);
  void (*end)(void *self); /* NULL is fine */

  /* What the circuit remembers, which the solver shall show besides the deck's terms; owned by the
   * macromodel. */
  const vs_circuit_states *(*memories)(const void *self);

  /* Shows it the next knot of the solver's; every knot is to be shown, in order of time. memory[k]
   * is the value of memories->item[k] there, V or A; NaN where the solver does not show it.
   * `blocks` is true as long as the thyristor carries no current. */
  void (*take)(void *self, const vs_knot *knot, const double *memory, bool blocks);

  /* Asks whether the solver can be left at the last knot, until until_s, s. The thyristor must
   * block there, and the armature must be free of its stop. Where the solver is gone back to later,
   * it follows the macromodel with the lag of the circuit, which may be most_lag_s at most;
   * INFINITY: it is left for good. If the return value is true, `step` can be used, and *bound is
   * the error that leaving makes, of p, u, w, phi, the force, i and the deck's probes, each
   * relative to its peak so far; the worst of them. */
  bool (*may_leave)(void *self, double until_s, double most_lag_s, double *bound);

  /* Longest step in the solver's place, s. */
  double (*longest)(const void *self);

  /* Takes *knot on to t_s, s, in the solver's place, and completes it. Fails with VS_RUN where the
   * law cannot be integrated; *knot is then as it was. */
  vs_status (*step)(void *self, vs_knot *knot, double t_s, vs_error *err);

  /* Capacitance, F, of the circuit as the EVA sees it, by which the solver's voltage is led back.
   */
  double (*capacitance)(const void *self);

  /* Compares the solver with the macromodel where the solver is gone back to: `own` is the knot
   * that `step` made, `solver` and `memory` are what the solver shows. Returns the worst
   * difference, relative to what that quantity may be wrong by: more than 1 means that a bound was
   * missed. */
  double (*missed)(const void *self, const vs_knot *own, const vs_knot *solver,
                   const double *memory);

  /* The solver has been gone back to: what it showed before does not count any more. */
  void (*restart)(void *self);
} vs_macromodel;

/* The one that the program has, in oneport_macromodel.c. */
extern const vs_macromodel vs_oneport_macromodel;
