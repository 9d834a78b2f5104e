/* SPDX-License-Identifier: GPL-3.0-or-later
 * A channel of a run that is linear in the motion, as it is seen through a low-pass or directly,
 * and its largest and its least value over one period of an orbit.
 *
 * A channel is linear where it is a constant and a sum of coordinates, their rates and their second
 * rates, each times a number:  y = y_0 + k . (q, q', q"). */
#pragma once

#include "engine/step.h"
#include "measure/lowpass.h"

enum { VS_SEEN_TERMS = 3 * VS_MOST_DOF };

/* What is asked for. An instrument's keys (measure/instruments.h) have the same names. */
typedef struct vs_linear_signal_order {
  char name[VS_NAME_SIZE]; /* what the output is called */
  int channel;             /* its number in the frame */
  double bandwidth_hz;     /* of the low-pass; NaN: there is none */
  int order;               /* 1 or 2 */
  double damping;          /* zeta of the second order */
} vs_linear_signal_order;

/* An extreme of the signal: its value, in the channel's unit, and when, s. Both are NaN where there
 * is none. */
typedef struct vs_linear_signal_extreme {
  double value, at_s;
} vs_linear_signal_extreme;

typedef struct vs_linear_signal {
  vs_linear_signal_order order;
  const char *unit;                 /* of the channel; borrowed */
  double k[VS_SEEN_TERMS];          /* of q, then of q', then of q" */
  int states;                       /* of the low-pass: 0, 1 or 2 */
  vs_lowpass lowpass;               /* where it has come on the orbit */
  double start[2];                  /* its state at t = 0, which comes back after the period */
  vs_linear_signal_extreme best[2]; /* the largest value and the least */
  vs_linear_signal_extreme
      next[2];       /* of all turns of the same kind the one that comes next to it */
  bool began, rises; /* a step was shown; the signal rises at its end */
} vs_linear_signal;

/* Begins with a channel of the frame. Error, VS_INPUT: the channel is not linear in the motion. */
vs_status vs_linear_signal_begin(vs_linear_signal *seen, const vs_frame *frame,
                                 const vs_linear_signal_order *order, vs_error *err);

/* The period is shown twice, step by step: a first time to find the low-pass's start, which
 * vs_linear_signal_close does, and a second time to find the extremes. */
void vs_linear_signal_accept(vs_linear_signal *seen, const vs_step *step);
void vs_linear_signal_close(vs_linear_signal *seen, double period_s);

/* Into how many equal parts a step is to be cut so that a polynomial of degree six goes along the
 * motion in each. */
int vs_linear_signal_parts(const vs_step *step);

/* Half of the way from the least value to the largest. */
double vs_linear_signal_amplitude(const vs_linear_signal *seen);
/* How far the second largest turn is below the largest value, or the second least above the least,
 * whichever is less; INFINITY: there is no second. */
double vs_linear_signal_margin(const vs_linear_signal *seen);
/* How long before or behind the beginning of the period the nearer of the extremes comes, s. */
double vs_linear_signal_edge(const vs_linear_signal *seen, double period_s);
