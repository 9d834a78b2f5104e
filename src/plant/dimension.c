/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plant/dimension.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/text.h"

vs_dimension vs_dimension_of(const char *unit) {
  vs_dimension d = {.unknown = true};
  int power[VS_UNIT_POWERS];
  if (!unit || !vs_units_powers(unit, power)) return d;
  d.unknown = false;
  for (int k = 0; k < VS_UNIT_POWERS; k++) d.power[k] = k == VS_UNIT_ANGLE ? 0 : power[k];
  return d;
}

vs_dimension vs_dimension_product(const vs_dimension *x, double n, const vs_dimension *y,
                                  double m) {
  vs_dimension d = {.unknown = (x->unknown && n != 0) || (y->unknown && m != 0),
                    .any = (x->any && n > 0) || (y->any && m > 0)};
  for (int k = 0; k < VS_UNIT_POWERS; k++) d.power[k] = n * x->power[k] + m * y->power[k];
  return d;
}

/* Powers are sums of a few roots and products, so that they differ by rounding alone. */
static bool have_same_powers(const vs_dimension *x, const vs_dimension *y) {
  for (int k = 0; k < VS_UNIT_POWERS; k++)
    if (fabs(x->power[k] - y->power[k]) > 1e-9) return false;
  return true;
}

bool vs_dimension_fits(const vs_dimension *x, const vs_dimension *y) {
  return x->unknown || x->any || y->unknown || y->any || have_same_powers(x, y);
}

static bool is_pure(const vs_dimension *x) {
  static const vs_dimension PURE = {0};
  return vs_dimension_fits(x, &PURE);
}

void vs_dimension_text(const vs_dimension *d, char text[VS_DIMENSION_TEXT]) {
  static const char *const USUAL[] = {
      "m",    "kg",   "s",     "A",   "V",    "N",   "N/m",   "N.s/m",  "N.m",  "N.m.s", "W",
      "ohm",  "H",    "Wb",    "F",   "K",    "m/s", "m/s2",  "1/s",    "1/s2", "1/m",   "m2",
      "m3",   "kg.m", "kg.m2", "N/A", "H.m",  "V/s", "A/s",   "N/s",    "1/H",  "kg/m3", "N/m2",
      "kg/s", "s2",   "N/m3",  "1/A", "1/Wb", "A.m", "ohm.m", "N.s2/m2"};
  static const char *const BASE[VS_UNIT_POWERS] = {"kg", "m",     "s",    "A",     "rad",
                                                   "K",  "cycle", "degC", "sqrt_s"};
  size_t n = 0;
  snprintf(text, VS_DIMENSION_TEXT, "%s", d->unknown ? "an unknown unit" : "a pure number");
  if (d->unknown || d->any || is_pure(d)) return;
  for (size_t k = 0; k < sizeof USUAL / sizeof *USUAL; k++) {
    vs_dimension usual = vs_dimension_of(USUAL[k]);
    if (!have_same_powers(d, &usual)) continue;
    snprintf(text, VS_DIMENSION_TEXT, "%s", USUAL[k]);
    return;
  }
  for (int k = 0; k < VS_UNIT_POWERS && n < VS_DIMENSION_TEXT; k++) {
    if (fabs(d->power[k]) < 1e-9) continue;
    char power[24] = "";
    if (d->power[k] != 1) snprintf(power, sizeof power, "^%.4g", d->power[k]);
    n += (size_t)snprintf(text + n, VS_DIMENSION_TEXT - n, "%s%s%s", n ? "." : "", BASE[k], power);
  }
}

/* A value on the stack: its dimension, and its number where it is written with digits. */
typedef struct value {
  vs_dimension is;
  bool literal;
  double number;
} value;

static value number_of(const vs_op *op) {
  value v = {.literal = true, .number = op->value};
  v.is.any = op->value == 0;
  v.is.unknown = !op->index && op->value * 2 != rint(op->value * 2);
  return v;
}

