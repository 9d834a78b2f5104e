/* SPDX-License-Identifier: GPL-3.0-or-later
 * The operators and functions that a formula may have: how each is computed, how its value changes
 * with those it is of, and what it makes of their units. */
#ifndef VS_BASE_FUNCTION_H
#define VS_BASE_FUNCTION_H

#include <stdbool.h>

/* One of `of` and `of_two` is NULL. x is the first value and y the second. */
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
extern const vs_function vs_function_table[VS_FUNCTIONS];

/* The index of the function of that name; -1: there is none. Operators are not found. */
int vs_function_find(const char *name);

/* Whole exponents up to this, of either sign, are multiplied. */
enum { VS_FUNCTION_WHOLE = 100 };

/* x^y. Most exponents are whole numbers, as of squares and of varistors' laws; for these pow is
 * five times slower than multiplying. */
double vs_function_power(double x, double y);
/* sign(x) |x|^y */
double vs_function_sign_power(double x, double y);

#endif
