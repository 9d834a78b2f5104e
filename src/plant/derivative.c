/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "derivative.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* ---- to a term ---- */

/* A part of the formula and its derivative; an empty derivative is 0. */
typedef struct part {
  vs_formula value, slope;
} part;

/* The parts that a rule is of: x and y with their derivatives dx and dy. */
typedef struct operands {
  const part *x, *y;
} operands;

static const vs_formula *operand(void *ctx, const char *name) {
  const operands *o = ctx;
  bool slope = name[0] == 'd';
  const part *of = name[slope] == 'x' ? o->x : o->y;
  return slope ? &of->slope : &of->value;
}

static vs_formula one_op(vs_op op) {
  vs_formula f = {vs_alloc(1, sizeof op), 1};
  f.ops[0] = op;
  return f;
}

/* Reads a rule whose names are the operands. */
static bool read_rule(const char *rule, const operands *o, int at, vs_formula *out) {
  char why[80];
  const char *bad;
  const vs_formula_scope scope = {
      .ctx = (void *)(uintptr_t)o, .of_machine = true, .named_formula = operand};
  *out = (vs_formula){0};
  if (!vs_formula_read(rule, &scope, out, &bad, why, sizeof why)) {
    vs_formula_free(out);
    return false;
  }
  for (size_t k = 0; k < out->count; k++) out->ops[k].at = at;
  return true;
}

/* Adds "(slope)*dx" to a rule, or dx alone where the slope is 1. */
static void add_product(char *rule, size_t size, const char *slope, const char *of) {
  size_t n = strlen(rule);
  if (!strcmp(slope, "1"))
    snprintf(rule + n, size - n, "%s%s", n ? "+" : "", of);
  else
    snprintf(rule + n, size - n, "%s(%s)*%s", n ? "+" : "", slope, of);
}

/* f(x, y)' = f_x x' + f_y y'. The result takes the place of x. */
static bool differentiate(const vs_function *f, const vs_op *op, part *x, const part *y) {
  char value[40], rule[160] = "";
  operands o = {x, y};
  part result = {{0}, {0}};
  if (x->slope.count && strcmp(f->slope[0], "0")) add_product(rule, sizeof rule, f->slope[0], "dx");
  if (y && y->slope.count) add_product(rule, sizeof rule, f->slope[1], "dy");
  bool word = f->name[0] >= 'a';
  if (!strcmp(f->name, "neg"))
    snprintf(value, sizeof value, "-x");
  else
    snprintf(value, sizeof value, word ? y ? "%s(x,y)" : "%s(x)" : "x%sy", f->name);
  bool good = read_rule(value, &o, op->at, &result.value) &&
              (!*rule || read_rule(rule, &o, op->at, &result.slope));
  vs_formula_free(&x->value);
  vs_formula_free(&x->slope);
  *x = result;
  return good;
}

bool vs_derivative_to(const vs_formula *f, int term, vs_formula *slope) {
  part stack[VS_FORMULA_DEPTH + 1] = {{{0}, {0}}};
  int top = -1;
  bool good = true;
  for (size_t k = 0; k < f->count && good; k++) {
    const vs_op *op = &f->ops[k];
    if (op->kind < VS_OP_FUNCTION) {
      stack[++top].value = one_op(*op);
      if (op->kind == VS_OP_TERM && op->index == term)
        stack[top].slope = one_op((vs_op){.kind = VS_OP_NUMBER, .value = 1, .at = op->at});
      continue;
    }
    const vs_function *function = &vs_formula_functions[op->kind - VS_OP_FUNCTION];
    bool two = function->of_two;
    if (two) top--;
    good = differentiate(function, op, &stack[top], two ? &stack[top + 1] : NULL);
    if (two) {
      vs_formula_free(&stack[top + 1].value);
      vs_formula_free(&stack[top + 1].slope);
    }
  }
  *slope = (vs_formula){0};
  if (good && top == 0) {
    *slope =
        stack[0].slope.count ? stack[0].slope : one_op((vs_op){.kind = VS_OP_NUMBER, .value = 0});
    stack[0].slope = (vs_formula){0};
  }
  for (; top >= 0; top--) {
    vs_formula_free(&stack[top].value);
    vs_formula_free(&stack[top].slope);
  }
  return good;
}

/* ---- in time ---- */

/* What stands still adds nothing, even where the slope is infinite. */
static double part_in_time(double slope, double rate) {
  return rate == 0 ? 0 : slope * rate;
}

/* f(x(t)):  f' = f_x x',  f" = f_x x" + f_xx x'^2. */
static vs_jet of_one(const vs_function *f, const vs_jet *x) {
  double d[5];
  f->slopes(x->d[0], 0, d);
  return (vs_jet){{f->of(x->d[0]), part_in_time(d[0], x->d[1]),
                   part_in_time(d[0], x->d[2]) + part_in_time(d[1], x->d[1] * x->d[1])}};
}

/* f(x(t), y(t)):  f' = f_x x' + f_y y',  f" = f_x x" + f_y y" + f_xx x'^2 + 2 f_xy x' y' + f_yy
 * y'^2.
 */
static vs_jet of_two(const vs_function *f, const vs_jet *x, const vs_jet *y) {
  double d[5], x1 = x->d[1], y1 = y->d[1];
  f->slopes(x->d[0], y->d[0], d);
  return (vs_jet){{f->of_two(x->d[0], y->d[0]), part_in_time(d[0], x1) + part_in_time(d[1], y1),
                   part_in_time(d[0], x->d[2]) + part_in_time(d[1], y->d[2]) +
                       part_in_time(d[2], x1 * x1) + part_in_time(d[3], 2 * x1 * y1) +
                       part_in_time(d[4], y1 * y1)}};
}

vs_jet vs_derivative_along(const vs_formula *f, const vs_jet *terms) {
  vs_jet stack[VS_FORMULA_DEPTH + 1], *top = stack; /* stack[0]: of the empty formula */
  *top = (vs_jet){{0}};
  for (const vs_op *op = f->ops, *end = op + f->count; op < end; op++) {
    if (op->kind < VS_OP_FUNCTION) {
      *++top = op->kind == VS_OP_TERM ? terms[op->index] : (vs_jet){{op->value}};
      continue;
    }
    const vs_function *function = &vs_formula_functions[op->kind - VS_OP_FUNCTION];
    if (function->of_two) {
      top--;
      top[0] = of_two(function, &top[0], &top[1]);
    } else
      top[0] = of_one(function, &top[0]);
  }
  return *top;
}
