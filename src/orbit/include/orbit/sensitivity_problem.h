/* SPDX-License-Identifier: GPL-3.0-or-later
 * What is asked how its measures depend on the scene's keys: a run of the scene from its start, a
 * run that begins on the scene's orbit, or one period of that orbit. */
#pragma once

#include <signal.h>

#include "orbit/shooting.h"
#include "orbit/variation.h"

/* A name that was asked for, and where it was written; both are borrowed. */
typedef struct vs_asked {
  const char *name;
  vs_where where;
} vs_asked;

typedef struct vs_sensitivity_problem {
  const vs_scene *scene; /* as it was read; borrowed */
  vs_scene *calm; /* the scene that the orbit is of: without its events and its start; owned, but
                     for what it borrows of the scene; NULL: there is no orbit */
  vs_orbit orbit; /* where there is one */
  const volatile sig_atomic_t *stop; /* set by a signal: its runs end; NULL: none */
  int periods;         /* one period of it is looked at, of so many firing periods; 0: none is */
  const char *inexact; /* why the equations have no derivative that orbit/variation.h knows, so that
                          runs are to be compared, which find their own orbits; NULL: they have */
  double until_s; /* from here on nothing that is asked for changes, so that a run without an orbit
                     ends here; INFINITY: that is not known. To be set once the subject has begun */
  /* Is shown each step of the run (k = 0) and of its neighbours (k = 1 and on) besides their
   * measures (orbit/tangent.h); NULL: nobody is. To be set once the subject has begun. */
  void (*shown)(void *ctx, int k, const vs_step *step);
  void *ctx;
} vs_sensitivity_problem;

/* Begins with a settled scene; periods: 0, its run; else a period of its orbit of so many firing
 * periods. vs_sensitivity_problem_end even after an error. The orbit is only
 * found where the run is to have exact derivatives. Errors: those of vs_shooting_find. */
vs_status vs_sensitivity_problem_begin(vs_sensitivity_problem *subject, const vs_scene *scene,
                                       int periods, vs_error *err);
void vs_sensitivity_problem_end(vs_sensitivity_problem *subject);

/* The setup of the run, at the tolerance given, of this scene or of one that differs from it in a
 * key; its state at t = 0 is the subject's own. It borrows of the scene's. */
vs_setup vs_sensitivity_problem_setup(const vs_sensitivity_problem *subject, const vs_scene *scene,
                                      double tolerance);

/* Gives d/dp of the state at t = 0 of a subject with an orbit, which depends on the key, too: rows
 * as of orbit/variation.h. The parameter's setups become those of a flight along the orbit. Errors:
 * those of the flight; VS_RUN, the orbit turns back here. */
vs_status vs_sensitivity_problem_start(const vs_sensitivity_problem *subject,
                                       vs_parameter *parameter, double start[VS_VARIATION_MOST],
                                       vs_error *err);
