/* SPDX-License-Identifier: GPL-3.0-or-later
 * What makes a circuit slow, or puts it on edge: the plugs of `check`. */
#ifndef VS_IMPORT_HINT_H
#define VS_IMPORT_HINT_H

#include "run/findings.h"

/* Looks through a deck whose parts have been read, and runs nothing. */
void vs_hint_look(const vs_check_options *options, const vs_deck *deck, vs_check_bench *bench);

/* Tries the beginning of a run with the scene's own rule and with the other one, and tells what was
 * measured. is_deck: options->name is a deck, which is tried in the scene that names it and fires
 * in each cycle. Errors: the scene cannot be read; no process is to be had. */
vs_status vs_hint_try(const vs_check_options *options, bool is_deck, vs_check_bench *bench,
                      vs_error *err);

#endif
