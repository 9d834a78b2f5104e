/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which values the rest of a run cannot change, by how far the machine can still go in it. */
#ifndef VS_MEASURE_SETTLED_H
#define VS_MEASURE_SETTLED_H

#include "engine/sim.h"
#include "measure/measures.h"

/* Finds what is settled once the machine swings freely to the end of the run, as `rest` says. */
void vs_settled_find(const vs_measures *measures, const vs_rest *rest, vs_measure_set *settled);
/* True if all values that are wanted are settled. */
bool vs_settled_all(const vs_measure_set *settled, const vs_measure_set *wanted);

#endif
