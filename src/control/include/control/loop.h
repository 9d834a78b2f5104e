/* SPDX-License-Identifier: GPL-3.0-or-later
 * The control of one run. It reads the run's meters at the ticks of its clock, n/control.rate, and
 * decides the angle of each firing at the rising zero crossing of the mains at which that firing's
 * cycle begins, from what it has read until then. Every tier ends a step there. */
#pragma once

#include "control/control.h"
#include "control/estimator.h"
#include "measure/meter.h"

typedef struct vs_loop {
  const vs_control *control; /* borrowed, as all but self and the program's angles */
  vs_meter *meters;
  vs_program program; /* what it has decided; the run's timeline points to it */
  vs_control_input sight;
  double value[VS_INSTRUMENT_MOST + VS_MOST_STATES]; /* of the meters and the estimates, SI;
                                                        sight.value */
  vs_estimator estimator;  /* of the control's observer, where it has one */
  void *self;              /* the regulator's state, owned */
  long ticks;              /* how many are behind */
  long left_out, at_limit; /* of the firings decided: without a pulse; at an end of
                              control.angle, where the law wanted to go further */
} vs_loop;

/* Begins the control of a run of `setup` with the scene's instruments and the run's meters, which
 * stand in the same order. Decides the first firing where its cycle begins at t = 0. The caller
 * points setup->timeline.program to loop->program, for as long as the run goes on. Errors: the
 * regulator's. vs_loop_end also after one. Not to be moved. */
vs_status vs_loop_begin(vs_loop *loop, const vs_control *control, const vs_setup *setup,
                        const vs_instruments *instruments, vs_meter *meters, vs_error *err);

/* Goes on to t_s, an instant within the step. */
void vs_loop_run_to(vs_loop *loop, const vs_step *step, double t_s);
/* Goes on to the step's end, and decides what is due there. Every step is to be shown, in order of
 * time. Error: the regulator's. */
vs_status vs_loop_accept(vs_loop *loop, const vs_step *step, vs_error *err);

/* What the control's k-th column (vs_control_column_at) shows, as of the last tick or decision;
 * NaN: it is not known. */
double vs_loop_shows(const vs_loop *loop, int k);

void vs_loop_end(vs_loop *loop);
