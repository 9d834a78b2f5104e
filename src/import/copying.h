/* SPDX-License-Identifier: GPL-3.0-or-later
 * Writes the netlist of the deck: the lines of the imported netlist, with those changes that the
 * plan makes. */
#pragma once

#include "fate.h"

/* A line of the deck, and the line of the netlist that it comes from. */
typedef struct vs_copying_origin {
  int line;       /* of the deck, from 1 */
  vs_where where; /* of the netlist */
} vs_copying_origin;

typedef struct vs_copying {
  vs_text text;
  vs_copying_origin *origins; /* owned; in the order of their lines */
  size_t count;
  bool pspice;    /* the text has to be read in PSpice's dialect */
  double until_s; /* end of the netlist's own .tran; NaN: there is none */
  bool gear;      /* its options ask for Gear's rule */
  size_t skipped; /* lines of analysis and commands that were left out */
} vs_copying;

/* Adds to `body`, which begins as {0}. `folder` is the absolute path of the deck's folder: included
 * files are named relative to it. What was left out is noted in plan->sheet. */
void vs_copying_write(vs_fate *plan, const char *folder, const char *library, vs_copying *body);
/* True for a pulse whose rise and fall times the deck has to make. The pulse of 1 V is then at node
 * KEY_edge. */
bool vs_copying_has_edges(const vs_course_pulse *pulse);

void vs_copying_free(vs_copying *body);
