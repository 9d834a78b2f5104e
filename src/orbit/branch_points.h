/* SPDX-License-Identifier: GPL-3.0-or-later
 * Points of a branch of orbits: pairs of a state x at the mains' rise through zero and a value k of
 * the scene's key with
 *
 *   P(x, k) = x,   n.(z - z0) = s,   z = (x, k),
 *
 * where P is the run over one period and the second equation is a plane: the one across the branch
 * s further on, or that of one value of k. Newton's iteration solves both together by the matrix
 * (I - dP/dx, -dP/dk; n), which is regular at a fold, too, where I - dP/dx alone is not. dP/dx is
 * the monodromy matrix; it and dP/dk come with the run (orbit/variation.h). With a circuit x is the
 * state of machine and circuit (circuit_flight.h), and dP/dk is a difference of runs along the same
 * steps. */
#pragma once

#include "circuit_flight.h"
#include "orbit/branch_parameter.h"
#include "orbit/shooting.h"
#include "orbit_extremes.h"

/* The numbers of z at most: the states, and the key behind the last of them. */
enum { VS_BRANCH_POINT_NUMBERS = VS_FLIGHT_STATES + 1 };

/* One orbit of the branch. */
typedef struct vs_branch_point {
  double z[VS_BRANCH_POINT_NUMBERS];   /* the states, SI, then the key in its axis' unit */
  double way[VS_BRANCH_POINT_NUMBERS]; /* the branch's direction, of length 1 in parts of the path's
                                          units */
  double size[VS_FLIGHT_STATES];       /* the largest magnitude of each state over the period */
  double period_s;
  double change; /* Newton's last correction, in parts of the motion */
  int iterations;
  double repeats; /* how far the state is from its own after fewer periods than asked, in parts of
                     the motion: the nearest; INFINITY: one period was asked for */
  vs_multiplier multiplier[VS_FLIGHT_STATES]; /* the largest first */
  int unstable;                               /* how many lie on the unit circle or beyond */
  vs_orbit_extremes turns;
  double pole_m; /* how far the least travel is from the pole cover, where no stop is before it, m;
                    NaN: that is no bound of this machine */
  double iron_m; /* the gap that is left at the least travel, pole cover and all, m; likewise */
} vs_branch_point;

typedef struct vs_branch_points {
  vs_branch_parameter *along; /* borrowed */
  vs_parameter *by;           /* the key as a parameter of the run; owned; NULL: not yet */
  vs_circuit_flight circuit;  /* on a tier with a circuit; owned */
  double noise;               /* to which P is known as a function of z, in parts of the motion: as
                                 runs choose their own steps; 0: to rounding */
  int periods;                /* n: P is the run over as many firing periods */
  int count;                  /* of the states; z[count] is the key */
  double unit[VS_BRANCH_POINT_NUMBERS]; /* what counts as 1 along each number of z */
  vs_budget budget;                     /* of the runs; without a limit where `most` is 0 */
  long runs;                            /* over a period, that were made so far */
  char kinked[256]; /* why a run of the last solution had no derivative with respect to the key;
                      empty: all had */
} vs_branch_points;

/* The plane that the point is to lie in. */
typedef struct vs_branch_plane {
  const double *normal; /* n, in parts of the path's units */
  const double *origin; /* z0 */
  double offset;        /* s */
} vs_branch_plane;

/* Frees what a path owns, also after an error of vs_branch_points_begin. */
void vs_branch_points_end(vs_branch_points *path);

/* Finds the orbit at the key's present value as vs_shooting_seek does, and begins the path with it;
 * the units are those of that orbit, and of the key's range. The point's way leads from
 * along->from to along->to. Errors: those of vs_shooting_seek; VS_RUN, the orbit found has a
 * smaller period. */
vs_status vs_branch_points_begin(vs_branch_points *path, vs_branch_parameter *along, int periods,
                                 vs_branch_point *first, vs_error *err);

/* Takes the units from the size of the motion at the point, and brings its way over to them. */
void vs_branch_points_rescale(vs_branch_points *path, vs_branch_point *at);

/* Solves for the point in the plane, beginning at point->z, and fills in all of it. The way is that
 * on the plane's side. Errors, VS_RUN: the iteration does not converge; current flows at t = 0; the
 * orbit leaves the coil's law. VS_INPUT: a value of the key on the way is not allowed. */
vs_status vs_branch_points_solve(vs_branch_points *path, const vs_branch_plane *plane,
                                 vs_branch_point *point, vs_error *err);
