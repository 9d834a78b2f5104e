/* SPDX-License-Identifier: GPL-3.0-or-later
 * The files that come with the program, as entries of a listing: scenes, decks, parts, machines. */
#ifndef VS_CLI_STOCK_H
#define VS_CLI_STOCK_H

#include "base/path.h"
#include "entry.h"

/* Adds to the entry what the file at `path` says of itself; nothing, or why, where it cannot be
 * read. */
typedef void vs_stock_more(vs_entries *to, const char *path);

/* Adds an entry for each file of the shelf: its name, its path, and what `more` tells of it. more
 * may be NULL. */
void vs_stock_list(vs_entries *to, const vs_shelf *shelf, vs_stock_more *more);

vs_stock_more vs_stock_deck;    /* its title */
vs_stock_more vs_stock_machine; /* likewise */
vs_stock_more vs_stock_set;     /* likewise, of instruments */
vs_stock_more vs_stock_part;    /* what it is, what its maker allows, and its parameters */

#endif
