/* SPDX-License-Identifier: GPL-3.0-or-later
 * Leaving the circuit's solver when the circuit is quiet: nothing fires any more, and what is left,
 * a small current through the snubbers, follows a one-port's law (oneport.h) fitted to the last
 * cycle.
 *
 * What that costs in accuracy is bounded. Over that cycle the law is run beside the solver, from
 * the same state. By how much each mode of the machine is then wrong, five times that is taken to
 * be added in every cycle to come, in the same sense, less as the flux linkage falls (the law says
 * how far) and as the mode decays. */
#ifndef VS_SIM_QUIET_H
#define VS_SIM_QUIET_H

#include "sim/oneport.h"

typedef struct vs_quiet vs_quiet;

/* NULL: GSL finds no modes of this machine. */
vs_quiet *vs_quiet_new(const vs_setup *setup, const vs_frame *frame, const vs_memories *memories);
void vs_quiet_free(vs_quiet *q); /* NULL is fine */

/* Every knot of the circuit tier, in order, and what the circuit remembers then, V or A, as listed
 * (NaN: the solver does not show it; it is never left then); blocks: neither conducts nor was its
 * gate on. What was before the last knot that did not is not looked at. */
void vs_quiet_take(vs_quiet *q, const vs_knot *knot, const double *memory, bool blocks);

/* Can the solver be left at the last knot for until_s - t, by a law of no more than that lag? Looks
 * a few times a cycle, only when a whole cycle is known, and one is still to come. Then bound is
 * what p, u, w, phi, force or i may be wrong by at most, the worst of them relative to its peak so
 * far; it is within the share of run.tolerance that leaving may have. */
bool vs_quiet_may_leave(vs_quiet *q, double until_s, double most_lag_s, double *bound);

/* Takes the knot on to t_s, by the law found. knot is complete afterwards. */
vs_status vs_quiet_step(vs_quiet *q, vs_knot *knot, double t_s, vs_error *err);

/* The solver has been gone back to. */
void vs_quiet_restart(vs_quiet *q);

/* C of the law, F; 0: it has none. */
double vs_quiet_capacitance(const vs_quiet *q);

/* By how much the solver's terms, and what it remembers, differ from the one-port's: the worst of
 * them, in parts of what it may be wrong by, a few tolerances of its peak so far. */
double vs_quiet_missed(const vs_quiet *q, const vs_knot *one_port, const vs_knot *solver,
                       const double *memory);

/* Longest step, s, for which straight lines between knots keep the deck's terms. */
double vs_quiet_longest(const vs_quiet *q);

#endif
