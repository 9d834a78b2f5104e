/* SPDX-License-Identifier: GPL-3.0-or-later
 * What makes a circuit slow or hard to solve; for the command `check`. */
#pragma once

#include "run/findings.h"

/* Examines a deck whose parts have been read, without running anything. */
void vs_hint_look(const vs_check_options *options, const vs_deck *deck, vs_check_bench *bench);

/* Runs the beginning of a scene with its own solver rule and with the other one, and adds notes on
 * what was measured. is_deck: options->name is a deck; it is tried in the shipped scene, fired in
 * each cycle. Errors: the scene cannot be read; no process can be started. */
vs_status vs_hint_try(const vs_check_options *options, bool is_deck, vs_check_bench *bench,
                      vs_error *err);
