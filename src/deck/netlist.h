/* SPDX-License-Identifier: GPL-3.0-or-later
 * The netlist between files and solver: reads the files of a deck and of its parts into a vs_deck,
 * makes of it the lines that the solver is given, and finds in the files what the solver complains
 * of.
 *
 * Reading takes three calls: vs_netlist_read for the deck's own files; vs_netlist_read_parts once
 * the scene has named its parts; vs_deck_bind once the parameters have values. vs_deck_free is due
 * also after an error. */
#ifndef VS_DECK_NETLIST_H
#define VS_DECK_NETLIST_H

#include "deck/deck.h"

/* Reads a deck and what it includes. Errors with file:line, each of which a check carries on from:
 * a line of the contract that cannot be read, a name declared twice, an unknown port, no or a
 * second EVA, a statement that is the program's own. */
vs_status vs_netlist_read(const char *path, vs_deck *deck, vs_error *err);

/* Reads the files of the parts: of those that the scene's section circuit names (NULL: there is no
 * such section), else of the deck's defaults. They may add to the contract. Then gives ratings and
 * devices what their parts say, and sees to it that ports and external sources match. */
vs_status vs_netlist_read_parts(vs_deck *deck, const vs_node *section, vs_error *err);

/* Reads the file of one part alone, for what it says of itself. */
vs_status vs_netlist_read_part(const char *path, vs_deck *part, vs_error *err);

/* Reads a library of subcircuits and models, which need not be a deck. */
vs_status vs_netlist_read_library(const char *path, vs_deck *library, vs_error *err);

/* Makes the netlist that the solver loads: title, .param lines, the deck's own lines, the EVA's
 * subcircuit. The caller owns the lines; vs_netlist_free frees them. Error: the EVA's file is not
 * there. */
vs_status vs_netlist_make(const vs_deck *deck, const vs_circuit_values *values,
                          const vs_deck_value *standard, size_t n_standard, char ***lines,
                          size_t *count, vs_error *err);
void vs_netlist_free(char **lines, size_t count);

/* Words in a complaint. Behind them, up to its end, stands a line of the netlist: without that line
 * the solver went on further. */
#define VS_NETLIST_WITHOUT "; without this line it does better: "

/* Puts the place in the deck before what the solver said of its circuit, if it can be found: that
 * of line `culprit` of the netlist, as vs_netlist_make has made it (0: not known); the place of a
 * signal that is not there, of an undefined parameter (ngspice says "[name]"), or of an element.
 * Else the place is the deck's file. Of a file that comes with the program and that another one
 * includes, the place is the line that includes it, as that one has to be mended. */
void vs_netlist_locate(const vs_deck *deck, size_t culprit, vs_error *err);

#endif
