/* SPDX-License-Identifier: GPL-3.0-or-later
 * Nodes whose voltage nothing decides, ends of elements that lead nowhere, and loops of voltage
 * sources.
 *
 * A run begins without a solution for direct current: each capacitance and inductance has what its
 * ic= says, or nothing. So a capacitance holds its node as well as a resistance does, and what
 * matters is only whether anything but current sources leads from a node to ground. */
#ifndef VS_IMPORT_FLOATING_H
#define VS_IMPORT_FLOATING_H

#include "diagnosis/note.h"
#include "diagnosis/wiring.h"

/* Adds a note for each group of nodes without a way to ground, for each end that lies open, and for
 * each loop of sources. */
void vs_floating_find(const vs_wiring *wiring, vs_notes *notes);

#endif
