/* SPDX-License-Identifier: GPL-3.0-or-later
 * Nodes whose voltage nothing determines, elements with an unconnected end, and loops of voltage
 * sources.
 *
 * A run begins without an operating point: each capacitance and inductance begins as its ic= says,
 * or at 0. So a capacitance determines the voltage of its node as well as a resistance does. What
 * matters is only whether anything but current sources leads from a node to ground. */
#ifndef VS_IMPORT_FLOATING_H
#define VS_IMPORT_FLOATING_H

#include "diagnosis/note.h"
#include "diagnosis/wiring.h"

/* Adds a note for each group of nodes without a path to ground, each unconnected end, and each loop
 * of sources. */
void vs_floating_find(const vs_wiring *wiring, vs_notes *notes);

#endif
