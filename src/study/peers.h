/* SPDX-License-Identifier: GPL-3.0-or-later
 * Shards of a search: processes that all go through the same search, each with a folder beside the
 * others', and each running its share of every generation. What the others have run is taken from
 * their journals, so that each folder comes to hold the whole. */
#pragma once

#include "workers/journal.h"

/* Adds to a journal in `folder` the rows that it lacks of the cases from `first` up to before
 * `until`, and that journals of the same study in the folders beside it have; *missing is how many
 * it still lacks. Errors: a file cannot be read, or the journal not be written. */
vs_status vs_peers_take(const char *folder, vs_journal *journal, uint64_t first, uint64_t until,
                        uint64_t *missing, vs_error *err);
