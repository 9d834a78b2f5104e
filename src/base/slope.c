/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/slope.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

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
static bool expand(const char *rule, const operands *o, int at, vs_formula *out) {
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
static void add_part(char *rule, size_t size, const char *slope, const char *of) {
  size_t n = strlen(rule);
  if (!strcmp(slope, "1"))
    snprintf(rule + n, size - n, "%s%s", n ? "+" : "", of);
  else
    snprintf(rule + n, size - n, "%s(%s)*%s", n ? "+" : "", slope, of);
}

/* f(x, y)' = f_x x' + f_y y'. The result takes the place of x. */
static bool apply(const vs_function *f, const vs_op *op, part *x, const part *y) {
  char value[40], rule[160] = "";
  operands o = {x, y};
  part result = {{0}, {0}};
  if (x->slope.count && strcmp(f->slope[0], "0")) add_part(rule, sizeof rule, f->slope[0], "dx");
  if (y && y->slope.count) add_part(rule, sizeof rule, f->slope[1], "dy");
  bool word = f->name[0] >= 'a';
  if (!strcmp(f->name, "neg"))
    snprintf(value, sizeof value, "-x");
  else
    snprintf(value, sizeof value, word ? y ? "%s(x,y)" : "%s(x)" : "x%sy", f->name);
  bool good = expand(value, &o, op->at, &result.value) &&
              (!*rule || expand(rule, &o, op->at, &result.slope));
  vs_formula_free(&x->value);
  vs_formula_free(&x->slope);
  *x = result;
  return good;
}

bool vs_slope_of(const vs_formula *f, int term, vs_formula *slope) {
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
    const vs_function *function = &vs_function_table[op->kind - VS_OP_FUNCTION];
    bool two = function->of_two;
    if (two) top--;
    good = apply(function, op, &stack[top], two ? &stack[top + 1] : NULL);
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
