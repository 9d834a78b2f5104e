/* SPDX-License-Identifier: GPL-3.0-or-later
 * An unknown of a fit: a scene key whose value is to be found, with its bounds and what is known of
 * it beforehand.
 *
 * An unknown has three coordinates. Its value x is in the unit of its key. Its natural coordinate s
 * is ln(x) where x is always positive, so that a change of s by 0.01 is one of x by 1 %; otherwise
 * it is x divided by a scale. Errors, correlations and directions are told in s. The solver works
 * with t, which may be any number: within bounds a and b of s
 *
 *   s = a + (b - a)(1 + sin t)/2        both bounds
 *   s = a - 1 + sqrt(1 + t^2)           a alone; likewise for b alone
 *   s = t                               none
 *
 * so that no step leaves the bounds. The transformation is that of MINUIT (James and Roos, Computer
 * Physics Communications 10 (1975) 343). */
#pragma once

#include "run/axis.h"

typedef struct vs_unknown {
  vs_axis axis;           /* the key, its unit, its place in the fit */
  char name[VS_KEY_SIZE]; /* how it is shown: the key, or "2.KEY" for a key of the second run */
  int run;                /* the run whose key it is, from 0; -1: of all runs */
  bool log;               /* s = ln(x) */
  double scale;           /* in the key's unit; 1 where s = ln(x) */
  double start;           /* x at which the first search begins */
  double from, to;        /* bounds of x; -INFINITY, INFINITY: none */
  double prior,
      prior_error; /* s as it is known beforehand, with its standard error; NaN: it is not */
} vs_unknown;

/* Reads the map under `free` that has the key of an unknown: from, to, start, prior, each of which
 * may be missing. scene: of the run, or of the first one. run: as in the struct. Errors: those of
 * vs_axis_init and vs_axis_number; bounds that exclude the start; a value that cannot be an
 * unknown. vs_unknown_free even then. */
vs_status vs_unknown_read(vs_unknown *unknown, const vs_scene *scene, const vs_node *node, int run,
                          vs_error *err);
void vs_unknown_free(vs_unknown *unknown);

/* From one coordinate to another. */
double vs_unknown_natural(const vs_unknown *unknown, double x);
double vs_unknown_value(const vs_unknown *unknown, double s);
double vs_unknown_inside(const vs_unknown *unknown, double t); /* s of t */
double vs_unknown_slope(const vs_unknown *unknown, double t);  /* ds/dt */
/* t of s. On a bound, where a small step of t would not move s, it is that of an s a little
 * inside. */
double vs_unknown_free_of(const vs_unknown *unknown, double s);

/* The bounds of s; infinite where there are none. */
double vs_unknown_least(const vs_unknown *unknown);
double vs_unknown_most(const vs_unknown *unknown);

/* Puts the value of s into a scene's tree, to the last digit. */
void vs_unknown_put(const vs_unknown *unknown, double s, vs_tree *tree);

/* Reads an error: "3 %" of the value, or an amount in a unit of the same kind. *relative tells
 * which; *error is the share, or the amount in SI. Errors: it is neither; it is not positive. */
vs_status vs_unknown_error(const vs_node *node, const char *what, const char *unit, double *error,
                           bool *relative, vs_error *err);
