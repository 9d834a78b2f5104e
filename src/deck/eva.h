/* SPDX-License-Identifier: GPL-3.0-or-later
 * The EVA in the netlist: a subcircuit of two nodes whose state is the flux linkage. Its file comes
 * with the program and is written for the law i = lambda z/(2a). For a coil of another law, that
 * law's own text of the current takes the place of this one. */
#ifndef VS_DECK_EVA_H
#define VS_DECK_EVA_H

#include "actuator/coil.h"
#include "deck/deck.h"

/* Gives the deck the texts of the coil's law, and takes those away that it had. A coil without a
 * text for the netlist (law->netlist is NULL) leaves the deck with none; such a deck must not be
 * run. vs_deck_free frees the texts. */
void vs_eva_take_law(vs_deck *deck, const vs_coil *coil);

/* Refuses a deck that names the parameter eva_a while the coil's law has no a, with the place. */
vs_status vs_eva_check_names(const vs_deck *deck, const vs_coil *coil, vs_error *err);

/* Adds the lines of the EVA's subcircuit to `out`, without comments, each with a newline at its
 * end. Error: its file is not there. */
vs_status vs_eva_write(const vs_deck *deck, vs_text *out, vs_error *err);

#endif
