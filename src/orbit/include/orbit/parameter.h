/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a run on an ideal tier depends on one numeric key of its scene: the coefficients of its
 * equations, and those instants that the state does not fix. orbit/parameter_rates.h makes df/dp of
 * it.
 *
 * The parameter p is the key in parts of its own value: key = size (1 + p), so that d/dp is
 * d/d ln(key). Where the key is 0 it is key = size p instead, and size is one unit of the key.
 *
 * Time is counted in periods of the mains: a run at another supply.frequency is looked at after as
 * many periods, and its rates are those over the period of the scene itself. So a firing stays at
 * its angle, and the end of a period is the end of a period.
 *
 * The derivatives of the coefficients (M^-1 K, R_c, the gap at rest, the coil's law at a given
 * lambda and z, the mains' voltage, ...) come from six scenes with other values of the key, by
 * differences of sixth order. These are right to some 1e-12 of the coefficient. */
#pragma once

#include "engine/wave.h"
#include "run/keys.h"
#include "run/scene.h"

/* How many other scenes there are. */
enum { VS_PARAMETER_NEAR = 6 };

/* The derivatives of the coefficients with respect to p, of a model with `dof` coordinates. */
typedef struct vs_parameter_slopes {
  double mk_column[VS_MOST_DOF][VS_MOST_DOF], mb_column[VS_MOST_DOF][VS_MOST_DOF];
  double mf[VS_MOST_DOF], m0[VS_MOST_DOF], along[VS_MOST_DOF];
  double gap_rest_m, resistance_ohm;
  double at_m[VS_MOST_STOPS], stop_stiffness[VS_MOST_STOPS], stop_damping[VS_MOST_STOPS];
  double clock; /* of the mains' period, relative to it: -1 for supply.frequency */
} vs_parameter_slopes;

/* Begin with vs_parameter_begin, end with vs_parameter_end. Index 0 of the arrays is the scene as
 * it is. */
typedef struct vs_parameter {
  vs_key key;
  double value, size;                     /* of the key, SI; size is as above */
  double step;                            /* of p, between neighbouring scenes */
  double at[1 + VS_PARAMETER_NEAR];       /* p of each scene */
  double weight[1 + VS_PARAMETER_NEAR];   /* d/dp = sum of weight (v - v of the scene as it is) */
  double coarse[1 + VS_PARAMETER_NEAR];   /* the same to fourth order, to tell the error by */
  vs_scene *scene[1 + VS_PARAMETER_NEAR]; /* owned, but for the first, which is borrowed */
  vs_setup *setup; /* of the run that is looked at, for each scene; owned; what the scene's own
                      setups own is borrowed */
  vs_parameter_slopes slopes;
  bool idle;     /* the tier ignores the key, so that all derivatives are 0 */
  char why[256]; /* where it does, what the scene says to the key */
  vs_wave mains[1 + VS_PARAMETER_NEAR];   /* of the present conduction */
  double origin_s[1 + VS_PARAMETER_NEAR]; /* where each wave's time begins, in that scene's time */
} vs_parameter;

/* Takes the key of that name in a settled scene, which must outlive this, and finds whether
 * anything hears it; without other scenes, so that vs_parameter_end has nothing to end. Errors,
 * VS_INPUT, at `where`: no such key; it is a word, a pair or a whole number. */
vs_status vs_parameter_look(vs_parameter *parameter, const vs_scene *scene, const char *key,
                            vs_where where, vs_error *err);
/* Does so and makes the other scenes; vs_parameter_take gives their setups. step: of p, between the
 * scenes; 0 stands for the usual one, with which differences of coefficients are best. Where the
 * key's range ends near its value all scenes lie on one side of it. known: another parameter of the
 * key in this scene, which spares it the look; NULL: there is none. Errors: those of
 * vs_parameter_look; VS_INPUT, its range leaves no room. */
vs_status vs_parameter_begin(vs_parameter *parameter, const vs_scene *scene, const char *key,
                             vs_where where, double step, const vs_parameter *known, vs_error *err);
void vs_parameter_end(vs_parameter *parameter);

/* Goes on with another value of the key, which the scene has by now: the other scenes get theirs by
 * vs_scene_reread, so that their tier must stand in them. The setups are to be taken anew. Errors:
 * those of vs_scene_reread, and VS_INPUT where the key is or was 0; the parameter is then only good
 * to end it. */
vs_status vs_parameter_again(vs_parameter *parameter, vs_error *err);

/* Puts the setups of another run in the place of the scenes' own: make(scene, ctx) gives that of
 * each scene, which may borrow from the scene's. */
void vs_parameter_take(vs_parameter *parameter, vs_setup (*make)(const vs_scene *scene, void *ctx),
                       void *ctx);

/* d/dp of a number of which v[0] is the scene's own, v[k] that of the k-th other scene. It is
 * exactly 0 where all are the same. */
double vs_parameter_slope(const vs_parameter *parameter, const double v[1 + VS_PARAMETER_NEAR]);

/* d/dp of the state (q, q', lambda) at t = 0, as many numbers as the run's y has. */
void vs_parameter_start(const vs_parameter *parameter, const vs_tier *tier, double *y);

/* The instant of the k-th scene that is as many periods on as t_s is in the scene as it is. */
double vs_parameter_time(const vs_parameter *parameter, int k, double t_s);

/* The thyristor fires at t_s, and was off at off_s and since then. Returns by how much p moves that
 * instant, s; NaN: near the key's value it comes or goes. */
double vs_parameter_fires(vs_parameter *parameter, double off_s, double t_s);
/* Mains of other sines begin at t_s, as an event has an edge there. before_s: an instant in the
 * step before. Returns by how much p moves the edge, s; NaN as above.
 */
double vs_parameter_edge(vs_parameter *parameter, double before_s, double t_s);
/* The coil is on the mains from t_s on. */
void vs_parameter_connects(vs_parameter *parameter, double t_s);
