/* SPDX-License-Identifier: GPL-3.0-or-later
 * How many devices a netlist comes to when the solver takes its subcircuits apart. Ten lines, each
 * ten instances of the one before, are as many as ten thousand million; the solver would take all
 * of the machine's memory for them. They are counted without being made. */
#ifndef VS_NETLIST_EXPANSION_H
#define VS_NETLIST_EXPANSION_H

#include "netlist/deck.h"

/* Error, with the place of the instance that comes to most: the deck comes to more than `most`
 * elements and models, with its parts in their places. Each segment of a line U counts as two. A
 * subcircuit that the deck's files do not define counts as one, and so does one within itself. */
vs_status vs_expansion_check(const vs_deck *deck, double most, vs_error *err);

#endif
