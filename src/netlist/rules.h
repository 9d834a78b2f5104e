/* SPDX-License-Identifier: GPL-3.0-or-later
 * What may stand in a deck, line by line (continuations joined): circuits, and nothing that runs a
 * command, reads or writes a file, or takes a name of the program's. Errors have the line's place.
 */
#pragma once

#include "netlist/cards.h"
#include "netlist/deck.h"

/* Holds a line that begins with '.', taken apart alone, to the rules. Counts in deck->subcircuits
 * those that it opens and closes, and sets deck->own_clock where it knows the time. *skip is true
 * if it is none of the circuit's lines and harmless; deck->skipped has it then. */
vs_status vs_rules_statement(vs_deck *deck, const vs_cards *one, bool *skip, vs_error *err);
/* Refuses a .param, outside of subcircuits, of a name that stands in a '*$ param' line, once all
 * files are read: a part's file declares its own behind the deck's lines. Error with its place. */
vs_status vs_rules_params(const vs_deck *deck, vs_error *err);
/* True for a line of an element: a name and at least two words. Other lines are refused because
 * libngspice may read beyond its memory, or never come back, when it is given them. */
bool vs_rules_is_element(const char *line);
/* Holds any other line to the rules. Notes the EVA, and sets deck->own_clock as above. */
vs_status vs_rules_element(vs_deck *deck, const vs_cards *one, vs_error *err);

/* Refuses what ngspice draws anew in each run, in any line but one that includes a file: gauss,
 * agauss, unif, aunif and limit wherever an expression calls them, trnoise and trrandom of a
 * source. Names that merely contain such a word are fine, as is the code model limit. A deck's own
 * .func of such a name is refused too: ngspice has the name for itself in some expressions and not
 * in others. `pspice` says that the deck is read in that dialect, whose LIMIT of three arguments
 * draws nothing; with another number of them, or a blank before them, ngspice does not know it. */
vs_status vs_rules_random(const vs_line *line, bool pspice, vs_error *err);
