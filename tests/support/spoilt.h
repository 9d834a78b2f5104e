/* SPDX-License-Identifier: GPL-3.0-or-later
 * What test_messages gives mistakes to: shipped files and some of its own, and the commands that
 * read them. */
#pragma once

#include <stddef.h>

/* Files of one kind, and what is done with them. `copies`: shipped files, which go into a folder
 * of the bench's own under their last names. `texts`: files more, each behind a line "%%% NAME".
 * `makes`: commands that make files. `spoilt`: files of which one gets a mistake. `commands`: one
 * of them is run then; FILE in it is the spoilt one, ARGUMENT a setting with a mistake. */
typedef struct spoilt_bench {
  const char *name, *copies, *texts, *makes[5], *spoilt[40], *commands[8];
} spoilt_bench;

/* The last row has no name. */
extern const spoilt_bench spoilt_benches[];
