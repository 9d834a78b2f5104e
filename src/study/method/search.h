/* SPDX-License-Identifier: GPL-3.0-or-later
 * A search for the least value of a function on the unit cube. It goes on generation by generation:
 * it asks for points, is told their values, and knows nothing of what they mean. The same seed and
 * values give the same points. There are two ways.
 *
 * Without restarts it looks globally first: Sobol points are the population of differential
 * evolution (Storn and Price, J. Global Optimization, 1997) by crowding (Thomsen, CEC 2004). Then
 * it looks locally: pattern search goes from the best point along the axes, and on in the direction
 * in which it went (Hooke and Jeeves, J. ACM, 1961). That suits smooth functions.
 *
 * With restarts it begins with Sobol points in strata: over the known periods of each axis, the
 * place in a period, and the combinations of levels; the first of them lie at both ends of each
 * axis. From the best of them that are apart from each other (multi level single linkage: Rinnooy
 * Kan and Timmer, Mathematical Programming, 1987) climbs go on, of which the better half goes on
 * each time (successive halving: Jamieson and Talwalkar, AISTATS 2016). Along a single axis a climb
 * closes in on both sides, so that it finds an edge, and tries the same place of other periods.
 * Along several it changes a few axes at random, by less and less. That suits rugged functions with
 * jumps. */
#pragma once

#include <stddef.h>
#include <stdint.h>

enum { VS_SEARCH_AXES = 40 }; /* at most; Sobol points give the first ones (VS_SOBOL_AXES) */

typedef struct vs_search_setup {
  size_t axes;
  int levels[VS_SEARCH_AXES];    /* of each axis: 0, it is a continuum; n, points lie only in the
                                    middles of n equal pieces of it */
  double period[VS_SEARCH_AXES]; /* of each axis: what is known to repeat along it, as a part of
                                    it; 0: nothing is */
  size_t restarts; /* local searches, each from another place; 0: evolution, and then one */
  uint64_t seed;
  size_t most;   /* points in all, at least one */
  double finest; /* the local search ends when its steps are shorter than this; an axis is 1 long */
} vs_search_setup;

typedef struct vs_search vs_search;
vs_search *vs_search_new(const vs_search_setup *setup);
void vs_search_free(vs_search *search);

/* Returns the points of the next generation, [*count][axes], which are the search's own and last
 * until it is told their values. *count 0: the search is over. To ask twice gives the same. */
const double *vs_search_ask(vs_search *search, size_t *count);

/* Tells the values of these points in the same order. NaN: the point has no value, which is worse
 * than any. */
void vs_search_tell(vs_search *search, const double *values);

/* Returns the best point so far and its value; *value is NaN while no point had one. For tests. */
const double *vs_search_best(const vs_search *search, double *value);

/* Returns how many restarts were begun. */
size_t vs_search_restarts(const vs_search *search);
/* Returns how many of them came to the place of the best point; *near: to its value. They agree
 * that came so near to it: in parts of each axis, and of the value. */
#define VS_SEARCH_AGREE 0.01
size_t vs_search_agree(const vs_search *search, size_t *near);

/* Returns what asked for the present generation: "start", "evolution", "pattern" or
 * "restarts". */
const char *vs_search_phase(const vs_search *search);
