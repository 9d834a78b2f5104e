/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine with some of its instruments as a linear system that is looked at once in a period T,
 * which is what an observer computes with. Its state x has the coordinates q, their rates q', and
 * then the states of the instruments' low-passes. With the actuator's force F that runs straight
 * from one instant to the next,
 *
 *   x(k+1) = A x(k) + b0 F(k) + b1 F(k+1) + constant      y(k) = C x(k) + d F(k) + e
 *
 * and y are what the instruments show, but for noise, steps of the A/D and ends of ranges. A, b0
 * and b1 come from the exponential of the equations of motion, without an error of their own. */
#pragma once

#include <gsl/gsl_complex.h>
#include <gsl/gsl_matrix.h>

#include "measure/instruments.h"
#include "measure/lowpass.h"
#include "plant/mechanics.h"

enum { VS_SENSOR_MOST = 8, VS_SAMPLED_MOST = VS_MOST_STATES + 2 * VS_SENSOR_MOST };

/* One of the instruments. What it measures is row.(q, q') + of_force F + constant, in the channel's
 * unit. */
typedef struct vs_sensor {
  const vs_instrument *instrument; /* borrowed */
  double row[VS_MOST_STATES], of_force, constant;
  double range[2];    /* what it can show, in the channel's unit */
  vs_lowpass lowpass; /* at rest */
  int states;         /* of its low-pass: 0, 1 or 2 */
  int at;             /* where the first of these stands in x */
  /* By how much these change in one period by an input that falls from 1 to 0, and by one that
   * rises from 0 to 1. */
  double response[2][2];
} vs_sensor;

/* Vectors are filled up to `states`. Constant once it is made. */
typedef struct vs_sampled_system {
  double period_s;                             /* T */
  int dof, states, sensors;                    /* numbers of q, of x, and of y */
  double a[VS_SAMPLED_MOST][VS_SAMPLED_MOST];  /* A; [row][column] */
  double b[2][VS_SAMPLED_MOST];                /* b0, b1: per newton */
  double constant[VS_SAMPLED_MOST];            /* of forces that never change */
  double c[VS_SENSOR_MOST][VS_SAMPLED_MOST];   /* C */
  double d[VS_SENSOR_MOST], e[VS_SENSOR_MOST]; /* of instruments without a low-pass, else 0 */
  vs_sensor sensor[VS_SENSOR_MOST];
  /* What counts as 1 in each state and in each y, so that all numbers of the machine have one order
   * of magnitude: displacements by their elastic and rates by their kinetic energy. */
  double scale[VS_SAMPLED_MOST], y_scale[VS_SENSOR_MOST];
  double rad_s; /* what counts as 1 of frequencies: the machine's fastest mode */
} vs_sampled_system;

/* True if the instrument measures what is linear in the motion and in F, so that it can be a sensor
 * here: a coordinate, its rate, its acceleration, or the air gap. */
bool vs_sampled_system_takes(const vs_model *model, const vs_instrument *instrument);

/* Makes the system of these instruments, each of which vs_sampled_system_takes is true of. */
void vs_sampled_system_make(vs_sampled_system *system, const vs_model *model,
                            const vs_instrument *const *instruments, int count, double period_s);

/* A pole s: what goes on as exp(s t). */
typedef struct vs_pole {
  double re_1_s, im_rad_s;
} vs_pole;

/* The system for finding gains: with scaled states and sensors. As with many samples in a swing A
 * is nearly the unit matrix I, differences stand in the place of samples:
 *
 *   a = (A - I)/(T w), whose eigenvalues are (exp(s T) - 1)/(T w)
 *
 * with w = rad_s. What moves the poles of (I - L C) A is C A, and in differences C A/(T w). */
typedef struct vs_scaled {
  gsl_matrix *full, *c; /* A, C */
  gsl_matrix *at, *cat; /* a and C A, transposed */
  double unit_s;        /* T w */
} vs_scaled;

/* Makes the scaled system, which vs_sampled_system_unscale frees. */
vs_scaled vs_sampled_system_scale(const vs_sampled_system *system);
void vs_sampled_system_unscale(vs_scaled *scaled);

/* The eigenvalue (exp(s T) - 1)/(T w) of a pole. */
gsl_complex vs_sampled_system_difference(const vs_sampled_system *system, vs_pole s);

/* Finds the poles of (I - L C) A with a scaled gain L, the slowest first, a pair by falling
 * imaginary part. Returns false where GSL finds none. */
bool vs_sampled_system_poles(const vs_sampled_system *system, const vs_scaled *scaled,
                             const gsl_matrix *gain, vs_pole poles[VS_SAMPLED_MOST]);
