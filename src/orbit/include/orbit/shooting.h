/* SPDX-License-Identifier: GPL-3.0-or-later
 * The periodic orbit of a scene on an ideal tier, by shooting. The unknown is the machine's state
 * at the mains' rise through zero; the map is one period's run; its derivative, the monodromy
 * matrix, is integrated along that run by the variational equations and taken through each firing,
 * extinction and stop (orbit/variation.h). Newton's iteration then converges quadratically, however
 * slowly the machine's own modes decay. */
#pragma once

#include "orbit/multipliers.h"
#include "run/scene.h"

/* The states of the map: q, q' (plant/model.h) and, where no valve stands before the coil, the
 * flux linkage lambda as the last one. With a thyristor lambda is 0 at t = 0, and is no state. */
enum { VS_ORBIT_STATES = VS_VARIATION_MOST };
/* The most iterations of one search; where the orbit found repeats earlier than asked, the search
 * of that one is counted on. */
enum { VS_ORBIT_ITERATIONS = 40 };

typedef struct vs_orbit {
  double period_s;           /* n firing periods, each of firing.every cycles of the mains */
  int n;                     /* the least number after which the state repeats */
  int count;                 /* of the states, and of the multipliers */
  double x[VS_ORBIT_STATES]; /* the state at t = 0, the mains' rise through zero: m, rad, m/s, rad/s
                                and Wb */
  double scale[VS_ORBIT_STATES]; /* the largest magnitude of each state over the period, > 0 */
  double monodromy[VS_ORBIT_STATES][VS_ORBIT_STATES]; /* dx(period)/dx(0); [i][j] is row i */
  vs_multiplier multiplier[VS_ORBIT_STATES]; /* its eigenvalues, the largest first; a pair by
                                                falling imaginary part */
  int iterations;                            /* of Newton's, the last included */
  double correction[VS_ORBIT_ITERATIONS]; /* the size of each one's correction: the largest over the
                                             states, relative to scale */
  double residual;                        /* the last of these */
  int runs_on;                            /* where the search failed as the machine runs on an orbit
                                             of another period: that period; else 0 */
  bool stable;                            /* all multipliers lie within the unit circle */
} vs_orbit;

/* How an orbit is looked for. */
typedef struct vs_shooting {
  int periods;        /* n, 1 or more */
  const double *from; /* where Newton's iteration begins: `count` states; NULL: where a short run
                         from the scene's `start` leads */
  bool unguarded;     /* an orbit that goes beyond the pole cover without a stop, or beyond what the
                         coil's law knows, is no error */
  bool quietly; /* neither is one of a smaller period than `periods`, which orbit->n tells, nor
                   an unstable one beside a subharmonic */
} vs_shooting;

/* Finds the orbit of n firing periods, from the program's own start: a short run from the scene's
 * `start`, and a longer one where that does not lead to an orbit. Errors, one line each. VS_INPUT:
 * firing.every is once; a direct voltage; a tier with a circuit; events, the first by its name; n
 * is not positive. VS_RUN: no orbit is found, with how far the search came; the orbit found repeats
 * after fewer periods than n, or it is unstable, and the machine runs on a subharmonic of it
 * (orbit->runs_on); the budget of the scene's order is spent; the orbit goes beyond the pole cover
 * and the scene has no stop; it leaves the coil's law; current still flows at t = 0; those of the
 * run. */
vs_status vs_shooting_find(const vs_scene *scene, int periods_n, vs_orbit *orbit, vs_error *err);

/* The same, looked for as `how` says. */
vs_status vs_shooting_seek(const vs_scene *scene, const vs_shooting *how, vs_orbit *orbit,
                           vs_error *err);

/* Of these errors those that are known before any search, on whatever tier. */
vs_status vs_shooting_check(const vs_scene *scene, int periods_n, vs_error *err);

/* What lets the scene's machine swing less far, for messages. */
const char *vs_shooting_weakens(const vs_scene *scene);

/* Makes the setup of a run of this scene along the orbit, from t = 0 at the mains' rise through
 * zero, firing from the first cycle on, until run->until_s. It borrows what the scene's setup owns,
 * and is not to be freed. */
vs_setup vs_shooting_setup(const vs_scene *scene, const vs_run_values *run, const vs_orbit *orbit);
