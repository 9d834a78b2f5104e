/* SPDX-License-Identifier: GPL-3.0-or-later
 * A formula over voltages, currents and parameters of the circuit, as the contract's lines loss,
 * store, device and require have it, or over the quantities of a machine and its parameters.
 *
 *   numbers       2, 1e-3, 4.7u (ngspice's t g meg k m u n p f)
 *   terms         v(n), v(n,m), i(Vx); a machine's: names that its scope calls terms
 *   parameters    NAME or {NAME}; braces are brackets; a machine's: NAME.x too, and the number pi
 *   operators     + - * / ^ (binds tightest, from the right) and brackets
 *   functions     abs sqrt exp ln log10 sgn sin cos tan asin acos atan sinh cosh tanh; pow(x,y);
 *                 pwr(x,y) = sign(x) |x|^y; min max
 *
 * The program evaluates it outside ngspice, so that a loss costs no Newton iteration. */
#pragma once

#include <stdbool.h>
#include <stddef.h>

/* ---- operators and functions ---- */

/* How each is computed, how its value changes with those it is of, and what it makes of their
 * units. One of `of` and `of_two` is NULL. x is the first value and y the second. */
typedef struct vs_function {
  const char *name; /* an operator's sign, "neg" for a sign before a value */
  double (*of)(double x);
  double (*of_two)(double x, double y);
  /* First and second partial derivatives: of one value f_x, f_xx; of two f_x, f_y, f_xx, f_xy,
   * f_yy. At a kink they are those of one branch. Where f does not depend on y, NaN may stand for
   * a derivative to y. */
  void (*slopes)(double x, double y, double d[5]);
  const char *slope[2]; /* f_x and f_y as formulas in x and y */
  bool alike;           /* both values must have the same unit, which is the result's */
  bool pure;            /* the value must be a pure number, as the result is */
  bool raises;          /* x^y: y must be pure; the result's unit is x's to the power y */
  double power[2];      /* else the unit is x's to power[0] times y's to power[1] */
} vs_function;

/* The operators come first, in this order. */
enum { VS_ADD, VS_SUBTRACT, VS_MULTIPLY, VS_DIVIDE, VS_POWER, VS_NEGATE, VS_OPERATORS };
enum { VS_FUNCTIONS = VS_OPERATORS + 19 };
extern const vs_function vs_formula_functions[VS_FUNCTIONS];

/* Whole exponents up to this, of either sign, are multiplied. */
enum { VS_FORMULA_WHOLE = 100 };

/* x^y. Most exponents are whole numbers, as of squares and of varistors' laws; for these pow is
 * five times slower than multiplying. */
double vs_formula_power(double x, double y);
/* sign(x) |x|^y */
double vs_formula_sign_power(double x, double y);

/* ---- formulas ---- */

/* How many values may wait for their operator at a time; a longer formula is refused. */
enum { VS_FORMULA_DEPTH = 32 };

/* Kinds of an operation: those that give a value, then those that take one or two. */
enum { VS_OP_NUMBER, VS_OP_TERM, VS_OP_NAME, VS_OP_FUNCTION };

/* One operation of a formula. */
typedef struct vs_op {
  int kind;     /* VS_OP_FUNCTION + k is vs_formula_functions[k] */
  int index;    /* of a term or a name, as the scope gave it; of a number: 1 where it is pi */
  double value; /* of a number; of a name, once it is bound */
  int at;       /* where it stands in the text, in bytes from its begin */
} vs_op;

/* A formula in postfix order. {0} is the empty formula, whose value is 0. Free it with
 * vs_formula_free. */
typedef struct vs_formula {
  vs_op *ops;
  size_t count;
} vs_formula;

/* A term as it is read: its quantity is 'v' or 'i', its nodes are in lower case. */
typedef struct vs_formula_term {
  char quantity;
  const char *first, *second; /* second: "0" where the text has one node alone */
} vs_formula_term;

/* Gives the terms and parameters of a formula their numbers. `term` and `name` return an index, or
 * -1 where there is no room for more; `at` is where the word stands in the text. A circuit's scope
 * has these two alone, and gets names in lower case. */
typedef struct vs_formula_scope {
  void *ctx;
  int (*term)(void *ctx, const char *at, const vs_formula_term *term); /* NULL: no v() and i() */
  int (*name)(void *ctx, const char *at, const char *name);
  bool of_machine; /* names keep their capitals and may have dots; pi is the number */
  /* For a machine, asked before `name`; each may be NULL. The index of the term that a name stands
   * for, -1: it is no term. The formula that a name stands for, whose operations take its place
   * (its terms and names are numbered as this scope does), NULL: it is none. */
  int (*named_term)(void *ctx, const char *name);
  const vs_formula *(*named_formula)(void *ctx, const char *name);
} vs_formula_scope;

/* Reads a formula, up to the first thing that cannot belong to it, and returns where that is. NULL:
 * the text is no formula; `why` then says what is wrong, and *bad is where. */
const char *vs_formula_read(const char *text, const vs_formula_scope *scope, vs_formula *formula,
                            const char **bad, char *why, size_t size);
void vs_formula_free(vs_formula *formula);

/* True where the formula has terms, and not parameters alone. */
bool vs_formula_has_terms(const vs_formula *formula);
/* True where it has the term of that index. */
bool vs_formula_uses(const vs_formula *formula, int term);
/* The index of the name that an operation is; -1: it is something else. */
int vs_formula_name_of(const vs_op *op);

/* Gives the formula's names their values, values[index]. */
void vs_formula_bind(vs_formula *formula, const double *values);

/* Computes once what is made of numbers and bound names alone. Values stay the same to the bit; the
 * names cannot be bound anew. */
void vs_formula_fold(vs_formula *formula);

/* True where the formula, its names bound, is one term times a constant. Gives the term's index and
 * the constant then. */
bool vs_formula_is_term(const vs_formula *formula, int *term, double *factor);

/* A formula that is evaluated often. Where it is one term times a constant, that is all there is to
 * it. */
typedef struct vs_formula_prepared {
  const vs_formula *formula; /* borrowed; NULL: there is none */
  bool is_term;
  int term;
  double factor;
} vs_formula_prepared;

/* The formula's names must be bound. */
vs_formula_prepared vs_formula_prepare(const vs_formula *formula);

/* The values for two sets of terms, in less time than one after the other. */
void vs_formula_pair(const vs_formula *formula, const double *first, const double *second,
                     double value[2]);
/* The value for one set of terms; NULL will do where the formula has none. */
double vs_formula_value(const vs_formula *formula, const double *terms);

static inline double vs_formula_prepared_value(const vs_formula_prepared *q, const double *terms) {
  return q->is_term ? q->factor * terms[q->term] : vs_formula_value(q->formula, terms);
}

/* Reads the "(n)" or "(n,m)" behind a 'v' or 'i' at *at, blanks allowed, and goes on behind it. The
 * nodes are in lower case, gnd is "0", and so is `second` where there is no m. Returns false, and
 * leaves *at, where something else stands there. Each buffer holds size bytes. */
bool vs_formula_term_read(const char **at, char quantity, char *first, char *second, size_t size);
