/* SPDX-License-Identifier: GPL-3.0-or-later
 * The trajectory of a run on tier "circuit": the machine's motion beside the circuit, the contacts
 * with its stop, the thyristor's firing and extinction, and every step as the observer is shown it.
 */
#pragma once

#include <gsl/gsl_odeiv2.h>

#include "coupled/anode.h"
#include "engine/signals.h"
#include "engine/sim.h"
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

typedef struct vs_trajectory {
  const vs_setup *setup;
  vs_frame frame;
  const vs_observer *observer;
  vs_knot knots[2]; /* the last one shown is knots[now], the one before it the other */
  int now;
  vs_anode anode;
  vs_motion motion;
  vs_signals_cache
      edge;         /* the next edge of what drives the circuit; {0} where it may have changed */
  unsigned touched; /* the stops that the armature is in, as bits */
  bool jammed;      /* the armature is jammed, since jams_s */
  double jams_s;    /* INFINITY: it never is */
  size_t loads;     /* how many changes of the load are behind */
  double series_s;  /* how far the travel's Taylor polynomial is good enough */
  double candidate_s, candidate_gap_m; /* the last instant that was asked for, and the gap there;
                                          -1: the answer does not hold any more */
  double candidate_x[VS_MOST_STATES];  /* the state there; only where the deck names motions */
  vs_knot part[VS_STEP_PARTS]; /* instants of the step under way, with what the circuit knows */
  int parts;
  bool followed;  /* the thyristors were followed up to the knot that comes next */
  vs_event event; /* and did this, at event_s */
  double event_s;
  bool blank;    /* the last knot is the solver's first, of which it shows no terms */
  bool without;  /* the steps shown are a macromodel's, not the solver's */
  double strays; /* as vs_step has it */
  double bound;  /* on the error of having left the solver so far, relative to
                   each probe's peak */
} vs_trajectory;

/* Begins at t = 0. Setup and observer must outlive the trajectory. It stays where it is made, as
 * its motion points to itself. */
void vs_trajectory_begin(vs_trajectory *trajectory, const vs_setup *setup, const vs_frame *frame,
                         const vs_observer *observer);
void vs_trajectory_end(vs_trajectory *trajectory);

/* The first knot has what vs_trajectory_next has of the coil: the circuit stood there before. */
void vs_trajectory_stand(vs_trajectory *trajectory);

/* The last knot shown. */
static inline const vs_knot *vs_trajectory_last(const vs_trajectory *trajectory) {
  return &trajectory->knots[trajectory->now];
}

/* What vs_setup_edge returns of the trajectory's setup, from memory as far as it holds. */
double vs_trajectory_edge(vs_trajectory *trajectory, double t_s);

/* Room for the knot that comes next. It is void once a step was shown. */
static inline vs_knot *vs_trajectory_next(vs_trajectory *trajectory) {
  return &trajectory->knots[1 - trajectory->now];
}

/* Room for an instant of the step that ends at vs_trajectory_next; NULL: the step is to end there,
 * as the armature may meet a stop or there are too many. */
vs_knot *vs_trajectory_part(vs_trajectory *trajectory);
/* What was put there becomes one, with the deck's terms straight up to it. False: the step is to
 * end there, as a thyristor fires or goes out. */
bool vs_trajectory_pass(vs_trajectory *trajectory);

/* The gap, m, where the mechanics will be at t_s, foretold from the last knot. */
double vs_trajectory_gap(vs_trajectory *trajectory, double t_s);

/* The machine's state there, SI, by its index in (q, q'), or the gap's rate, m/s, by -1. The deck
 * must name one. Over a step h the gap and q are foretold up to h^4, the rates up to h^3. */
double vs_trajectory_motion(vs_trajectory *trajectory, int state, double t_s);

/* x' of the machine at x = (q, q') and a flux linkage, with the stops that it touches there. */
void vs_trajectory_rates(const vs_trajectory *trajectory, const double *x, double flux_wb,
                         double *rate);

/* Integrates the machine over the step from the last knot to vs_trajectory_next and shows it. The
 * caller has filled in what the circuit knows of that knot: time, lambda with two derivatives,
 * v_eva, i_mains, terms. The step is cut where the armature meets or leaves its stop, and such an
 * instant is shown from either side. Errors: the observer's; VS_RUN where GSL cannot integrate. */
vs_status vs_trajectory_move(vs_trajectory *trajectory, vs_error *err);

/* The last knot becomes the first of another part of the run: its clock is set back by by_s, the
 * setup and the observer from there on are these, and the machine's state is x. */
void vs_trajectory_turn(vs_trajectory *trajectory, double by_s, const vs_setup *setup,
                        const vs_observer *observer, const double *x);

/* Shows the step from the last knot to `to`, which is copied, or which is vs_trajectory_next.
 * `what` happens at its end, besides what the thyristor does. Errors: the observer's. */
vs_status vs_trajectory_show(vs_trajectory *trajectory, const vs_knot *to, vs_event what,
                             vs_error *err);
