/* SPDX-License-Identifier: GPL-3.0-or-later
 * Decides when the circuit tier may leave the circuit's solver, and goes on in its place.
 *
 * Behind the last firing a scene is quiet: all that flows is a small current through the snubbers.
 * That current follows a simple law, a one-port with a periodic source (oneport.h), which is far
 * quicker to integrate than the netlist. The law is fitted to the last mains cycle. It is gone by
 * only if its error is bounded, to the time until which the solver is to be left:
 *
 *  - The law is run beside the solver over the last cycle, from the same state. What it is wrong by
 *    there, times five for what that cycle may not show, is added up over all the cycles to come,
 *    always in the same sense, less as the flux linkage falls and as the machine's modes decay.
 *  - The law is asked about earlier cycles, which tells how fast it goes wrong (walk.h).
 *  - Every signal must stay in the range in which it was seen, half of that range more at each end.
 *  - The bound must hold at two looks in a row, as one may look right by chance.
 *
 * record.h keeps what the solver showed; modal.h splits the machine's error into its modes. */
#ifndef VS_QUIET_QUIET_H
#define VS_QUIET_QUIET_H

#include "quiet/oneport.h"

typedef struct vs_quiet vs_quiet;

/* Makes one for a run. The caller owns it and frees it; setup, frame and memories must outlive it.
 * Returns NULL where GSL finds no modes of this machine; then the solver is never to be left. */
vs_quiet *vs_quiet_new(const vs_setup *setup, const vs_frame *frame, const vs_memories *memories);
void vs_quiet_free(vs_quiet *q); /* NULL is fine */

/* Shows it the next knot of the solver's; every knot is to be shown, in order of time. memory[k] is
 * the value of memories->item[k] there, V or A. A NaN says that the solver does not show one; then
 * it is never left. `blocks` is true as long as the thyristor carries no current. When it is false,
 * all knots so far are forgotten but for their peaks: a law counts from the last conduction on. A
 * gate may be on while the thyristor blocks; the caller does not ask to leave then. */
void vs_quiet_take(vs_quiet *q, const vs_knot *knot, const double *memory, bool blocks);

/* Asks whether the solver can be left at the last knot, until until_s, by a law that lags no more
 * than most_lag_s (INFINITY: by any). It looks at most four times a cycle, as a look costs as much
 * as some steps of the solver, and only where two cycles are known and one at least is to come.
 * Returns true if it can; the law is then ready for vs_quiet_step. *bound is then what p, u, w,
 * phi, the force, i or a signal of the deck may be wrong by, the worst of them relative to its peak
 * so far. For the machine and the coil that is within three quarters of run.tolerance; the rest is
 * left to the solver's other steps. A signal may take three run.tolerance, as it runs straight from
 * knot to knot. Otherwise *bound has no meaning. */
bool vs_quiet_may_leave(vs_quiet *q, double until_s, double most_lag_s, double *bound);

/* Takes *knot on to t_s, s, by the law found, and completes it. Fails with VS_RUN where GSL cannot
 * integrate; *knot is then as it was. */
vs_status vs_quiet_step(vs_quiet *q, vs_knot *knot, double t_s, vs_error *err);

/* Forgets all knots, but not the peaks: to be called when the solver has been gone back to. */
void vs_quiet_restart(vs_quiet *q);

/* The law's capacitance C, F, by which the solver is led back; 0 for the law without one. */
double vs_quiet_capacitance(const vs_quiet *q);

/* Compares the solver with the one-port where it is gone back to: the deck's terms, the mains
 * current, and `memory`. Returns the worst difference, in parts of what that signal may be wrong
 * by. More than 1 means that the bound was missed. */
double vs_quiet_missed(const vs_quiet *q, const vs_knot *one_port, const vs_knot *solver,
                       const double *memory);

/* Longest step without the solver, s. The deck's terms run straight from knot to knot; a sine of
 * the mains is then wrong by run.tolerance of its peak at most. */
double vs_quiet_longest(const vs_quiet *q);

#endif
