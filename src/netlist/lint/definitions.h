/* SPDX-License-Identifier: GPL-3.0-or-later
 * The functions and parameters that a netlist defines, and which of them an expression names. */
#ifndef VS_NETLIST_DEFINITIONS_H
#define VS_NETLIST_DEFINITIONS_H

#include <stdbool.h>

#include "netlist/line.h"
#include "netlist/words.h"

/* A function, ".func NAME(ARGUMENTS) BODY", or a parameter, ".param NAME=BODY". */
typedef struct vs_definition {
  const vs_line *line; /* borrowed, as are the words */
  vs_word name, arguments, body;
  size_t scope; /* of the subcircuit that it stands in, from 1; 0: it stands in none */
  bool function;
} vs_definition;

/* Begin with vs_definitions_find. */
typedef struct vs_definitions {
  vs_definition *list; /* in the order of the lines; owned */
  size_t count;
  const vs_definition **sorted; /* by names; owned */
  size_t *outer;                /* of each scope the one that it lies in; owned */
  size_t scopes;
} vs_definitions;

/* Finds all functions, and the parameters outside of subcircuits: a parameter of a subcircuit may
 * be given by the instance, and may have the name of an outer one that it is made of. */
void vs_definitions_find(vs_definitions *d, const vs_line *lines, size_t count);
void vs_definitions_free(vs_definitions *d);

/* A name in an expression. */
typedef struct vs_mention {
  vs_word name;
  bool call; /* '(' follows */
} vs_mention;

/* Finds the first name in the text from `from` to before `end`. False: there is none. */
bool vs_definitions_mention(const char *from, const char *end, vs_mention *found);

/* What a name means within a scope: a function of it or of those around it, or a parameter. NULL:
 * it is not defined, or more than once where it is found. */
const vs_definition *vs_definitions_get(const vs_definitions *d, vs_mention mention, size_t scope);

/* The number of the function's argument of that name, from 0; -1: it has none. */
int vs_definitions_argument(const vs_definition *function, vs_word name);

/* How many arguments it has. */
size_t vs_definitions_arguments(const vs_definition *function);

#endif
