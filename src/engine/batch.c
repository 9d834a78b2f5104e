/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/batch.h"

#include <math.h>
#include <string.h>

void vs_batch_take(vs_batch *b, const vs_step *step) {
  b->last = b->count;
  for (int k = 0; k <= step->parts; k++) {
    const vs_piece p = vs_step_piece(step, k);
    const double *from = p.from->terms, *to = p.to->terms;
    size_t n = b->count++;
    b->t0_s[n] = p.from->t_s;
    b->t1_s[n] = p.to->t_s;
    b->periodic[n] = step->periodic;
    for (size_t t = 0; t < step->frame->deck->n_terms; t++)
      b->term[t][n] = (vs_pair){(from[t] + to[t]) / 2, to[t]};
  }
}

/* A row of values: of each step of the batch one. */
typedef vs_pair row[VS_BATCH_STEPS];

static void add_rows(vs_pair *x, const vs_pair *y, size_t n) {
  for (size_t k = 0; k < n; k++) x[k] = x[k] + y[k];
}
static void subtract_rows(vs_pair *x, const vs_pair *y, size_t n) {
  for (size_t k = 0; k < n; k++) x[k] = x[k] - y[k];
}
static void multiply_rows(vs_pair *x, const vs_pair *y, size_t n) {
  for (size_t k = 0; k < n; k++) x[k] = x[k] * y[k];
}
static void divide_rows(vs_pair *x, const vs_pair *y, size_t n) {
  for (size_t k = 0; k < n; k++) x[k] = x[k] / y[k];
}

/* What x becomes by those of the operators that take two values and are quicker so. */
static void (*const QUICK[VS_OPERATORS])(vs_pair *x, const vs_pair *y,
                                         size_t n) = {[VS_ADD] = add_rows,
                                                      [VS_SUBTRACT] = subtract_rows,
                                                      [VS_MULTIPLY] = multiply_rows,
                                                      [VS_DIVIDE] = divide_rows};

static inline vs_pair absolute_pair(vs_pair x) {
  return (vs_pair){fabs(x[0]), fabs(x[1])};
}

/* As vs_formula_power has it. */
static inline vs_pair whole_power(vs_pair x, int exponent) {
  vs_pair y = {1, 1};
  for (; exponent; exponent >>= 1, x *= x)
    if (exponent & 1) y *= x;
  return y;
}

static bool is_whole_pair(vs_pair y) {
  return y[0] == y[1] && y[0] > 0 && y[0] <= VS_FORMULA_WHOLE && y[0] == (int)y[0];
}

/* x^y, or, `odd`, sign(x) |x|^y. */
static inline __attribute__((always_inline)) void raise_row(vs_pair *x, const vs_pair *y, size_t n,
                                                            bool odd) {
  for (size_t k = 0; k < n; k++) {
    vs_pair size = odd ? absolute_pair(x[k]) : x[k], power;
    power = is_whole_pair(y[k])
                ? whole_power(size, (int)y[k][0])
                : (vs_pair){vs_formula_power(size[0], y[k][0]), vs_formula_power(size[1], y[k][1])};
    x[k] = odd ? (vs_pair){copysign(power[0], x[k][0]), copysign(power[1], x[k][1])} : power;
  }
}

static void apply_to_two_rows(const vs_function *f, vs_pair *x, const vs_pair *y, size_t n) {
  if (f->of_two == vs_formula_power)
    raise_row(x, y, n, false);
  else if (f->of_two == vs_formula_sign_power)
    raise_row(x, y, n, true);
  else
    for (size_t k = 0; k < n; k++)
      x[k] = (vs_pair){f->of_two(x[k][0], y[k][0]), f->of_two(x[k][1], y[k][1])};
}

static void apply_to_row(const vs_function *f, vs_pair *x, size_t n) {
  for (size_t k = 0; k < n; k++) x[k] = (vs_pair){f->of(x[k][0]), f->of(x[k][1])};
}

/* Puts a term's values or a number into a row. */
static void put_operand(const vs_op *op, const vs_batch *b, vs_pair *y) {
  if (op->kind == VS_OP_TERM)
    memcpy(y, b->term[op->index], b->count * sizeof *y);
  else
    for (size_t k = 0; k < b->count; k++) y[k] = (vs_pair){op->value, op->value};
}

void vs_batch_evaluate(const vs_formula_prepared *q, const vs_batch *b,
                       vs_pair value[VS_BATCH_STEPS]) {
  row stack[VS_FORMULA_DEPTH + 1], *top = stack; /* *top is the last row */
  if (q->is_term) {
    for (size_t k = 0; k < b->count; k++) value[k] = q->factor * b->term[q->term][k];
    return;
  }
  const vs_op *op = q->formula->ops, *end = op + q->formula->count;
  put_operand(&(vs_op){.kind = VS_OP_NUMBER}, b, *top); /* what a formula without operations is */
  for (; op < end; op++) {
    if (op->kind < VS_OP_FUNCTION) {
      put_operand(op, b, *++top);
      continue;
    }
    int of = op->kind - VS_OP_FUNCTION;
    const vs_function *f = &vs_formula_functions[of];
    if (!f->of_two) {
      apply_to_row(f, *top, b->count);
      continue;
    }
    top--;
    if (of < VS_OPERATORS && QUICK[of])
      QUICK[of](*top, top[1], b->count);
    else
      apply_to_two_rows(f, *top, top[1], b->count);
  }
  memcpy(value, *top, b->count * sizeof *value);
}
