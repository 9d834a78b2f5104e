/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a verdict could not judge: limits that a data sheet would have and no part states, limits
 * that are stated and nothing is held to, and what was not measured or not for long enough. A
 * verdict stands for no more than its lines; this says what is missing. */
#pragma once

#include "measure/verdict.h"

/* One entry: "r1.power", and why: "no limit stated", one of a few constant texts. */
typedef struct vs_unjudged {
  char name[2 * VS_DECK_NAME + 2];
  const char *why;
} vs_unjudged;

/* Fills the k-th entry, from 0, device by device; false: there are no more. devices may be NULL.
 * The run must have ended, and the verdict have been reached: what a rating of the scene judges is
 * no entry, nor is what the scene waives, or a limit whose lack leaves the verdict undecided. */
bool vs_unjudged_at(const vs_devices *devices, const vs_verdict *verdict, size_t k,
                    vs_unjudged *entry);

/* True where the entries have to be told: the verdict has lines, or one of the entries is of a
 * limit that a part states. What rates nothing says so by its verdict. */
bool vs_unjudged_is_told(const vs_devices *devices, const vs_verdict *verdict);

/* Adds the names of all entries to the text, those of one reason together, as "r1.power, c1.v_peak
 * (no limit stated); t.i_rms (one shot)". A device of which nothing is judged for one reason stands
 * there by its name alone. */
void vs_unjudged_write(const vs_devices *devices, const vs_verdict *verdict, vs_text *text);

/* Adds what a deck's parts state and nothing is held to, as "fuse_1.v_rated, ...". */
void vs_unjudged_write_left(const vs_deck *deck, vs_text *text);
