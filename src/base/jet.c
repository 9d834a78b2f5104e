/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/jet.h"

/* What stands still adds nothing, even where the slope is infinite. */
static double part(double slope, double rate) {
  return rate == 0 ? 0 : slope * rate;
}

/* f(x(t)):  f' = f_x x',  f" = f_x x" + f_xx x'^2. */
static vs_jet of_one(const vs_function *f, const vs_jet *x) {
  double d[5];
  f->slopes(x->d[0], 0, d);
  return (vs_jet){
      {f->of(x->d[0]), part(d[0], x->d[1]), part(d[0], x->d[2]) + part(d[1], x->d[1] * x->d[1])}};
}

/* f(x(t), y(t)):  f' = f_x x' + f_y y',  f" = f_x x" + f_y y" + f_xx x'^2 + 2 f_xy x' y' + f_yy
 * y'^2.
 */
static vs_jet of_two(const vs_function *f, const vs_jet *x, const vs_jet *y) {
  double d[5], x1 = x->d[1], y1 = y->d[1];
  f->slopes(x->d[0], y->d[0], d);
  return (vs_jet){{f->of_two(x->d[0], y->d[0]), part(d[0], x1) + part(d[1], y1),
                   part(d[0], x->d[2]) + part(d[1], y->d[2]) + part(d[2], x1 * x1) +
                       part(d[3], 2 * x1 * y1) + part(d[4], y1 * y1)}};
}

vs_jet vs_jet_of(const vs_formula *f, const vs_jet *terms) {
  vs_jet stack[VS_FORMULA_DEPTH + 1], *top = stack; /* stack[0]: of the empty formula */
  *top = (vs_jet){{0}};
  for (const vs_op *op = f->ops, *end = op + f->count; op < end; op++) {
    if (op->kind < VS_OP_FUNCTION) {
      *++top = op->kind == VS_OP_TERM ? terms[op->index] : (vs_jet){{op->value}};
      continue;
    }
    const vs_function *function = &vs_function_table[op->kind - VS_OP_FUNCTION];
    if (function->of_two) {
      top--;
      top[0] = of_two(function, &top[0], &top[1]);
    } else
      top[0] = of_one(function, &top[0]);
  }
  return *top;
}
