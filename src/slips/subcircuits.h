/* SPDX-License-Identifier: GPL-3.0-or-later
 * Parameters of instances, X lines, which their subcircuits do not have: ngspice leaves them out
 * without a word. */
#ifndef VS_SLIPS_SUBCIRCUITS_H
#define VS_SLIPS_SUBCIRCUITS_H

#include "dialect/line.h"

/* The subcircuits of a netlist, by their names. */
typedef struct vs_subcircuits {
  const vs_line *lines; /* borrowed */
  size_t n_lines;
  size_t *first; /* of each subcircuit its line .subckt, sorted by names; owned */
  size_t count;
} vs_subcircuits;

void vs_subcircuits_find(vs_subcircuits *s, const vs_line *lines, size_t n_lines);
void vs_subcircuits_free(vs_subcircuits *s);

/* Holds what an instance says behind its subcircuit's name, at `behind` in its text, to that
 * subcircuit. A parameter stands on the line .subckt or in a .param below it; m is one of each.
 * Error: another one, with its place and the nearest name. Of a subcircuit that is not there
 * nothing is said. */
vs_status vs_subcircuits_check(const vs_subcircuits *s, const vs_line *line, const char *behind,
                               const char *subcircuit, vs_error *err);

#endif
