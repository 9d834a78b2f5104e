/* SPDX-License-Identifier: GPL-3.0-or-later
 * What was found or changed in a netlist, kind by kind, so that a library of a hundred like lines
 * makes one warning. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"

enum { VS_TALLY_KINDS = 48 }; /* more than there are kinds */

/* Start from {0}. */
typedef struct vs_tally {
  struct vs_tallied {
    const char *what; /* borrowed, and constant as long as the tally */
    vs_where first;
    size_t count;
  } item[VS_TALLY_KINDS];
  size_t count;
} vs_tally;

/* Counts one more of what the text says. */
void vs_tally_add(vs_tally *tally, const char *what, vs_where where);

/* Writes the warning of item k: what it says, and of how many lines. */
void vs_tally_tell(const vs_tally *tally, size_t k, char *text, size_t size);
