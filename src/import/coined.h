/* SPDX-License-Identifier: GPL-3.0-or-later
 * Names that a deck has and its netlist has not: of parameters, of nodes and elements between the
 * netlist's. Each is another one than all names that the netlist has. */
#ifndef VS_IMPORT_COINED_H
#define VS_IMPORT_COINED_H

#include "import/elements.h"

/* Begins with vs_coined_begin, ends with vs_coined_end. */
typedef struct vs_coined {
  const vs_elements *wiring; /* borrowed, as values are */
  const vs_values *values;
  vs_names said; /* names of functions, and of nodes that lines .global name */
} vs_coined;

void vs_coined_begin(vs_coined *coined, const vs_elements *wiring, const vs_values *values);
void vs_coined_end(vs_coined *coined);

/* The name of a function that a line .func of the netlist defines; empty: the card is none. */
void vs_coined_function(const vs_card *card, char name[VS_VALUES_NAME]);

/* Makes a name FIRST KEY LAST, or that with "_2", "_3", ... behind it. */
void vs_coined_name(const vs_coined *coined, const char *first, const char *key, const char *last,
                    char name[VS_ELEMENTS_NAME]);

/* Makes the name that all begin or end with that stand in the place of a source: its key, or that
 * with "_2", ... behind it, so that STEM_on, Egate_STEM and the like are free. */
void vs_coined_stem(const vs_coined *coined, const vs_element *source, char stem[VS_ELEMENTS_NAME]);

#endif
