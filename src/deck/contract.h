/* SPDX-License-Identifier: GPL-3.0-or-later
 * The "*$" lines of a deck, one at a time. */
#ifndef VS_DECK_CONTRACT_H
#define VS_DECK_CONTRACT_H

#include "deck/cursor.h"
#include "deck/deck.h"

/* Reads one line of the contract into the deck; begin: where its "*$" stands. Errors with their
 * place. */
vs_status vs_contract_line(vs_deck *deck, const char *line, vs_where begin, vs_error *err);

/* Reads a formula, and the names in it into the deck. follow: what may stand behind it, besides the
 * end of the line. */
vs_status vs_contract_formula(vs_deck *deck, vs_cursor *c, const char *follow, vs_formula *formula,
                              vs_error *err);

/* The deck owns its fields; its section shows them as constant. */
static inline vs_field *vs_contract_fields(vs_deck *deck) {
  return (vs_field *)(size_t)deck->section.fields;
}

void vs_cursor_lower(char *text); /* in place; ngspice knows no capitals */

#endif
