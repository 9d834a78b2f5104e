/* SPDX-License-Identifier: GPL-3.0-or-later
 * Which line of the user's files has to be mended where the solver complains of a netlist. */
#pragma once

#include "netlist/deck.h"

/* The words of a complaint behind which, up to its end, the line of the netlist stands that the
 * solver was found to do better without. */
#define VS_LOCATION_WITHOUT "; without this line it does better: "

/* Puts the place in the deck before what the solver said of its circuit, if it can be found: that
 * of line `culprit` of the netlist, as vs_netlist_make has made it (0: not known); the place of a
 * signal that is not there, of an undefined parameter (ngspice says "[name]"), or of an element.
 * Else the place is the deck's file. Of a file that comes with the program and that another one
 * includes, or takes as a part, the place is the line that does so, as that one has to be mended.
 * Adds what would be right. */
void vs_location_locate(const vs_deck *deck, size_t culprit, vs_error *err);
