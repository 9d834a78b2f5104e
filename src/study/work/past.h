/* SPDX-License-Identifier: GPL-3.0-or-later
 * Cases that share their past. Cases of tier circuit that differ in keys of events alone make the
 * same run, to the last bit, until what drives them first differs (parting.h). A worker makes
 * that part of their runs once and goes on from there for each of them: it forks within a callback
 * of ngspice, whose whole state is copied so. The rows are those of runs on their own, to the byte.
 *
 * The processes, each of which waits for the next one:
 *
 *   the worker   runs the trunk: a scene in which the events that some axis varies never begin. At
 *                the first knot where a case of its tasks parts from that it stops, and stays there
 *                for all tasks to come that part from it no earlier.
 *   a scout      a copy of the worker, one for each lot of tasks: it takes the trunk on, from knot
 *                to knot at which a case parts.
 *   a branch     a copy of the scout: it takes the events of one case for the trunk's, and goes on
 *                to that case's end. Its row goes back through pipes.
 *
 * What cannot be shared is run by the worker, as without all this: a case whose netlist or whose
 * other keys are not the trunk's (which may have a trunk of its own next), one that differs from
 * the first instant on, and one whose scout or branch did not come to its end. */
#ifndef VS_STUDY_PAST_H
#define VS_STUDY_PAST_H

#include "work/desk.h"

/* True for a plan whose cases may share their past: some axis is a key of an event. */
bool vs_past_fits(const vs_plan *plan);

typedef struct vs_past vs_past;
/* Plan, case and desk are borrowed. Nobody frees it, as its process ends with it. */
vs_past *vs_past_new(const vs_plan *plan, vs_case *c, vs_desk *desk);

/* Runs the desk's tasks, and those that come in meanwhile, and answers them. */
void vs_past_run(vs_past *past);

#endif
