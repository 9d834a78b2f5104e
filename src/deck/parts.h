/* SPDX-License-Identifier: GPL-3.0-or-later
 * What parts are, what their makers allow, and what a deck and its parts ask of that: the
 * contract's lines part, limit, rating, require. */
#ifndef VS_DECK_PARTS_H
#define VS_DECK_PARTS_H

#include "deck/cursor.h"
#include "deck/deck.h"

/* Each reads the rest of one line. */
vs_status vs_parts_kind(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_parts_limit(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_parts_rating(vs_deck *deck, vs_cursor *c, vs_error *err);
vs_status vs_parts_require(vs_deck *deck, vs_cursor *c, vs_error *err);

/* Is the part's file of the kind that the deck wants? where: of its name. */
vs_status vs_parts_check_kind(const vs_deck *deck, const vs_part *part, vs_where where,
                              vs_error *err);

/* What the file says of its part; a limit of that name. NULL: nothing. */
const vs_part_file *vs_parts_file(const vs_deck *deck, const char *file);
const vs_limit *vs_parts_find_limit(const vs_deck *deck, const char *file, const char *name);

/* Gives ratings the limits of the parts chosen; one without limits is left out. */
vs_status vs_parts_resolve(vs_deck *deck, vs_error *err);

#endif
