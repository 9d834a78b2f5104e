/* SPDX-License-Identifier: GPL-3.0-or-later
 * Cases whose runs begin alike. Cases of tier circuit that differ in keys of events alone make the
 * same run, to the last bit, until what drives them first differs (divergence.h). A worker
 * makes this shared prefix of their runs once, and goes on from there for each of them: it forks
 * within a callback of ngspice, whose whole state is copied so. The rows are those of runs on their
 * own, to the byte.
 *
 * The processes, each of which waits for the next one:
 *
 *   the worker   runs the prefix: a scene in which the events that some axis varies never begin. At
 *                the first knot where one of its tasks parts from that it stops, and stays there
 * for all later tasks that part from it no earlier. a runner     a copy of the worker, one for each
 * batch of tasks: it takes the prefix on, from knot to knot at which a case parts. a branch     a
 * copy of the runner: it takes the events of one case for those of the prefix, and goes on to that
 * case's end. Its row goes back through pipes.
 *
 * The worker runs by itself, as without all this, what shares nothing: a case whose netlist or
 * whose other keys are not those of the prefix (which may have a prefix of its own next), a case
 * that differs from the first instant on, and a case whose runner or branch did not come to its
 * end. */
#pragma once

#include "workers/task_pipe.h"

/* True for a plan whose cases may share their past: some axis is a key of an event. */
bool vs_shared_prefix_applies(const vs_plan *plan);

typedef struct vs_shared_prefix vs_shared_prefix;
/* Plan, case and desk are borrowed. Nobody frees it, as its process ends with it. */
vs_shared_prefix *vs_shared_prefix_new(const vs_plan *plan, vs_case *c, vs_task_pipe *desk);

/* Runs the desk's tasks, and those that come in meanwhile, and answers them. */
void vs_shared_prefix_run(vs_shared_prefix *past);
