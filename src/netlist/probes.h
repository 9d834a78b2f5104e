/* SPDX-License-Identifier: GPL-3.0-or-later
 * The units of a deck's probes, held to what they measure. A unit of another kind would stand above
 * a column of numbers that it is not the unit of. */
#pragma once

#include "netlist/deck.h"

/* Looks at all probes, once all lines are there. Between the mains and the EVA a node has a
 * voltage, and a source V... a current. At other nodes a voltage may stand for anything, as for the
 * sum of two currents, and no current is in volt. Error: another unit, or one with a prefix, as mV,
 * with its place. */
vs_status vs_probes_check_units(const vs_deck *deck, vs_error *err);
