/* SPDX-License-Identifier: GPL-3.0-or-later
 * Search for the least value of a function on the unit cube, generation by generation: it asks for
 * points, is told the values, and knows nothing of what they mean. Global first: Sobol points, the
 * population of differential evolution (Storn and Price, J. Global Optimization, 1997) by crowding
 * (Thomsen, CEC 2004); then local: pattern search about the best one, along the axes and on in the
 * direction it went (Hooke and Jeeves, J. ACM, 1961). The same seed and values give the same
 * points.
 */
#ifndef VS_METHOD_SEARCH_H
#define VS_METHOD_SEARCH_H

#include <stddef.h>
#include <stdint.h>

enum { VS_SEARCH_AXES = 40 }; /* at most; Sobol points give the first ones (VS_SOBOL_AXES) */

typedef struct vs_search_setup {
  size_t axes;
  int levels[VS_SEARCH_AXES]; /* of an axis: 0, a continuum; n: in the middles of n parts alone */
  uint64_t seed;
  size_t most;   /* points in all, at least one */
  double finest; /* local search: ends with steps shorter than this part of an axis */
} vs_search_setup;

typedef struct vs_search vs_search;
vs_search *vs_search_new(const vs_search_setup *setup);
void vs_search_free(vs_search *search);

/* The points of the next generation, point by point, borrowed until it is told; *count of them,
 * 0: the search is over. To ask twice gives the same. */
const double *vs_search_ask(vs_search *search, size_t *count);

/* Their values in the same order; NaN: there is none, which is worse than any. */
void vs_search_tell(vs_search *search, const double *values);

/* The best point so far; *value NaN: none had one. */
const double *vs_search_best(const vs_search *search, double *value);

/* "start", "evolution", "pattern": what asked for the present generation. */
const char *vs_search_phase(const vs_search *search);

#endif
