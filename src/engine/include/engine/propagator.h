/* SPDX-License-Identifier: GPL-3.0-or-later
 * The machine's free motion, exactly: without a force and outside of its stop x' = A x, and so
 * x(t + h) = exp(A h) x(t) for x = (q, q'). */
#pragma once

#include "plant/mechanics.h"

/* exp(A h) for one length h: column[j][i] stands in row i and column j. */
typedef struct vs_propagator {
  int states;
  double column[VS_MOST_STATES][VS_MOST_STATES];
  double constant[VS_MOST_STATES]; /* what constant forces add in one step */
  bool loaded;                     /* there are constant forces */
} vs_propagator;

/* Makes it for steps of h_s. `held`: the armature is jammed, so that p" = 0. */
void vs_propagator_make(vs_propagator *propagator, const vs_model *model, bool held, double h_s);

/* The last one that was made of an armature which is not held, with what it was made of. Runs of
 * one machine, as a study's, then make it once. Start from {0}. */
typedef struct vs_propagator_memo {
  struct vs_propagator_source {
    double k[VS_MOST_DOF][VS_MOST_DOF], b[VS_MOST_DOF][VS_MOST_DOF], f[VS_MOST_DOF];
    double fastest_rad_s, h_s;
    int dof;
    bool loaded;
  } of;
  vs_propagator made;
} vs_propagator_memo;
/* Does the same by way of the memo; NULL: there is none. */
void vs_propagator_recall(vs_propagator *propagator, vs_propagator_memo *memo,
                          const vs_model *model, bool held, double h_s);

/* Gives the state y, one step after the state x, which is another array. y has room for
 * VS_MOST_STATES. */
void vs_propagator_step(const vs_propagator *propagator, const double *x, double *restrict y);

/* Gives the state y, that many whole steps after the state x, which is another array. */
void vs_propagator_leap(const vs_propagator *propagator, double count, const double *x,
                        double *restrict y);
