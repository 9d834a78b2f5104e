/* SPDX-License-Identifier: GPL-3.0-or-later
 * Decides when the circuit tier may leave the circuit's solver, and goes on in its place: the
 * stand-in that the program has (engine/stand_in.h).
 *
 * Behind the last firing a scene is quiet: all that flows is a small current through the snubbers.
 * That current follows a simple law, a one-port with a periodic source (oneport.h), which is far
 * quicker to integrate than the netlist. The law is fitted to the last cycle of the mains. The
 * solver is left only if the law's error is bounded up to the time at which the solver comes back:
 *
 *  - The law is run beside the solver over the last cycle, from the same state. Its error there,
 *    times five for what that cycle may not show, is added up over all the cycles to come, always
 * in the same sense. It is added up less as the flux linkage falls and as the machine's modes
 * decay.
 *  - The law is compared with earlier cycles, which shows how fast it goes wrong (walk.h).
 *  - Every signal must stay in the range in which the solver showed it, widened at either end by
 *    half of that range.
 *  - The bound must hold at two looks in a row, as one alone may look right by chance.
 *
 * The solver is never left where the armature jams or the load changes; where the deck tells the
 * time by itself; where it has no store, or a state that nobody sees; or where the machine has
 * springs between p and the other coordinates. It is not left while the thyristor conducts, a gate
 * is on, or an event needs short steps.
 *
 * A look costs as much as some of the solver's steps, so the question is answered at most four
 * times a cycle, and only where two cycles are known and at least one is to come. The bound on the
 * machine and the coil is within three quarters of run.tolerance; the rest is left to the other
 * steps that the solver takes when it is gone back to. A signal of the deck may
 * be wrong by three times run.tolerance in all: linear interpolation between knots uses one of the
 * three already.
 *
 * record.h keeps what the solver showed; modal.h splits the machine's error into its modes. */
#ifndef VS_ENGINE_QUIET_H
#define VS_ENGINE_QUIET_H

#include "engine/stand_in.h"

extern const vs_stand_in vs_quiet_stand_in;

#endif
