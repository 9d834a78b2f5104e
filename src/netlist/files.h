/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reads the files of a deck: their lines, joined with those that continue them, go into the deck,
 * what begins with "*$" by the contract, everything else once it is held to the rules. Of libraries
 * of the user's that are included, only what is called is read (library.h). */
#pragma once

#include <stdbool.h>

#include "netlist/deck.h"

/* Reads a file and what it includes into the deck. In a library, which others have written, a line
 * "*$ WORD" that is none of the contract's is a comment, and warned of. Errors with file:line, each
 * of which a check carries on from. */
vs_status vs_files_read(vs_deck *deck, const char *path, bool library, vs_error *err);

/* Reads the subcircuit of a part's name, as its file is called, if that file was read as a library
 * of which nobody has called it yet; and what it calls. */
vs_status vs_files_call(vs_deck *deck, const char *path, vs_error *err);

/* Warns, once, of slips in what the deck's libraries have that nothing calls, for a check. */
void vs_files_tell_unread(vs_deck *deck);

/* True for a file that the deck was read from. */
bool vs_files_has(const vs_deck *deck, const char *path);
