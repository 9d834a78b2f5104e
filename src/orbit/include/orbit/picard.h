/* SPDX-License-Identifier: GPL-3.0-or-later
 * The periodic orbit of a scene on tier circuit, by Newton and Picard. The circuit's hidden state
 * cannot be set, but most of it forgets within a firing period what it was. The machine's state
 * x = (q, q') can be set, and does not forget for seconds. So the circuit is left to itself, and
 * behind each period, from x to x', the machine is put where Newton's method would have it,
 *   x + (I - Phi)^-1 (x' - x),
 * with Phi = dx'/dx of tier switched, which is near enough: what Phi is off, and what the circuit
 * remembers, makes the corrections fall by a factor of two to four from period to period. What the
 * circuit forgets slowly is moved on its own (orbit/slow_modes.h).
 *
 * Where the solver can set the circuit's state, as that of tier compiled, Newton's method takes
 * machine and circuit as one (orbit/full_newton.h), and the search is as above and below only where
 * that fails.
 *
 * With a stop in reach the two tiers' Phi may have little in common, and corrections do not fall.
 * Then Phi is found by differences between copies of the process. If that does not
 * do either the machine is left to itself, to tell what period it runs on. */
#pragma once

#include "engine/budget.h"
#include "engine/sim.h"
#include "orbit/shooting.h"

/* Made by vs_picard_new, freed by vs_picard_free. */
typedef struct vs_picard {
  vs_orbit_search pilot; /* for the order of the run (engine/sim.h) */
  vs_circuit_map map;    /* the pilot's */
  vs_orbit orbit;        /* what was found; before that, where the search begins */
  int cycles;            /* firing periods that the search took */
  bool found;      /* the orbit is found. A run that follows, as that for the errors of margins, has
                      a search of its own, and changes nothing here */
  int multipliers; /* how many of them are known; 0: none */
  double known_to; /* about how well these are known; a smaller one is lost in rounding */
  char missing[256]; /* why none is, where they were wanted */
  bool wants_multipliers;
  double guess[VS_ORBIT_STATES];   /* the orbit of tier switched, or the scene's start, at t = 0 */
  vs_budget budget;                /* of this search */
  vs_scene *ideal;                 /* the scene on tier switched; owned */
  struct vs_picard_search *search; /* the present one; owned */
} vs_picard;

/* Makes the pilot of a scene on tier circuit, for an orbit of that many firing periods. Its search
 * begins with the orbit of tier switched, or at the scene's start where that has none.
 * wants_multipliers: the orbit's multipliers are to be found, too. The scene must outlive it.
 * Error, with *picard NULL: VS_INPUT, what vs_shooting_seek refuses. The pilot's own errors, which
 * end the run with VS_RUN: VS_INPUT, the orbit repeats after fewer periods, or is unstable and the
 * machine runs on a subharmonic, or none is found and the machine comes back after another number
 * of periods; VS_RUN, the search does not converge, or its budget is spent. */
vs_status vs_picard_new(const vs_scene *scene, int periods, bool wants_multipliers,
                        vs_picard **picard, vs_error *err);
void vs_picard_free(vs_picard *picard);

/* What is left of a search that has found its orbit. */
typedef struct vs_picard_past {
  vs_orbit orbit;
  double guess[VS_ORBIT_STATES];
  bool guessed, own_phi;
} vs_picard_past;

vs_picard_past vs_picard_over(const vs_picard *picard);

/* Makes a search that has not begun yet begin near the orbit of a scene that is nearly the same. It
 * begins as far from the orbit of tier switched as that orbit was. Where that is no help, as the
 * other search took the circuit's own Phi or had no such orbit, it begins at that orbit. */
void vs_picard_begin_near(vs_picard *picard, const vs_picard_past *past);

/* Newton's method for machine and circuit together, while the run lasts; it is the picard's own.
 * NULL: it did not find the orbit. */
struct vs_full_newton *vs_picard_newton(const vs_picard *picard);

/* Before an attempt of a session (run/session.h): what was found counts no more. */
void vs_picard_again(vs_picard *picard);
