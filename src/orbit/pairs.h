/* SPDX-License-Identifier: GPL-3.0-or-later
 * The circuit's own Phi, for a search that does not come near its orbit with that of tier switched.
 *
 * Where tier switched's Phi does not do, as with a stop that this tier does not reach or reaches
 * later, the circuit's own is taken, by differences. The parent and a copy for each state run for
 * two periods, in the first of which the circuit forgets; R of the second is Phi, all that the
 * circuit remembers included. From the pair's residual and R comes Newton's step. Copies try it,
 * and parts of it; the best one is taken. A run that fails, as the stop gives way, is then that of
 * a copy. */
#ifndef VS_ORBIT_PAIRS_H
#define VS_ORBIT_PAIRS_H

#include "search.h"

/* So many pairs follow on one march. */
enum { VS_PAIRS = 8 };
/* For so many firing periods the machine is left to itself: before the first pair where no orbit of
 * tier switched is known, times the orbit's period; and where pairs have come to nothing. */
enum { VS_PAIRS_MARCH = 30, VS_PAIRS_LONG_MARCH = 200 };
/* Passes that are not steered, but for the long march: two rounds of pairs, and the short march. */
enum { VS_PAIRS_PASSES = 4 * VS_PAIRS + VS_PAIRS_MARCH + 1 };

/* Begins a pair at search->x: sends the copies that Phi is found from. search->next is set, also in
 * a copy. Errors: VS_RUN, there are no processes to be had; the budget is spent. */
vs_status vs_pairs_begin(vs_search *search, vs_error *err);

/* A pass that was not steered has ended. Sets where the next one begins, and what it is for.
 * Errors: VS_INPUT, the machine, left to itself, comes back after another number of periods;
 * VS_RUN, it does not come back, or pairs lead nowhere. */
vs_status vs_pairs_turn(vs_search *search, const vs_knot *end, vs_error *err);

#endif
