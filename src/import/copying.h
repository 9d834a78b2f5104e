/* SPDX-License-Identifier: GPL-3.0-or-later
 * The netlist of a deck that is made from another netlist: its lines as they are, but for those
 * that the plan changes. */
#ifndef VS_IMPORT_COPYING_H
#define VS_IMPORT_COPYING_H

#include "fate.h"

/* Where a line of the deck comes from. */
typedef struct vs_copying_origin {
  int line;       /* of the deck, from 1 */
  vs_where where; /* of the netlist */
} vs_copying_origin;

typedef struct vs_copying {
  vs_text text;
  vs_copying_origin *origins; /* owned; in the order of their lines */
  size_t count;
  bool pspice;    /* its text wants PSpice's dialect */
  double until_s; /* end of the netlist's own .tran; NaN: there is none */
  bool gear;      /* its options want Gear's rule */
  size_t skipped; /* lines of analysis and commands that were left out */
} vs_copying;

/* Adds to `body`, which begins as {0}. `folder` is that of the deck, from the root on: files that
 * are included are named as from there. Notes in plan->sheet what was left out. */
void vs_copying_write(vs_fate *plan, const char *folder, const char *library, vs_copying *body);
/* True for a pulse whose edges the deck has to make: node KEY_edge is then the pulse of 1 V. */
bool vs_copying_has_edges(const vs_course_pulse *pulse);

void vs_copying_free(vs_copying *body);

#endif
