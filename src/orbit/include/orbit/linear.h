/* SPDX-License-Identifier: GPL-3.0-or-later
 * The linear model of a machine about its orbit, from the angle of each firing on:
 *
 *   x[k+1] = A x[k] + B a[k],    y[k] = C x[k] + D a[k].
 *
 * The section k is the instant t_k at which the mains rise through zero and the cycle of the mains
 * begins in which the thyristor fires: the instant at which a control decides. There x is by how
 * much q and q' differ from the orbit, and behind them the states of low-passes (see below); no
 * current flows there. a is by how much the firing angle of this cycle differs, rad. y[k] are the
 * amplitudes of signals over the time from t_k to t_k+1: half of the way from the least value to
 * the largest, minus the orbit's.
 *
 * All are derivatives, exact but for the rounding of their integration (orbit/variation.h), and so
 * is each row of C and D: an extreme moves by what the signal moves at the instant at which the
 * orbit has it.
 *
 * On tier compiled x goes on with those charges and fluxes of the circuit that are not forgotten
 * within a period, and all is by differences of runs that take the same steps
 * (linear_circuit.h). Sections at the firing are not known there.
 *
 * A signal may be seen through a low-pass. Its states (y, y'/w) of measure/lowpass.h, or y
 * alone, then join x. */
#pragma once

#include "orbit/linear_signal.h"
#include "orbit/shooting.h"

enum {
  VS_LINEAR_FILTERED = 4, /* signals with a low-pass, at most */
  VS_LINEAR_STATES = VS_MOST_STATES + 2 * VS_LINEAR_FILTERED,
  VS_LINEAR_OUTPUTS = VS_MOST_DOF + 1 + VS_LINEAR_FILTERED /* of which so many with a low-pass */
};

/* A state, or an output, and its unit. */
typedef struct vs_linear_name {
  char name[VS_NAME_SIZE], unit[24];
} vs_linear_name;

typedef struct vs_linear_output {
  vs_linear_signal seen; /* the signal on the orbit: amplitude, extremes and when they are */
  int first;             /* the first of the states of its low-pass; -1: it has none */
} vs_linear_output;

/* The matrices are filled up to n and `outputs`; [i][j] is row i, column j. */
typedef struct vs_linear {
  int n;       /* states */
  int machine; /* how many of them are the machine's own, which stand first: q, then q' */
  int outputs;
  vs_linear_name state[VS_LINEAR_STATES];
  vs_linear_output output[VS_LINEAR_OUTPUTS];
  double a[VS_LINEAR_STATES][VS_LINEAR_STATES], b[VS_LINEAR_STATES];
  double c[VS_LINEAR_OUTPUTS][VS_LINEAR_STATES], d[VS_LINEAR_OUTPUTS];
  double x[VS_LINEAR_STATES];     /* the orbit's state at the section */
  double scale[VS_LINEAR_STATES]; /* a size of each state on the orbit, > 0 */
  double angle_rad;               /* the orbit's */
  double period_s;                /* from section to section */
  double fires_s, extinct_s;      /* of the orbit, since the section */
  bool stable;

  /* The same model with another section, the instant t_k + fires_s at which the orbit fires. There
   * x is to_firing times the x of the section; before the thyristor fires it swings freely. NaN
   * where a low-pass is so fast that nothing of its state is left there, and on tier compiled all
   * but the machine's x_firing. */
  double to_firing[VS_LINEAR_STATES][VS_LINEAR_STATES];
  double a_firing[VS_LINEAR_STATES][VS_LINEAR_STATES], b_firing[VS_LINEAR_STATES];
  double c_firing[VS_LINEAR_OUTPUTS][VS_LINEAR_STATES];
  double x_firing[VS_LINEAR_STATES]; /* the orbit's */

  int contacts; /* how often the orbit meets a stop */
  /* How far the travel is off a stop's edge, m, where it turns nearest to one, and when; NaN: it
   * turns nowhere that counts. A contact comes or goes when a deviation is as large. */
  double grazing_m, grazing_s;
} vs_linear;

/* Error, VS_INPUT: the scene has no linear model, as it is known before any search: its circuit is
 * ngspice's; a coil without a valve, which has no firing angle; orbits of more than one firing. */
vs_status vs_linear_check(const vs_scene *scene, int periods, vs_error *err);

/* Finds the model about an orbit of one firing period of the scene, which may have been put on that
 * orbit. signals: the outputs that are wanted, `count` of them; NULL: the coordinates,
 * and the travel where no coordinate is the same. Errors: those of vs_linear_check; of
 * vs_linear_signal_begin; VS_RUN, the model does not exist: the thyristor fires twice in the
 * period, or not at its angle; the armature touches a stop without a speed; an output does not
 * move. */
vs_status vs_linear_find(const vs_scene *scene, const vs_orbit *orbit,
                         const vs_linear_signal_order *signals, int count, vs_linear *linear,
                         vs_error *err);

/* Gives what a lasting change of the angle makes of each output in the end, C (I - A)^-1 B + D, per
 * rad. Error, VS_RUN: a multiplier is 1. */
vs_status vs_linear_gain(const vs_linear *linear, double gain[VS_LINEAR_OUTPUTS], vs_error *err);

/* Begins a model of that setup of the scene on its orbit: names the machine's states and begins the
 * outputs. As vs_linear_find besides. */
vs_status vs_linear_begin(const vs_scene *scene, const vs_setup *setup, const vs_orbit *orbit,
                          const vs_linear_signal_order *signals, int count, vs_linear *linear,
                          vs_error *err);
/* Shows a step of the orbit to the outputs, and notes firing, extinction and contacts. *firings:
 * how many there were so far. */
void vs_linear_look(vs_linear *linear, const vs_step *step, int *firings);
/* The output that is the gap's travel, seen without a low-pass; -1: there is none. */
int vs_linear_travel(const vs_linear *linear, const vs_model *model);
