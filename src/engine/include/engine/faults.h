/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of events in the plant: an element of the deck opens or is shorted, the coil's turns are
 * shorted, the armature is stuck, the load changes. */
#ifndef VS_ENGINE_FAULTS_H
#define VS_ENGINE_FAULTS_H

#include "engine/occurrence.h"

/* The kinds; the last row has no name. A new kind is one row of this table, with its keys and
 * functions above it in faults.c. */
extern const vs_event_kind vs_faults[];

#endif
