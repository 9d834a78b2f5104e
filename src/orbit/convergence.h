/* SPDX-License-Identifier: GPL-3.0-or-later
 * How the corrections of a search for an orbit go on from pass to pass: whether they still fall,
 * have stalled at what the solver rounds, or creep because something in the circuit does. Each is a
 * size relative to the motion's. */
#ifndef VS_ORBIT_CONVERGENCE_H
#define VS_ORBIT_CONVERGENCE_H

#include <stdbool.h>

/* Begins with vs_convergence_begin. */
typedef struct vs_convergence {
  double tolerance; /* run.tolerance */
  double wanted;    /* what a correction is to come below */
  double last;      /* the last one */
  double least;     /* the least so far */
  int stalled;      /* passes since it last fell */
  double noise;     /* the largest of these */
  double before;    /* the one before the last; 0: there is none */
  double ratio;     /* of the two */
  int steady;       /* for how many passes that ratio has been about the same, and slow */
  double creeps;    /* that ratio; 0: corrections fall fast */
  double remains; /* the sum of the last one and of all that are still to come; 0: they fall fast */
} vs_convergence;

/* The part of run.tolerance that may remain of what creeps in the circuit. */
extern const double vs_convergence_crept;

void vs_convergence_begin(vs_convergence *corrections, double tolerance);

/* Takes in the last one. */
void vs_convergence_take(vs_convergence *corrections, double size);

/* Forgets how fast they fall, as what crept has been moved. */
void vs_convergence_forget(vs_convergence *corrections);

/* True where the orbit is known well enough; `last` is then what it is known to. */
bool vs_convergence_close(vs_convergence *corrections);

#endif
