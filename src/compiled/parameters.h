/* SPDX-License-Identifier: GPL-3.0-or-later
 * What the parameters of a netlist come to, as ngspice reads them: a name within an instance is its
 * own argument, else a parameter of its subcircuit, else what it means where the instance stands.
 */
#pragma once

#include "netlist/cards.h"
#include "netlist/expr.h"

/* A parameter that was looked up. */
typedef struct vs_parameter_value {
  vs_word name;
  double value;
  bool known; /* false: it is being computed */
} vs_parameter_value;

/* An instance of a subcircuit, or the circuit itself, with what its parameters come to. Begin with
 * the first two members set; end with vs_parameters_free. */
typedef struct vs_parameters {
  vs_instance in;
  struct vs_parameters *caller; /* the instance that it stands in; NULL: it is the circuit */
  vs_parameter_value *known;    /* owned */
  size_t count;
  bool pspice; /* of the circuit: functions are those of ngspice's dialect "ps" */
} vs_parameters;

/* A name that stands for a value within a function's body, or for a tree of its call. */
typedef struct vs_binding {
  vs_word name;
  double value;
  const struct vs_binding *next;
} vs_binding;

/* What stands for a number in an element's line: 10k, {r1*2}, 'r1', r1. Errors name what cannot be
 * told. */
vs_status vs_parameters_of(const vs_cards *cards, vs_parameters *in, vs_word text, double *value,
                           vs_error *err);

/* The value of one tree of an expression. */
vs_status vs_parameters_of_tree(const vs_cards *cards, vs_parameters *in, const vs_expr *e,
                                size_t node, const vs_binding *bound, double *value, vs_error *err);

/* A function of one value that both parameters and B sources have, by its name; NULL: there is
 * none. Of two: vs_parameters_function_2. */
typedef double vs_parameters_of_one(double x);
typedef double vs_parameters_of_two(double x, double y);
vs_parameters_of_one *vs_parameters_function(vs_word name);
vs_parameters_of_two *vs_parameters_function_2(const vs_parameters *in, vs_word name);

/* What an operator of an expression makes of two values; false: there is no such operator. */
bool vs_parameters_operate(vs_word sign, double x, double y, double *value);

void vs_parameters_free(vs_parameters *in);
