/* SPDX-License-Identifier: GPL-3.0-or-later
 * Statements, the lines that begin with '.', of which a circuit is not made: analyses, options and
 * outputs, as every program that writes netlists adds them. Those that leave the circuit what it is
 * are skipped, and one warning names them all. Others are refused with what to write instead. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

#include "base/error.h"
#include "base/text.h"

/* What was skipped so far. Start from {0}; vs_statements_free is due in the end. */
typedef struct vs_skipped {
  vs_where first; /* the place of the first statement */
  vs_text list;   /* "'.tran', '.save' (line 7)" */
  size_t count;
} vs_skipped;

/* Judges a statement. *skip is then true if it is to be skipped, which `skipped` remembers. Errors
 * with the place `where`: a statement that would change the circuit, or that runs a command, reads
 * or writes; the message says what to do instead. Of a word that is none of these nothing is said,
 * and *skip is false. */
vs_status vs_statements_judge(const char *line, vs_where where, vs_skipped *skipped, bool *skip,
                              vs_error *err);

/* Remembers that something else was skipped, called `what`. */
void vs_statements_skip(vs_skipped *skipped, const char *what, vs_where where);

/* Fills `text` with the one warning of all that was skipped. False: nothing was. */
bool vs_statements_warn(const vs_skipped *skipped, vs_text *text);
void vs_statements_free(vs_skipped *skipped);

/* True for the first line of a netlist if it is no statement and reads as a title rather than as an
 * element: its words are not what an element of that letter has. */
bool vs_statements_is_title(const char *line);
