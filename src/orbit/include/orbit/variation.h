/* SPDX-License-Identifier: GPL-3.0-or-later
 * How the state of a run on an ideal tier depends on the state at its beginning: the matrix
 * S = dy/dx0 of y = (q, q', lambda), exact but for the rounding of its integration. It is an
 * observer of the run: between two knots
 *   S' = J(t) S,   J = the equations' derivative along the step's own polynomials,
 * and at an instant that x0 moves, where h(y) = 0 and the rates f jump,
 *   S+ = S- + (f+ - f-) (dh/dy S-)/(dh/dy f-).
 * That is so at the extinction (h = lambda) and where the armature meets or leaves a stop (h = its
 * depth). A firing's instant is fixed: S goes through it as it is.
 *
 * One column more may tell how y depends on a parameter p of the equations (orbit/parameter.h):
 *   Y' = J(t) Y + df/dp,   Y+ = Y- + (f+ - f-) (dh/dy Y- + dh/dp)/(dh/dy f-),
 * and where p moves an instant by itself, as a firing's,   Y+ = Y- + (f- - f+) dt/dp.
 * Its time is counted in periods of the mains, as the parameter's is.
 *
 * Instead, that column may tell how y depends on a delay of the firings: of such a parameter
 * df/dp = 0 and dt/dp = 1 at each firing. */
#pragma once

#include <gsl/gsl_odeiv2.h>

#include "orbit/parameter.h"

/* The most numbers of y, and of x0, of which a coil without a valve has lambda too, and one with
 * eddy currents lambda and the secondaries' psi (plant/coil.h); one column more is the parameter's.
 */
enum { VS_VARIATION_MOST = VS_MOST_STATES + 1 + VS_MOST_RUNGS };

/* An instant at which the column of a parameter was taken from one side to the other. */
typedef struct vs_jump {
  long count;     /* how many there were, with this one */
  bool fires;     /* the thyristor fires */
  bool edge;      /* an event changes the mains; neither: the state moves the instant */
  double t_s;     /* when it is */
  double asked_s; /* of the first two: since when, and of the second from when on, it was to come */
  double moved_s; /* by how much the parameter p moves it: dt/dp */
} vs_jump;

/* Begin with vs_variation_begin, end with vs_variation_end. */
typedef struct vs_variation {
  const vs_model *model;
  bool valve;         /* a thyristor stands between mains and coil */
  bool conducting;    /* current may flow in the coil */
  bool fades;         /* it may not, but eddy currents keep a flux */
  unsigned touched;   /* the stops that the armature is in, as bits */
  vs_event ending;    /* how the last step ended, where its other side is still to be shown */
  double free_s;      /* how long the machine has swung freely since S was brought up to date */
  double mains_rad_s; /* of the mains' voltage */
  double at_s;        /* how far vs_variation_to has come */
  int columns;        /* of S: 2 dof, and those of lambda and psi as VS_VARIATION_MOST has it */
  int rows;           /* of y: 2 dof + 1, and psi */
  double *s;   /* S by columns: s[j rows + i] is dy_i/dx0_j; then the parameter's column, or that of
                  the delay; owned */
  bool delays; /* the last column is that of a delay */
  vs_parameter *parameter;  /* borrowed; NULL: there is none */
  vs_jump jump;             /* the last; where there is none yet, all is 0 */
  gsl_odeiv2_step *stepper; /* owned */
} vs_variation;

/* The run begins at the start of the setup, which must outlive this: S is the identity. */
void vs_variation_begin(vs_variation *variation, const vs_setup *setup);
/* Adds the column of a parameter, whose setups are of this run; dy/dp at t = 0 are these numbers.
 * To be called before the first step. */
void vs_variation_add(vs_variation *variation, vs_parameter *parameter, const double *y);
/* Begins with a parameter's column alone, without S. */
void vs_variation_begin_alone(vs_variation *variation, const vs_setup *setup,
                              vs_parameter *parameter, const double *y);
/* Adds the column of a delay of the firings, dy per second. To be called before the first step, and
 * not beside a parameter. */
void vs_variation_add_delay(vs_variation *variation);
void vs_variation_end(vs_variation *variation);

/* Goes along with an accepted step. Error: VS_RUN, the equations have no derivative on the way. */
vs_status vs_variation_accept(vs_variation *variation, const vs_step *step, vs_error *err);

/* Goes to an instant within the step that is to be accepted next, later than any before it: S is
 * then that of this instant. Errors: as of vs_variation_accept. */
vs_status vs_variation_to(vs_variation *variation, const vs_step *step, double t_s, vs_error *err);
/* Gives dS/dt at that instant, laid out as `s`. For a variation without a parameter. */
void vs_variation_rates(vs_variation *variation, const vs_step *step, double *rate);

/* S at the last knot that was shown, or where vs_variation_to has come: d(row i of y)/d(x0's j);
 * j = columns is the parameter's, or the delay's. */
double vs_variation_get(vs_variation *variation, int i, int j);
