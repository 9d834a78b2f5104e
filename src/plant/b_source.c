/* SPDX-License-Identifier: GPL-3.0-or-later
 * What ngspice 39 makes of a B source's expression, measured with `ngspice -b`:
 *   - of a number it keeps 11 digits: 1.2566370614359173e-06 is read as 1.2566370614e-06. A sum of
 *     two numbers is folded at full precision, so a longer number is written as one.
 *   - x^y, x**y and pow(x,y) are all |x|^y: (-3)^3 is 27. pwr(x,y) is sign(x) |x|^y: -27, and
 *     pwr(-3,2) is -9; but for decks read as PSpice's (compat ps) it is |x|^y, too. So an odd power
 *     is written sgn(x)*pow(abs(x),y), an even one pow(abs(x),y), with abs for the derivative's
 * sign.
 *   - -2^2 is -4, as here, but 2^3^2 is (2^3)^2 = 64: all powers are written with brackets or as
 *     functions.
 *   - x^-1 with x = 0 ends the run, and Newton's first iterate is 0; 1/0 is 1e32. So a negative
 *     exponent is written as a division.
 *   - ln and log are both the natural logarithm; log10, abs, sqrt, exp, sgn (0 at 0), min, max and
 *     the trigonometric and hyperbolic functions are as in C. There is no atan2.
 *   - ln and sqrt of a negative number end the run. */
#include "plant/b_source.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void vs_b_source_number(vs_text *text, double value) {
  char high[40], low[40] = "";
  snprintf(high, sizeof high, "%.11g", value);
  double rest = value - strtod(high, NULL);
  if (rest != 0) snprintf(low, sizeof low, "%+.11g", rest);
  bool bracket = *low || signbit(value);
  vs_text_add(text, bracket ? "(%s%s)" : "%s%s", high, low);
}

/* A part of the formula: its text, or its number where it has no term. */
typedef struct part {
  char *text; /* owned; NULL: it is the number */
  double number;
} part;

static bool is_number(const part *p, double value) {
  return !p->text && p->number == value;
}

static void add_part(vs_text *text, const part *p) {
  if (p->text)
    vs_text_add(text, "%s", p->text);
  else
    vs_b_source_number(text, p->number);
}

static void add_call(vs_text *text, const char *name, const part *x, const part *y) {
  vs_text_add(text, "%s(", name);
  add_part(text, x);
  if (y) {
    vs_text_add(text, ",");
    add_part(text, y);
  }
  vs_text_add(text, ")");
}

/* |x|^y, or sign(x) |x|^y where `odd`. */
static void add_raised(vs_text *text, const part *x, const part *y, bool odd) {
  if (odd) {
    vs_text_add(text, "(");
    add_call(text, "sgn", x, NULL);
    vs_text_add(text, "*");
  }
  vs_text_add(text, "pow(abs(");
  add_part(text, x);
  vs_text_add(text, "),");
  add_part(text, y);
  vs_text_add(text, odd ? "))" : ")");
}

/* x^y for an x that may be negative where y is a whole number. */
static void add_power(vs_text *text, const part *x, const part *y) {
  bool odd = !y->text && y->number == rint(y->number) && fmod(y->number, 2) != 0;
  const part up = {NULL, -y->number};
  if (y->text || y->number >= 0) {
    add_raised(text, x, y, odd);
    return;
  }
  vs_text_add(text, "(1/");
  add_raised(text, x, &up, odd);
  vs_text_add(text, ")");
}

/* Gives the result where one of the values is 0 or 1 and the other stays as it is; such come from
 * derivatives. Returns NULL where there is something to compute. */
static const part *simpler(int function, const part *x, const part *y) {
  static const part ZERO = {NULL, 0};
  bool product = function == VS_MULTIPLY, sum = function == VS_ADD;
  bool power = vs_formula_functions[function].of_two == vs_formula_power;
  if (product && (is_number(x, 0) || is_number(y, 0))) return &ZERO;
  if ((product && is_number(x, 1)) || (sum && is_number(x, 0))) return y;
  if ((product || function == VS_DIVIDE || power) && is_number(y, 1)) return x;
  if ((sum || function == VS_SUBTRACT) && is_number(y, 0)) return x;
  return NULL;
}

static void add_operation(vs_text *text, int function, const part *x, const part *y) {
  const vs_function *f = &vs_formula_functions[function];
  if (f->raises && f->of_two != vs_formula_power) {
    add_raised(text, x, y, true);
  } else if (f->raises) {
    add_power(text, x, y);
  } else if (function >= VS_OPERATORS) {
    add_call(text, f->name, x, y);
  } else {
    vs_text_add(text, "(");
    if (y) add_part(text, x);
    vs_text_add(text, "%s", y ? f->name : "-");
    add_part(text, y ? y : x);
    vs_text_add(text, ")");
  }
}

/* Puts the operation's result in the place of x. */
static void apply_as_text(int function, part *x, part *y) {
  const vs_function *f = &vs_formula_functions[function];
  part result = {NULL, 0};
  if (!x->text && !(y && y->text)) {
    result.number = y ? f->of_two(x->number, y->number) : f->of(x->number);
  } else {
    const part *same = y ? simpler(function, x, y) : NULL;
    vs_text text = {0};
    if (!same) add_operation(&text, function, x, y);
    if (same && same->text) vs_text_add(&text, "%s", same->text);
    result = (part){text.text, same ? same->number : 0};
  }
  free(x->text);
  if (y) free(y->text);
  *x = result;
}

void vs_b_source_formula(vs_text *text, const vs_formula *f, const char *const *terms) {
  part stack[VS_FORMULA_DEPTH + 1] = {{NULL, 0}};
  int top = -1;
  for (size_t k = 0; k < f->count; k++) {
    const vs_op *op = &f->ops[k];
    if (op->kind < VS_OP_FUNCTION) {
      bool term = op->kind == VS_OP_TERM;
      stack[++top] = (part){term ? vs_copy(terms[op->index]) : NULL, term ? 0 : op->value};
      continue;
    }
    int function = op->kind - VS_OP_FUNCTION;
    bool two = vs_formula_functions[function].of_two;
    if (two) top--;
    apply_as_text(function, &stack[top], two ? &stack[top + 1] : NULL);
  }
  add_part(text, &stack[0]);
  free(stack[0].text);
}
