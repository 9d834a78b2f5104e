/* SPDX-License-Identifier: GPL-3.0-or-later
 * Parameters of instances (lines X...) that their subcircuits do not have. ngspice ignores them
 * silently. */
#ifndef VS_NETLIST_SUBCIRCUITS_H
#define VS_NETLIST_SUBCIRCUITS_H

#include "netlist/line.h"

/* The subcircuits of a netlist, by their names. */
typedef struct vs_subcircuits {
  const vs_line *lines; /* borrowed */
  size_t n_lines;
  size_t *first; /* of each subcircuit its line .subckt, sorted by names; owned */
  size_t count;
} vs_subcircuits;

void vs_subcircuits_find(vs_subcircuits *s, const vs_line *lines, size_t n_lines);
void vs_subcircuits_free(vs_subcircuits *s);

/* Checks the parameters of an instance against its subcircuit. `behind` is where they begin, behind
 * the subcircuit's name in the line. A subcircuit has the parameters of its line .subckt and of
 * each .param below it, and m. Error: another one, with its place and the nearest name. No error if
 * the subcircuit is not there. */
vs_status vs_subcircuits_check(const vs_subcircuits *s, const vs_line *line, const char *behind,
                               const char *subcircuit, vs_error *err);

#endif
