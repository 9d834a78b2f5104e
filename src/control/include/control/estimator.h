/* SPDX-License-Identifier: GPL-3.0-or-later
 * An observer at work in a run: at each sample of the control it computes where the machine is now
 * from where it was, corrects that by what the sensors show, and so has an estimate of all
 * coordinates and their rates. What it is made of stands in control/state_observer.h.
 *
 *   1. The force F follows from the measured current by the coil's law, at the gap that is
 *      estimated. F runs straight from sample to sample.
 *   2. x = A x + b0 F(before) + b1 F(now) + constant.
 *   3. x = x + L (y - what the sensors would show of x). A sensor shows its range's end of what is
 *      beyond it.
 *
 * The machine is the scene's as it begins, without its stops: of a load that changes, or of an
 * armature that jams, the observer is not told. */
#pragma once

#include "control/state_observer.h"
#include "engine/channel.h"

/* The largest differences between the estimates and the true motion, at the samples, in the units
 * of the coordinates and their rates. */
typedef struct vs_estimator_errors {
  double peak[VS_MOST_STATES];    /* the largest |true value| */
  double all[VS_MOST_STATES];     /* the largest |estimate - true value| */
  double settled[VS_MOST_STATES]; /* the same from observing->settling_s on */
  long after;                     /* how many samples there were from then on */
} vs_estimator_errors;

/* A plain struct: a copy made by `=` goes on by itself. */
typedef struct vs_estimator {
  const vs_state_observer *observing; /* borrowed, as is the frame's model */
  const vs_model *model;
  bool gap_at_rest; /* the law of the coil is taken at the gap at rest (engine/channel.h) */
  double x[VS_SAMPLED_MOST]; /* the estimate: q, q', and the states of the sensors' low-passes */
  double force_n;            /* F at the last sample */
  double flux_wb;            /* the coil's, from which it was computed */
  double beyond[VS_SENSOR_MOST]; /* by how much each sensor's channel was beyond its range */
  long samples;                  /* how many there were */
  vs_estimator_errors errors;
} vs_estimator;

/* Begins a run. start: the run's q and q' at its beginning, of which the observer is told where its
 * key `start` says so; else the estimate begins at rest. */
void vs_estimator_begin(vs_estimator *estimator, const vs_state_observer *observing,
                        const vs_frame *frame, const double *start);

/* The sample number estimator->samples, at that number times the system's period. current_a: what
 * its instrument shows; y: what the sensors show, in their order. */
void vs_estimator_sample(vs_estimator *estimator, double current_a, const double *y);

/* Compares the last sample's estimate with the true q and q' of that instant. */
void vs_estimator_compare(vs_estimator *estimator, const double *x);
