/* SPDX-License-Identifier: GPL-3.0-or-later
 * Trying something in a child process that may die of it. ngspice ends the process it is in for an
 * undefined parameter; other nonsense crashes it, at loading or in its first step, or keeps it for
 * ever. */
#ifndef VS_SOLVER_CHILD_H
#define VS_SOLVER_CHILD_H

#include "solver/complaints.h"

/* How the child ended by itself: the circuit can be loaded and begins to run (or what is wrong with
 * it does no harm to a process); it cannot be loaded; it cannot be run. */
typedef enum vs_child_end { VS_CHILD_GOOD, VS_CHILD_BAD_LOAD, VS_CHILD_BAD_RUN } vs_child_end;

/* Calls attempt(ctx) in a child process, without standard output and error, and waits for the
 * child's end. *end is what attempt returned, or what it gave to vs_child_finish; unless that is
 * VS_CHILD_GOOD, the child's *complaints are then this process's. Errors: VS_INPUT, the child died
 * of a signal or did not come back in 20 s; VS_SIGNAL, a signal that is handled came meanwhile;
 * VS_RUN, there is no child to be had. */
vs_status vs_child_try(vs_child_end (*attempt)(void *ctx), void *ctx, vs_complaints *complaints,
                       vs_child_end *end, vs_error *err);

/* Ends the child at once from within the attempt, as VS_CHILD_GOOD. */
_Noreturn void vs_child_finish(void);

#endif
