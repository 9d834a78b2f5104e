/* SPDX-License-Identifier: GPL-3.0-or-later
 * The command `list`: what there is, printed from the tables the program itself works from. */
#ifndef VS_COMMAND_LIST_H
#define VS_COMMAND_LIST_H

#include "base/error.h"

/* kind: scenes, studies, decks, parts, tiers, probes, measures, parameters; NULL: all. deck: whose
 * probes and parameters. */
vs_status vs_list_command(const char *kind, const char *deck, vs_error *err);

#endif
