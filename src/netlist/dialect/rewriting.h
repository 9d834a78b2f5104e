/* SPDX-License-Identifier: GPL-3.0-or-later
 * A line of a netlist that is made into one, or several, that ngspice reads as the program meant
 * for which it was written. */
#pragma once

#include <stdbool.h>

#include "base/text.h"
#include "netlist/line.h"
#include "netlist/tally.h"

/* Borrows line, tally and err. Begin with what is borrowed and text {0}, more {0}; end with
 * vs_rewriting_free. */
typedef struct vs_rewriting {
  const vs_line *line; /* as the file has it */
  bool pspice;         /* ngspice reads PSpice's dialect */
  bool isspice;        /* the file is written in IsSpice's */
  unsigned long own;   /* functions that the netlist defines itself (netlist/dialect/functions.h) */
  vs_text text;        /* the line as it is now */
  vs_text more;        /* lines that it needs besides, each ended by a newline */
  int integrals;       /* nodes that the line has been given for integrals */
  vs_tally *tally;
  vs_error *err;
} vs_rewriting;

/* Replaces n bytes of r->text from `offset` on. */
void vs_rewriting_replace(vs_rewriting *r, size_t offset, size_t n, const char *by);

/* Writes n bytes of r->text from `offset` on as one expression in braces: braces and single quotes
 * within them become brackets. */
void vs_rewriting_brace(vs_rewriting *r, size_t offset, size_t n);

/* Tells that the line was changed, at the line's place. */
void vs_rewriting_tell(vs_rewriting *r, const char *what);

/* The place in the file of a byte of r->text: exact as long as the line is as the file has it, else
 * that of the same text in the file, or of the line. */
vs_where vs_rewriting_place(const vs_rewriting *r, const char *at, size_t n);

void vs_rewriting_free(vs_rewriting *r);
