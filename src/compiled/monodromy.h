/* SPDX-License-Identifier: GPL-3.0-or-later
 * How the state hangs on where a stretch of the run began. The state is told by numbers z that do
 * not hang on each other: of the charges and fluxes M y as many as M has rank, the machine's states
 * first. S = dy/dz(0) obeys M S' = df/dy S, which RODASP solves along the steps that the run takes,
 * with df/dy from their dense output and the factors that they have anyway. Through a restart it
 * goes as the charges do. An edge of what drives has its instant, and a kink changes nothing. Where
 * f jumps at an instant that the state moves,
 *   M S+ = M S- + (f- - f+) dt/dz(0),
 * and dt/dz(0) comes of the state at which the branch or switch asks to be another one. */
#pragma once

#include "rodas.h"

/* A branch or switch that asks to be another one. */
typedef struct vs_monodromy_due {
  int device;
  double at_s, ahead_s; /* since when, and so much before it is asked, from the last step's end */
} vs_monodromy_due;

typedef struct vs_monodromy {
  vs_equations *e;       /* borrowed */
  int states;            /* of z */
  int *row;              /* of M y, which are z; owned */
  int *entry, entries;   /* row, column and place of each value of the matrix; owned */
  double *embedded;      /* all of M y is this times z: n rows of `states`. Owned, with the rest: */
  double *s, *charge;    /* S, and M S where a restart begins */
  double *k[6], *at, *b; /* of a step: as S */
  double *jacobian[6];   /* of a step's stages; the last one: its slope over time, times h */
  double *y;             /* a state within a step */
  double *rate;          /* y' at the last step's end */
  double *jump;          /* f before a jump that is due */
  double *moved;         /* dt/dz(0) of its instant */
  vs_monodromy_due due;
  bool finds, jumps; /* one is due; and f jumps by it */
  bool follows;      /* S is wanted of this stretch */
  bool known;        /* and was not lost in it */
} vs_monodromy;

void vs_monodromy_begin(vs_monodromy *m, vs_equations *e);
void vs_monodromy_free(vs_monodromy *m);

/* z of charges M y; and the charges of z. */
void vs_monodromy_state(const vs_monodromy *m, const double *charge, double *z);
void vs_monodromy_charge(const vs_monodromy *m, const double *z, double *charge);

/* A stretch begins, with the restart to come. */
void vs_monodromy_start(vs_monodromy *m, bool follows);
/* A restart is to come. */
void vs_monodromy_stop(vs_monodromy *m);
/* At r->y, where f is this, branches and switches are about to be chosen. */
void vs_monodromy_look(vs_monodromy *m, const vs_rodas *r, const double *f);
/* They were, and f has jumped by that. */
void vs_monodromy_jump(vs_monodromy *m, const vs_rodas *r);
/* Takes S through the restart of h, or the step of h, which is not taken yet. */
void vs_monodromy_restart(vs_monodromy *m, vs_rodas *r, double h);
void vs_monodromy_step(vs_monodromy *m, vs_rodas *r, double h);

/* dz/dz(0), row by row. */
void vs_monodromy_slope(const vs_monodromy *m, double *slope);
