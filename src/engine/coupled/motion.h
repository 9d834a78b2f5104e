/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine between two of the circuit's knots: Eq. 54 under a flux linkage that is a cubic in
 * time. Where the force follows from that alone and the armature is free, q is a Taylor series;
 * else it is integrated by GSL's rkf45. The instant at which the armature meets or leaves its stop
 * is located. */
#ifndef VS_ENGINE_MOTION_H
#define VS_ENGINE_MOTION_H

#include <gsl/gsl_odeiv2.h>

#include "plant/mechanics.h"

/* The caller sets flux, touched and jammed. */
typedef struct vs_motion {
  const vs_model *model;
  double flux[4];                       /* lambda(t0 + s) = flux[0] + s flux[1] + ..., Wb */
  unsigned touched;                     /* the stops that the armature is in, as bits */
  bool jammed;                          /* the armature stays where it is */
  double substep_s, substep_touching_s; /* longest substep, free and in a stop: 0.02 rad of the
                                           fastest swing, where the error of either is below 1e-12
                                           of the amplitude; INFINITY for a free mass */
  unsigned changed; /* behind a contact: the stop that was met or left, as a bit */
  size_t size;      /* of a state, bytes */
  gsl_odeiv2_system system;
  gsl_odeiv2_step *step;
} vs_motion;

/* How fast the armature may swing with its stops free, rad/s: the fastest mode, and what the
 * force's slope over the gap makes of it where the flux linkage is held, without a current at
 * first. */
double vs_motion_fastest(const vs_model *model);

/* Goes on with another model of as many coordinates, which must outlive the motion. */
void vs_motion_take(vs_motion *motion, const vs_model *model);

/* The motion must stay where it is made, as its system points to it. The model must outlive it. */
void vs_motion_begin(vs_motion *motion, const vs_model *model);
void vs_motion_end(vs_motion *motion);

/* Takes x = (q, q') on from `at_s` seconds into the course of the flux, to h seconds or to where
 * the armature meets or leaves its stop. Returns how far it has come, s; NaN where GSL cannot step
 * on. */
double vs_motion_advance(vs_motion *motion, double at_s, double h, double *x);

#endif
