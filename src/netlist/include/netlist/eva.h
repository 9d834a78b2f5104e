/* SPDX-License-Identifier: GPL-3.0-or-later
 * The EVA in the netlist: a subcircuit of two nodes whose state is the flux linkage. Its file comes
 * with the program and is written for the law i = lambda z/(2a). For a coil of another law, that
 * law's own text of the current takes the place of this one.
 *
 * A deck may name nodes of its EVA, here called Xeva, in sources, probes and formulas: v(xeva.z),
 * the gap, m; v(xeva.vz), its rate, m/s; v(xeva.lam), the flux linkage, Wb; v(xeva.q_NAME) and
 * v(xeva.v_NAME), the coordinate NAME of the machine and its rate, SI. */
#pragma once

#include "plant/coil.h"
#include "netlist/deck.h"
#include "plant/machine.h"

/* Gives the deck the texts of the coil's law, and takes those away that it had. A coil without a
 * text for the netlist (law->netlist is NULL) leaves the deck with none; such a deck must not be
 * run. vs_deck_free frees the texts. */
void vs_eva_take_law(vs_deck *deck, const vs_coil *coil);

/* Adds the sum of the secondaries' currents, A, as seen from all turns of the coil: an expression in
 * nodes of the EVA, each with its sign before it. Nothing where there are none. */
void vs_eva_add_eddy_currents(const vs_deck *deck, vs_text *out);

/* Refuses a deck that names the parameter eva_a while the coil's law has no a, with the place. */
vs_status vs_eva_check_names(const vs_deck *deck, const vs_coil *coil, vs_error *err);

/* Finds the nodes of the EVA that the deck's files name, and notes in the deck which of them show
 * the machine's motion, and whether an element reads one. Errors with their place: a name that is
 * none of the EVA's nodes; one within a subcircuit, where it would be a node of the subcircuit's
 * own, unless a .global line has it. */
vs_status vs_eva_take_motions(vs_deck *deck, const vs_machine *machine, vs_error *err);

/* Adds the lines of the EVA's subcircuit to `out`, without comments, each with a newline at its
 * end. Error: its file is not there. */
vs_status vs_eva_write(const vs_deck *deck, vs_text *out, vs_error *err);
