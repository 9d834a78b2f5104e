/* SPDX-License-Identifier: GPL-3.0-or-later
 * How fast a one-port's law (oneport.h) goes wrong, by the test on cycles that it was not fitted
 * to.
 *
 * A law is fitted to the last cycle, where it may look right by chance. Here it is asked about a
 * cycle one to three periods earlier, which the solver showed too. By how much more it is wrong
 * there, divided by the cycles in between, is its walk. The walk is then extrapolated: the law is
 * taken to go wrong by as much more in every cycle to come, always in the same sense. What dies
 * away in the circuit counts as well, as if it came up.
 *
 * Nothing here fails for want of memory or of a solution: an answer that cannot be had is infinite
 * or false, and then the solver is not left. */
#ifndef VS_QUIET_WALK_H
#define VS_QUIET_WALK_H

#include "quiet/modal.h"
#include "quiet/record.h"

/* A mean, and three pairs of a cosine and a sine of the mains' harmonics. They do not change when
 * the same error is seen in another cycle at other knots, so that two cycles can be compared. */
enum { VS_WALK_SHARES = 1 + 2 * VS_HARMONICS };

/* The error of every signal over one cycle, in these parts, V or A. */
typedef struct vs_walk_shares {
  double of[VS_SIGNALS][VS_WALK_SHARES];
} vs_walk_shares;

/* The growth of an error from one cycle to the next. */
typedef struct vs_walk {
  double current_a, force_n; /* of the coil */
  double mode[VS_STATES];    /* what each mode of the machine takes in a cycle, as its shape */
  double signal[VS_SIGNALS]; /* V or A */
} vs_walk;

/* Splits the signals' errors over the cycle in view. The coil is taken where the solver has it, so
 * that only the signals' own law is tested. */
void vs_walk_shares_of(const vs_record *record, const vs_oneport *port, vs_walk_shares *out);

/* Takes the cycle that ended `ago` cycles before the last knot into view, and finds the walk from
 * there. `fitted` are the parts of the last cycle. Returns false where that cycle is not known. */
bool vs_walk_find(vs_record *record, const vs_oneport *port, const vs_modal *modal,
                  const vs_walk_shares *fitted, int ago, vs_walk *out);

/* What the walk makes of the coil's force and current in so many cycles: the worse of the two,
 * relative to its peak, with the margin for a walk. */
double vs_walk_electric(const vs_record *record, const vs_walk *walk, double cycles);

/* What the signals are wrong by after so many cycles: the worst of them, relative to its peak.
 * `misfit_now` is each signal's error in the last cycle, V or A. Returns INFINITY where something
 * that the circuit remembers walks further than allowed. */
double vs_walk_signals(const vs_record *record, const vs_oneport *port, const vs_modal *modal,
                       const double misfit_now[VS_SIGNALS], const vs_walk *walk, double cycles);

#endif
