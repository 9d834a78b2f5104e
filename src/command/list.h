/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `list`: what there is, printed from the tables that the program itself works from. */
#ifndef VS_COMMAND_LIST_H
#define VS_COMMAND_LIST_H

#include "base/error.h"

/* Prints one kind of things, or all. kind: scenes, studies, decks, parts, tiers, laws, probes,
 * machines, instruments, events, measures or parameters; NULL: all of them. deck, machine: those
 * whose probes, measures and parameters are listed, a path or a name; NULL: those of a scene that
 * names none. Errors: VS_INPUT, there is no such kind; those of reading deck and machine. */
vs_status vs_list_command(const char *kind, const char *deck, const char *machine, vs_error *err);

#endif