static bool units_differ(vs_dimension_fault *fault, const vs_op *op, const char *format,
                         const vs_dimension *x, const vs_dimension *y) {
  char text[2][VS_DIMENSION_TEXT] = {"", ""};
  const char *name = vs_formula_functions[op->kind - VS_OP_FUNCTION].name;
  fault->at = op->at;
  vs_dimension_text(x, text[0]);
  if (y) vs_dimension_text(y, text[1]);
  vs_text why = {0};
  for (const char *s = format; *s; s++) /* %f is the function, %x and %y are the units */
    if (*s != '%')
      vs_text_add(&why, "%c", *s);
    else
      vs_text_add(&why, "%s", *++s == 'f' ? name : text[*s == 'y']);
  snprintf(fault->why, sizeof fault->why, "%s", why.text);
  vs_text_free(&why);
  return false;
}

/* Both values of a sum must be alike; the result is as the one that is known. */
static bool check_alike(const vs_op *op, value *x, const value *y, vs_dimension_fault *fault) {
  static const char *const SAYS[VS_OPERATORS] = {
      [VS_ADD] = "%y is added to %x", [VS_SUBTRACT] = "%y is subtracted from %x"};
  int function = op->kind - VS_OP_FUNCTION;
  if (!vs_dimension_fits(&x->is, &y->is))
    return units_differ(fault, op, function < VS_OPERATORS ? SAYS[function] : "%f is of %x and %y",
                        &x->is, &y->is);
  bool unknown = x->is.unknown || y->is.unknown;
  if (x->is.any) x->is = y->is;
  if (unknown) x->is = (vs_dimension){.unknown = true};
  return true;
}

/* x^y. With an exponent that is no number the result is known for a pure x alone. */
static bool raise_unit(const vs_op *op, value *x, const value *y, vs_dimension_fault *fault) {
  if (!is_pure(&y->is)) return units_differ(fault, op, "the exponent is in %x", &y->is, NULL);
  static const vs_dimension PURE = {0};
  if (y->literal)
    x->is = vs_dimension_product(&x->is, y->number, &PURE, 0);
  else
    x->is.unknown = x->is.unknown || x->is.any || !is_pure(&x->is);
  return true;
}

static bool apply_to_units(const vs_op *op, value *x, const value *y, vs_dimension_fault *fault) {
  static const vs_dimension PURE = {0};
  int function = op->kind - VS_OP_FUNCTION;
  const vs_function *f = &vs_formula_functions[function];
  bool literal = x->literal && (!y || y->literal), good = true;
  double number = !literal ? 0 : y ? f->of_two(x->number, y->number) : f->of(x->number);
  if (f->alike) {
    good = check_alike(op, x, y, fault);
  } else if (f->raises) {
    good = raise_unit(op, x, y, fault);
  } else if (f->pure) {
    if (!is_pure(&x->is))
      return units_differ(fault, op, "%f wants a pure number, not %x", &x->is, NULL);
    x->is = PURE;
  } else
    x->is = vs_dimension_product(&x->is, f->power[0], y ? &y->is : &PURE, f->power[1]);
  x->literal = literal;
  x->number = number;
  if (literal && number == 0) x->is.any = true;
  return good;
}

bool vs_dimension_find(const vs_formula *f, const vs_dimension *terms, const vs_dimension *names,
                       vs_dimension *found, vs_dimension_fault *fault) {
  value stack[VS_FORMULA_DEPTH + 1] = {{.is = {.any = true}}};
  int top = -1;
  for (size_t k = 0; k < f->count; k++) {
    const vs_op *op = &f->ops[k];
    if (op->kind < VS_OP_FUNCTION) {
      stack[++top] = op->kind == VS_OP_TERM   ? (value){.is = terms[op->index]}
                     : op->kind == VS_OP_NAME ? (value){.is = names[op->index]}
                                              : number_of(op);
      continue;
    }
    bool two = vs_formula_functions[op->kind - VS_OP_FUNCTION].of_two;
    if (two) top--;
    if (!apply_to_units(op, &stack[top], two ? &stack[top + 1] : NULL, fault)) return false;
  }
  *found = stack[0].is;
  return true;
}
