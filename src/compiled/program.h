/* SPDX-License-Identifier: GPL-3.0-or-later
 * The expression of a B source, made ready to be evaluated with its slopes. Where it chooses
 * between branches, by a ? b : c, u(), sgn() or the like, the branch is held for as long as a step
 * of the integration lasts, so that the expression is smooth within it; vs_program_chooses tells
 * whether another one is due. */
#pragma once

#include "parameters.h"

enum { VS_PROGRAM_OPS = 512, VS_PROGRAM_SIGNALS = 24 };

/* One operation. Its operands are numbers of operations before it. */
typedef struct vs_program_op {
  int kind; /* of program.c */
  int a, b, c;
  double value; /* a constant, or the branch that is held: 0 or 1; of sgn -1, 0, 1 */
  double (*of)(double);
} vs_program_op;

/* A voltage between two unknowns, or an unknown current. */
typedef struct vs_program_signal {
  int plus, minus; /* unknowns; -1: none, which is 0 */
} vs_program_signal;

typedef struct vs_compiled_program {
  vs_program_op *op; /* owned; the last one is the whole expression */
  int count, result; /* result: the one that it has the value of, by the branches that are held */
  int *live, n_live; /* the operations that the branches held ask for, without constants; owned */
  int *decides, n_decides; /* those of them that a branch is chosen by, and the choices; owned */
  double *value;           /* of each operation, as it was evaluated last; owned */
  vs_program_signal signal[VS_PROGRAM_SIGNALS];
  int signals;
  bool chooses; /* it has branches at all */
} vs_compiled_program;

/* Finds unknowns by the names that they have within an instance. -1: ground, or none; -2: there is
 * no such thing. */
typedef struct vs_program_scope {
  void *ctx;
  int (*node)(void *ctx, const vs_parameters *in, vs_word name);
  int (*current)(void *ctx, const vs_parameters *in, vs_word name);
} vs_program_scope;

/* Reads an expression. Errors: what the reader of parameters refuses; a function or signal that is
 * not known. vs_program_free is due also after an error. */
vs_status vs_program_read(const vs_cards *cards, vs_parameters *in, vs_word text,
                          const vs_program_scope *scope, vs_compiled_program *program,
                          vs_error *err);
void vs_program_free(vs_compiled_program *program);

/* The value at y. slope[k], if slope is not NULL, becomes its derivative by signal k. */
double vs_program_value(const vs_compiled_program *program, const double *y, double *slope);

/* Takes the branches that y asks for. Returns true if one of them is another one than before. With
 * `only_ask` it keeps those that it has. */
bool vs_program_choose(vs_compiled_program *program, const double *y, bool only_ask);
