/* SPDX-License-Identifier: GPL-3.0-or-later
 * What a loss or store line says: a formula over voltages, currents and parameters of the circuit.
 *
 *   numbers       2, 1e-3, 4.7u (ngspice's t g meg k m u n p f)
 *   terms         v(n), v(n,m), i(Vx)
 *   parameters    NAME or {NAME}; braces are brackets
 *   operators     + - * / ^ (binds tightest, from the right) and brackets
 *   functions     abs sqrt exp ln log10; pow(x,y); pwr(x,y) = sign(x) |x|^y; min max
 *
 * It is evaluated by the program, outside ngspice, so that a loss costs no Newton iteration. */
#ifndef VS_DECK_FORMULA_H
#define VS_DECK_FORMULA_H

#include <stdbool.h>
#include <stddef.h>

enum { VS_FORMULA_DEPTH = 32 }; /* values waiting at a time */

typedef struct vs_op {
  int kind;     /* of formula.c */
  int index;    /* of a term or a name */
  double value; /* of a number; of a name, once it is known */
} vs_op;

/* Postfix. Zero is the empty formula; vs_formula_free it. */
typedef struct vs_formula {
  vs_op *ops;
  size_t count;
} vs_formula;

/* A term: its quantity is 'v' or 'i', its nodes are in lower case. */
typedef struct vs_formula_term {
  char quantity;
  const char *first, *second;
} vs_formula_term;

/* Whoever reads a formula gives terms and parameters their numbers; -1: no room for more. at: where
 * it stands in the text. */
typedef struct vs_formula_scope {
  void *ctx;
  int (*term)(void *ctx, const char *at, const vs_formula_term *term);
  int (*name)(void *ctx, const char *at, const char *name);
} vs_formula_scope;

/* Reads up to the first thing that cannot belong to the formula, and says where that is. NULL: not
 * a formula; then why says what is wrong and *bad is where. */
const char *vs_formula_read(const char *text, const vs_formula_scope *scope, vs_formula *formula,
                            const char **bad, char *why, size_t size);
void vs_formula_free(vs_formula *formula);

bool vs_formula_has_terms(const vs_formula *formula);
bool vs_formula_uses(const vs_formula *formula, int term);
int vs_formula_name_of(const vs_op *op); /* the index of the name it is; -1: it is none */

/* Gives the formula's names their values, values[index]. */
void vs_formula_bind(vs_formula *formula, const double *values);

/* Is it nothing but one term times a constant, its names bound? Then which and which. */
bool vs_formula_is_term(const vs_formula *formula, int *term, double *factor);

/* The value with each of two sets of terms, in less time than one after the other. */
void vs_formula_pair(const vs_formula *formula, const double *first, const double *second,
                     double value[2]);
double vs_formula_value(const vs_formula *formula, const double *terms);

/* Reads the "(n)" or "(n,m)" behind a 'v' or 'i' at *at, blanks allowed; lower case, 0 for no m.
 * false: it is none. Each buffer holds size bytes. */
bool vs_formula_term_read(const char **at, char quantity, char *first, char *second, size_t size);

#endif
