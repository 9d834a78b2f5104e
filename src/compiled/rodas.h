/* SPDX-License-Identifier: GPL-3.0-or-later
 * RODASP: an L-stable, stiffly accurate Rosenbrock method of order 4 with an embedded one of order
 * 3 (Steinebach, Order-reduction of ROW-methods for DAEs and method of lines applications, preprint
 * 1741, TH Darmstadt 1995; as METH = 3 in rodas.f of Hairer and Wanner, Solving Ordinary
 * Differential Equations II, section VI.4), for M y' = f(t, y) with M singular. Its order is 4 for
 * stiff linear equations that are driven, too: with RODAS, whose order falls to 2 there, a coil
 * behind a thyristor that leaks took 7 times the steps at 1e-6 and was off by 7.3 tolerances
 * instead of 0.1. One step takes one factored matrix, M/(gamma h) - df/dy, and six solutions with
 * it. */
#pragma once

#include "equations.h"

/* What drives the equations: fills value[k] with what source k of the equations is at t_s. */
typedef struct vs_rodas_drive {
  void *ctx;
  void (*at)(void *ctx, double t_s, double *value);
} vs_rodas_drive;

typedef struct vs_rodas {
  vs_equations *e;
  vs_rodas_drive drive;
  double *y, *next, *error; /* the last state, that after the step, and the error of that */
  double *bend[2];          /* of the dense output */
  double *f;                /* at y and t_s, if `fresh` */
  double *jacobian, *factors, *matrix;
  double *k[6], *work[3], *source[4];
  double *memory; /* owned: all of these */
  bool ordered;   /* the order of the pivots is known */
  bool fresh;     /* f and the Jacobian are those of y at t_s */
  int culprit;    /* an unknown that no equation decides; -1: none */
  double t_s;
} vs_rodas;

void vs_rodas_begin(vs_rodas *r, vs_equations *e, const vs_rodas_drive *drive);
void vs_rodas_free(vs_rodas *r);

/* The method's numbers: the instants of its stages, as parts of a step, and how much of the slope
 * over time is in each of the first ones; how much of stage `of` is in a later one's state, and in
 * its right side. */
extern const double vs_rodas_at[6], vs_rodas_rate[4];
double vs_rodas_stage(int stage, int of);
double vs_rodas_coupling(int stage, int of);

/* Factors M per_h - df/dy, with the Jacobian there is. False: it is singular. */
bool vs_rodas_factor(vs_rodas *r, double per_h);

/* Tries a step of h from y at t_s. False: the matrix is singular. */
bool vs_rodas_try(vs_rodas *r, double h);

/* The state at a part 0..1 of the step that was tried, into y. */
void vs_rodas_dense(const vs_rodas *r, double part, double *y);
/* One unknown of it. */
static inline double vs_rodas_dense_of(const vs_rodas *r, int k, double part) {
  const double rest = 1 - part;
  return r->y[k] * rest + part * (r->next[k] + rest * (r->bend[0][k] + part * r->bend[1][k]));
}

/* Takes a step of h by the backward Euler rule, solved by Newton's iteration with limited
 * junctions, into next: behind a jump, where no slope is known. charge: M y at its beginning. With
 * `chooses` each iteration takes the branches and switches that it asks for; without, none changes.
 * False: it did not converge. */
bool vs_rodas_restart(vs_rodas *r, const double *charge, double h, bool chooses);

/* The step that was tried, or the restart, is taken: y becomes next. */
void vs_rodas_take(vs_rodas *r, double h);
