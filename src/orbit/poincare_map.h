/* SPDX-License-Identifier: GPL-3.0-or-later
 * A flight: the run of a scene over a number of firing periods from a given state at the mains'
 * rise through zero, and what the search for an orbit wants to know of it: on an ideal tier, or
 * with a circuit whose state can be set (circuit_flight.h). */
#pragma once

#include "orbit/variation.h"
#include "run/scene.h"

/* The most states of x, with a circuit. */
enum { VS_FLIGHT_STATES = 64 };

/* Begin with vs_poincare_map_begin, end with vs_poincare_map_end. What a run has left holds until
 * the next. */
typedef struct vs_poincare_map {
  const vs_scene *given;
  const vs_observer *also; /* is shown every step of a run, too; NULL: nobody is; borrowed */
  vs_scene
      *scene; /* room for the scene that is run, which borrows what the one given owns; owned */
  vs_budget *budget; /* what its runs may take: that of the scene's order; the caller may set
                        another between runs; borrowed */
  int states;        /* of x: q, q', lambda where there is no valve or eddy currents, and psi; with
                        a circuit the caller sets it */
  double cycle_s;    /* a firing period */
  vs_parameter
      *parameter; /* whose column the derivatives have besides, made of the scene given, with or
                     without its events; borrowed; the caller may set it between runs; NULL: none */
  bool derives;   /* the last run had derivatives */
  vs_variation variation; /* where it had */
  double *
      passed; /* where it had, x at the end of each firing period, VS_VARIATION_MOST a row; owned */
  double *slope;                /* with a circuit: d end/dx, row by row, where it is known; owned */
  double end[VS_FLIGHT_STATES]; /* x at the end */
  double size[VS_FLIGHT_STATES]; /* the largest magnitude of each state */
  double flux_wb; /* lambda at the end, with or without a valve; 0 where eddy currents keep it */
  double deepest_m, deepest_s; /* the least travel, and when */
  double beyond_s;             /* when the armature is beyond the pole cover first; NaN: never */
  char left[256];              /* why the coil's law does not hold; empty: it does */
  double left_s;               /* at which knot first */
} vs_poincare_map;

void vs_poincare_map_begin(vs_poincare_map *flight, const vs_scene *scene);
void vs_poincare_map_end(vs_poincare_map *flight);

/* Runs so many firing periods from x, at the finest tolerance the tier can hold; `derives`: with
 * derivatives. Those with respect to the parameter are at a given x, and at the end of as many
 * periods, however long these are. Nothing guards the run. Errors: those of the tier's run; VS_RUN,
 * a state that is not finite, or the budget is spent. */
vs_status vs_poincare_map_go(vs_poincare_map *flight, const double *x, int periods, bool derives,
                             vs_error *err);

/* After a run with derivatives: d(end's i)/d(x's j). */
double vs_poincare_map_slope(vs_poincare_map *flight, int i, int j);

/* For who makes the run itself: forgets the last one, and counts so many firing periods on the
 * budget; then is shown each step. Errors: as above. */
vs_status vs_poincare_map_anew(vs_poincare_map *flight, int periods, vs_error *err);
vs_status vs_poincare_map_see(vs_poincare_map *flight, const vs_step *step, vs_error *err);

/* Makes the setup of a run from x at the mains' rise through zero, t = 0. The pulse that began a
 * firing period before is there, too: where it is long it may fire right at t = 0. The setup
 * borrows what the scene's owns. */
vs_setup vs_poincare_map_setup(const vs_scene *scene, const vs_run_values *run, const double *x);
