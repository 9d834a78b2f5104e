/* SPDX-License-Identifier: GPL-3.0-or-later
 * The parameters NAME=VALUE of a line of a netlist, and the names that its lines define. */
#ifndef VS_NETLIST_PARAMETERS_H
#define VS_NETLIST_PARAMETERS_H

#include <stdbool.h>
#include <stddef.h>

#include "netlist/line.h"
#include "netlist/words.h"

/* Finds the next "NAME =" at or behind s, outside of brackets, braces and quotes. Returns what
 * stands behind '=', with *at where the name begins and *n its length. NULL: there is none. */
const char *vs_parameters_next(const char *line, const char *s, const char **at, size_t *n);

/* Error: a line X..., one of whose parameters has no value, as "r= c=7", which ngspice reads as
 * something else; or a name behind the last value, which ngspice leaves out. */
vs_status vs_parameters_check(const vs_line *line, vs_error *err);

/* The names of the parameters that lines .param and .subckt define, wherever they stand. */
typedef struct vs_parameters {
  vs_word *name; /* sorted; each is borrowed, the array owned */
  size_t count;
} vs_parameters;

/* Adds names before they are looked for. End with vs_parameters_free. */
void vs_parameters_add(vs_parameters *p, const char *name);
void vs_parameters_find(vs_parameters *p, const vs_line *lines, size_t n_lines);
void vs_parameters_free(vs_parameters *p);

/* Error, with its place: an E, F, G or H whose gain is a bare name that ngspice takes for 0, as it
 * is none of the parameters, or stands in brackets or in a line with commas. Call it when all names
 * were added and found. */
vs_status vs_parameters_check_gain(const vs_parameters *p, const vs_line *line, vs_error *err);

#endif
