/* SPDX-License-Identifier: GPL-3.0-or-later
 * What may stand in a deck, line by line (continuations joined): circuits, and nothing that runs a
 * command, reads or writes a file, or takes what is the program's. */
#ifndef VS_CIRCUIT_RULES_H
#define VS_CIRCUIT_RULES_H

#include "circuit/deck.h"

/* A line that begins with '.'. Keeps count of the subcircuits it opens and closes. */
vs_status vs_rule_statement(vs_deck *deck, const char *line, vs_where where, vs_error *err);
/* Any other line; notes the EVA. Both note a clock of the deck's own. */
vs_status vs_rule_element(vs_deck *deck, const char *line, vs_where where, vs_error *err);

/* Refuses what ngspice draws anew in each run, in any line but one that includes a file: gauss,
 * agauss, unif, aunif and limit wherever an expression calls them, trnoise and trrandom of a
 * source. Names that merely contain such a word are fine, as is the code model limit. A deck's own
 * .func of such a name is refused too: ngspice has the name for itself in some expressions and not
 * in others. pspice: the deck is read in that dialect, whose LIMIT of three is no such thing; with
 * another number of arguments or a blank before them ngspice does not know it. */
vs_status vs_rule_random(const char *line, bool pspice, vs_where where, vs_error *err);

/* "Vname n m external"; name is filled, in lower case. */
bool vs_is_external(const char *line, char name[VS_DECK_NAME]);

/* The subcircuit an instance "Xname n m ... SUBCIRCUIT [NAME=VALUE ...]" is of: where it begins in
 * the line, and its length; NULL: the line is none. */
const char *vs_instance_of(const char *line, size_t *length);

/* Is it a parameter of the program's that decks only use? */
bool vs_is_standard(const char *name);
/* Is it a name that ngspice takes for its own in an expression, whatever a parameter of that name
 * says: a function, which then cannot be read, or time, temper and hertz, which are other numbers?
 */
bool vs_is_reserved(const char *name);

#endif
