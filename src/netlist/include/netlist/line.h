/* SPDX-License-Identifier: GPL-3.0-or-later
 * A line of a netlist, joined with the lines of the file that continue it ('+'), and where each of
 * its characters stands in the file. */
#pragma once

#include <stddef.h>

#include "base/error.h"
#include "netlist/words.h"

/* From byte `at` of the text on, up to the next joint, the text stands in the file from `where` on.
 */
typedef struct vs_joint {
  size_t at;
  vs_where where;
} vs_joint;

/* Begin with {0} and add at least one piece; end with vs_line_free, unless another owns it. */
typedef struct vs_line {
  char *text;    /* without comments; what the solver is given */
  char *written; /* what the files say, if the text was changed for the solver; NULL: it was not */
  vs_joint *joint;
  size_t n_joints, length; /* length: bytes of the text while it is joined */
  size_t room;             /* bytes that it may have without growing */
  vs_where where;          /* of its first character; no file: it has none yet */
} vs_line;

/* Adds what a line of the file says, behind a blank unless it is the first. */
void vs_line_join(vs_line *line, const char *text, vs_where where);

/* Gives the line another text for the solver, which it owns from then on; line->written has what
 * the files say. */
void vs_line_change(vs_line *line, char *text);

/* The place of `at`, which lies in line->written, or in line->text where that is NULL. */
vs_where vs_line_place(const vs_line *line, const char *at);

/* The place in the file of a word of line->text, also where that was changed for the solver. A word
 * that the file does not have there has the line's place. */
vs_where vs_line_place_of(const vs_line *line, vs_word word);

void vs_line_free(vs_line *line);
