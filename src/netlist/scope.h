/* SPDX-License-Identifier: GPL-3.0-or-later
 * In which lines of a deck that may stand which a complaint of ngspice's speaks of. */
#ifndef VS_NETLIST_SCOPE_H
#define VS_NETLIST_SCOPE_H

#include "netlist/deck.h"

/* Lines of the deck from `begin` on, up to the one before `end`. */
typedef struct vs_scope {
  const vs_deck *deck;
  size_t begin, end;
} vs_scope;

/* Finds the lines that a message is about: those of the subcircuit of the first path in it, such as
 * "b.xs.xq.bk"; else all of the deck. */
vs_scope vs_scope_find(const vs_deck *deck, const char *message);

/* Finds the lines below the .subckt of that name, or of the part that is chosen for it. Returns
 * false where there is none. */
bool vs_scope_enter(vs_scope *in, const char *name, size_t n);

/* True where the subcircuit that line k stands in, or one around that, has the parameter or the
 * model whose lack the message is of. */
bool vs_scope_has_what_lacks(const vs_deck *deck, size_t k, const char *message);

#endif
