/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "base/formula.h"

#include <ctype.h>
#include <gsl/gsl_math.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/alloc.h"
#include "base/text.h"

/* ---- operators and functions ---- */

double vs_formula_power(double x, double y) {
  if (y == 2) return x * x; /* as gsl_pow_int has it; most losses are squares */
  return y == rint(y) && fabs(y) <= VS_FORMULA_WHOLE ? gsl_pow_int(x, (int)y) : pow(x, y);
}
double vs_formula_sign_power(double x, double y) {
  return copysign(vs_formula_power(fabs(x), y), x);
}
static double op_add(double x, double y) {
  return x + y;
}
static double op_subtract(double x, double y) {
  return x - y;
}
static double op_multiply(double x, double y) {
  return x * y;
}
static double op_divide(double x, double y) {
  return x / y;
}
static double op_negate(double x) {
  return -x;
}
static double op_sign(double x) {
  return (x > 0) - (x < 0);
}

static void set(double d[5], double x, double y, double xx, double xy, double yy) {
  d[0] = x, d[1] = y, d[2] = xx, d[3] = xy, d[4] = yy;
}
static void set_one(double d[5], double x, double xx) {
  d[0] = x, d[1] = xx;
}

static void add_slopes(double x, double y, double d[5]) {
  (void)x, (void)y;
  set(d, 1, 1, 0, 0, 0);
}
static void subtract_slopes(double x, double y, double d[5]) {
  (void)x, (void)y;
  set(d, 1, -1, 0, 0, 0);
}
static void multiply_slopes(double x, double y, double d[5]) {
  set(d, y, x, 0, 1, 0);
}
static void divide_slopes(double x, double y, double d[5]) {
  set(d, 1 / y, -x / (y * y), 0, -1 / (y * y), 2 * x / (y * y * y));
}
static void negate_slopes(double x, double y, double d[5]) {
  (void)x, (void)y;
  set_one(d, -1, 0);
}

/* f = x^y: f_x = y x^(y-1), f_y = x^y ln x, f_xx = y (y-1) x^(y-2), f_xy = x^(y-1) (1 + y ln x),
 * f_yy = x^y ln^2 x. For x = 0 and y > 2 all are 0; a derivative with the factor 0 is 0, though
 * the power of 0 beside it may be infinite. */
static void power_slopes(double x, double y, double d[5]) {
  double ln = x == 0 && y > 2 ? 0 : log(x), low = vs_formula_power(x, y - 2);
  double middle = x == 0 ? vs_formula_power(x, y - 1) : low * x;
  double f = x == 0 ? vs_formula_power(x, y) : middle * x, curve = y * (y - 1);
  set(d, y == 0 ? 0 : y * middle, f * ln, curve == 0 ? 0 : curve * low, middle * (1 + y * ln),
      f * ln * ln);
}

/* f = sign(x) |x|^y is odd in x, so f_x and f_xy are even. */
static void sign_power_slopes(double x, double y, double d[5]) {
  power_slopes(fabs(x), y, d);
  double s = copysign(1, x);
  d[1] *= s, d[2] *= s, d[4] *= s;
}
static void min_slopes(double x, double y, double d[5]) {
  set(d, x <= y, x > y, 0, 0, 0);
}
static void max_slopes(double x, double y, double d[5]) {
  set(d, x >= y, x < y, 0, 0, 0);
}
static void abs_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, copysign(1, x), 0);
}
static void sign_slopes(double x, double y, double d[5]) {
  (void)x, (void)y;
  set_one(d, 0, 0);
}
static void sqrt_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, 0.5 / sqrt(x), -0.25 / (x * sqrt(x)));
}
static void exp_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, exp(x), exp(x));
}
static void ln_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, 1 / x, -1 / (x * x));
}
static void log10_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, 1 / (x * M_LN10), -1 / (x * x * M_LN10));
}
static void sin_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, cos(x), -sin(x));
}
static void cos_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, -sin(x), -cos(x));
}
static void tan_slopes(double x, double y, double d[5]) {
  (void)y;
  double t = tan(x);
  set_one(d, 1 + t * t, 2 * t * (1 + t * t));
}
static void asin_slopes(double x, double y, double d[5]) {
  (void)y;
  double r = 1 / sqrt(1 - x * x);
  set_one(d, r, x * r * r * r);
}
static void acos_slopes(double x, double y, double d[5]) {
  asin_slopes(x, y, d);
  set_one(d, -d[0], -d[1]);
}
static void atan_slopes(double x, double y, double d[5]) {
  (void)y;
  double r = 1 / (1 + x * x);
  set_one(d, r, -2 * x * r * r);
}
static void sinh_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, cosh(x), sinh(x));
}
static void cosh_slopes(double x, double y, double d[5]) {
  (void)y;
  set_one(d, sinh(x), cosh(x));
}
static void tanh_slopes(double x, double y, double d[5]) {
  (void)y;
  double t = tanh(x);
  set_one(d, 1 - t * t, -2 * t * (1 - t * t));
}

#define ONE(NAME, OF, SLOPES, SLOPE, ...)                                                          \
  { .name = NAME, .of = OF, .slopes = SLOPES, .slope = {SLOPE}, __VA_ARGS__ }
#define TWO(NAME, OF, SLOPES, SLOPE_X, SLOPE_Y, ...)                                               \
  { .name = NAME, .of_two = OF, .slopes = SLOPES, .slope = {SLOPE_X, SLOPE_Y}, __VA_ARGS__ }
const vs_function vs_formula_functions[VS_FUNCTIONS] = {
    TWO("+", op_add, add_slopes, "1", "1", .alike = true),
    TWO("-", op_subtract, subtract_slopes, "1", "-1", .alike = true),
    TWO("*", op_multiply, multiply_slopes, "y", "x", .power = {1, 1}),
    TWO("/", op_divide, divide_slopes, "1/y", "-x/y^2", .power = {1, -1}),
    TWO("^", vs_formula_power, power_slopes, "y*x^(y-1)", "x^y*ln(x)", .raises = true),
    ONE("neg", op_negate, negate_slopes, "-1", .power = {1}),
    ONE("abs", fabs, abs_slopes, "sgn(x)", .power = {1}),
    ONE("sqrt", sqrt, sqrt_slopes, "0.5/sqrt(x)", .power = {0.5}),
    ONE("exp", exp, exp_slopes, "exp(x)", .pure = true),
    ONE("ln", log, ln_slopes, "1/x", .pure = true),
    ONE("log10", log10, log10_slopes, "1/(ln(10)*x)", .pure = true),
    TWO("pow", vs_formula_power, power_slopes, "y*x^(y-1)", "x^y*ln(x)", .raises = true),
    TWO("pwr", vs_formula_sign_power, sign_power_slopes, "y*abs(x)^(y-1)", "pwr(x,y)*ln(abs(x))",
        .raises = true),
    TWO("min", fmin, min_slopes, "(1-sgn(x-y))/2", "(1+sgn(x-y))/2", .alike = true),
    TWO("max", fmax, max_slopes, "(1+sgn(x-y))/2", "(1-sgn(x-y))/2", .alike = true),
    ONE("sin", sin, sin_slopes, "cos(x)", .pure = true),
    ONE("cos", cos, cos_slopes, "-sin(x)", .pure = true),
    ONE("tan", tan, tan_slopes, "1+tan(x)^2", .pure = true),
    ONE("asin", asin, asin_slopes, "1/sqrt(1-x^2)", .pure = true),
    ONE("acos", acos, acos_slopes, "-1/sqrt(1-x^2)", .pure = true),
    ONE("atan", atan, atan_slopes, "1/(1+x^2)", .pure = true),
    ONE("sinh", sinh, sinh_slopes, "cosh(x)", .pure = true),
    ONE("cosh", cosh, cosh_slopes, "sinh(x)", .pure = true),
    ONE("tanh", tanh, tanh_slopes, "1-tanh(x)^2", .pure = true),
    ONE("sgn", op_sign, sign_slopes, "0", .power = {0}),
};

/* The index of the function of that name; -1: there is none. Operators are not found. */
static int function_named(const char *name) {
  for (int k = VS_OPERATORS; k < VS_FUNCTIONS; k++)
    if (!strcmp(name, vs_formula_functions[k].name)) return k;
  return -1;
}

/* ---- reading ---- */

/* A formula of names that stand for formulas, each of which has the one before it twice, would grow
 * without a bound; and so would a derivative of many factors. */
enum { WORD = 60, LEVELS = 50, MOST_OPS = 4096 };

typedef struct reader {
  const char *text, *at, *bad;
  const vs_formula_scope *scope;
  vs_formula *formula;
  int depth, level; /* how many values wait; how many brackets are open */
  char *why;
  size_t size;
} reader;

static bool fail_formula(reader *r, const char *what) {
  if (!r->bad) {
    r->bad = r->at;
    snprintf(r->why, r->size, "%s", what);
  }
  return false;
}

/* How many values an operation takes. */
static int taken(int kind) {
  return kind < VS_OP_FUNCTION ? 0 : vs_formula_functions[kind - VS_OP_FUNCTION].of_two ? 2 : 1;
}

/* Adds an operation, which leaves one value. */
static bool emit_op(reader *r, vs_op op) {
  r->depth += 1 - taken(op.kind);
  if (r->depth > VS_FORMULA_DEPTH) return fail_formula(r, "too long a formula");
  vs_formula *f = r->formula;
  if (f->count == MOST_OPS) return fail_formula(r, "too long a formula, with those that it names");
  f->ops = vs_alloc_grow(f->ops, f->count, sizeof *f->ops);
  f->ops[f->count++] = op;
  return true;
}

/* Where something stands in the whole text. */
static int place_in_text(const reader *r, const char *at) {
  return (int)(at - r->text);
}

static bool emit_function_op(reader *r, int function, const char *at) {
  return emit_op(r, (vs_op){.kind = VS_OP_FUNCTION + function, .at = place_in_text(r, at)});
}

static char next_symbol(reader *r) {
  r->at += strspn(r->at, r->scope->of_machine ? " \t\n" : " \t");
  return *r->at;
}

static bool take_symbol(reader *r, char symbol) {
  if (next_symbol(r) != symbol) return false;
  r->at++;
  return true;
}

static bool read_sum(reader *r);

static bool read_formula_number(reader *r) {
  static const struct {
    const char *suffix;
    double factor;
  } SUFFIX[] = {{"meg", 1e6}, {"t", 1e12}, {"g", 1e9},   {"k", 1e3},  {"m", 1e-3},
                {"u", 1e-6},  {"n", 1e-9}, {"p", 1e-12}, {"f", 1e-15}};
  char *end;
  const char *begin = r->at;
  double value = vs_text_to_number(r->at, &end);
  const char *beyond = vs_text_out_of_range(r->at);
  if (beyond) return fail_formula(r, beyond);
  if (end == r->at || !isfinite(value)) return fail_formula(r, "a number is wanted here");
  for (size_t k = 0; k < sizeof SUFFIX / sizeof *SUFFIX; k++)
    if (!strncasecmp(end, SUFFIX[k].suffix, strlen(SUFFIX[k].suffix))) {
      end += strlen(SUFFIX[k].suffix);
      value *= SUFFIX[k].factor;
      break;
    }
  r->at = end;
  if (isalnum((unsigned char)*end))
    return fail_formula(r, "a number ends with t g meg k m u n p f or nothing");
  return emit_op(r, (vs_op){.kind = VS_OP_NUMBER, .value = value, .at = place_in_text(r, begin)});
}

bool vs_formula_term_read(const char **at, char quantity, char *first, char *second, size_t size) {
  static const char NODE[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_.#+-:";
  const char *s = *at;
  char *into[2] = {first, second};
  snprintf(second, size, "0");
  s += strspn(s, " \t");
  if (*s++ != '(') return false;
  for (int k = 0; k < 2; k++) {
    s += strspn(s, " \t");
    size_t n = strspn(s, NODE);
    if (n == 0 || n >= size) return false;
    for (size_t c = 0; c < n; c++) into[k][c] = (char)tolower((unsigned char)s[c]);
    into[k][n] = '\0';
    if (quantity == 'v' && !strcmp(into[k], "gnd")) memcpy(into[k], "0", sizeof "0");
    s += n;
    s += strspn(s, " \t");
    if (*s != ',' || quantity == 'i') break;
    s++;
  }
  if (*s != ')') return false;
  *at = s + 1;
  return true;
}

static bool no_such_function(reader *r) {
  char what[200] = "no such function; there are:";
  for (int k = VS_OPERATORS; k < VS_FUNCTIONS; k++) {
    size_t n = strlen(what);
    snprintf(what + n, sizeof what - n, " %s", vs_formula_functions[k].name);
  }
  return fail_formula(r, what);
}

static bool read_call(reader *r, const char *word, const char *begin) {
  int k = function_named(word);
  if (k < 0) return no_such_function(r);
  bool two = vs_formula_functions[k].of_two;
  if (++r->level > LEVELS) return fail_formula(r, "too many functions in each other");
  if (!take_symbol(r, '(') || !read_sum(r)) return fail_formula(r, "'(' is wanted here");
  if (two && (!take_symbol(r, ',') || !read_sum(r)))
    return fail_formula(r, "',' and a second value are wanted");
  if (!take_symbol(r, ')')) return fail_formula(r, "')' is wanted here");
  r->level--;
  return emit_function_op(r, k, begin);
}

/* A name of a machine's formula that is no parameter. Returns false where it is one. */
static bool read_special_name(reader *r, const char *text, const char *begin, bool *good) {
  const vs_formula_scope *scope = r->scope;
  vs_op op = {.kind = VS_OP_NUMBER, .index = 1, .value = M_PI, .at = place_in_text(r, begin)};
  int term = scope->named_term ? scope->named_term(scope->ctx, text) : -1;
  if (term >= 0) op = (vs_op){.kind = VS_OP_TERM, .index = term, .at = op.at};
  const vs_formula *f = scope->named_formula ? scope->named_formula(scope->ctx, text) : NULL;
  if (term < 0 && f) {
    *good = true;
    for (size_t k = 0; k < f->count && *good; k++) {
      vs_op copy = f->ops[k];
      copy.at = op.at;
      *good = emit_op(r, copy);
    }
    return true;
  }
  if (term < 0 && strcmp(text, "pi")) return false;
  *good = emit_op(r, op);
  return true;
}

static bool read_term(reader *r, char quantity, const char *begin) {
  char first[WORD], second[WORD];
  if (!r->scope->term)
    return fail_formula(r, "v(...) and i(...) are known in a circuit's formulas alone");
  if (!vs_formula_term_read(&r->at, quantity, first, second, sizeof first))
    return fail_formula(r, "v(n), v(n,m) or i(Vx) is wanted");
  const vs_formula_term read = {quantity, first, second};
  int index = r->scope->term(r->scope->ctx, begin, &read);
  if (index < 0) return fail_formula(r, "too many terms");
  return emit_op(r, (vs_op){.kind = VS_OP_TERM, .index = index, .at = place_in_text(r, begin)});
}

static bool read_word(reader *r) {
  char text[WORD], low[WORD];
  size_t n = 0;
  const char *begin = r->at;
  bool of_machine = r->scope->of_machine, good;
  while (isalnum((unsigned char)begin[n]) || begin[n] == '_' || (of_machine && begin[n] == '.'))
    n++;
  if (n == 0 || n >= sizeof text)
    return fail_formula(r, r->scope->term ? "a number, v(...), i(...) or a name is wanted"
                                          : "a number or a name is wanted");
  for (size_t k = 0; k < n; k++) {
    text[k] = begin[k];
    low[k] = (char)tolower((unsigned char)begin[k]);
  }
  text[n] = low[n] = '\0';
  r->at = begin + n;
  if (next_symbol(r) == '(')
    return strcmp(low, "v") && strcmp(low, "i") ? read_call(r, low, begin)
                                                : read_term(r, *low, begin);
  if (of_machine && read_special_name(r, text, begin, &good)) return good;
  int index = r->scope->name(r->scope->ctx, begin, of_machine ? text : low);
  if (index < 0) return fail_formula(r, "too many names");
  return emit_op(r, (vs_op){.kind = VS_OP_NAME, .index = index, .at = place_in_text(r, begin)});
}

static bool read_value(reader *r) {
  char c = next_symbol(r);
  if (c == '(' || c == '{') {
    if (++r->level > LEVELS) return fail_formula(r, "too many brackets");
    r->at++;
    if (!read_sum(r)) return false;
    r->level--;
    return take_symbol(r, c == '(' ? ')' : '}') ||
           fail_formula(r, c == '(' ? "')' is wanted" : "'}' is wanted");
  }
  return isdigit((unsigned char)c) || c == '.' ? read_formula_number(r) : read_word(r);
}

/* Reads a value or a power. -x^y is -(x^y); x^-y and x^y^z are read from the right. */
static bool read_power(reader *r) {
  if (take_symbol(r, '-')) {
    const char *at = r->at - 1;
    if (++r->level > LEVELS) return fail_formula(r, "too many signs");
    return read_power(r) && r->level-- && emit_function_op(r, VS_NEGATE, at);
  }
  if (!read_value(r)) return false;
  if (!take_symbol(r, '^')) return true;
  const char *at = r->at - 1;
  if (++r->level > LEVELS) return fail_formula(r, "too many powers");
  return read_power(r) && r->level-- && emit_function_op(r, VS_POWER, at);
}

static bool read_product(reader *r) {
  if (!read_power(r)) return false;
  for (;;) {
    int kind = take_symbol(r, '*') ? VS_MULTIPLY : take_symbol(r, '/') ? VS_DIVIDE : -1;
    const char *at = r->at - 1;
    if (kind < 0) return true;
    if (!read_power(r) || !emit_function_op(r, kind, at)) return false;
  }
}

static bool read_sum(reader *r) {
  if (!read_product(r)) return false;
  for (;;) {
    int kind = take_symbol(r, '+') ? VS_ADD : take_symbol(r, '-') ? VS_SUBTRACT : -1;
    const char *at = r->at - 1;
    if (kind < 0) return true;
    if (!read_product(r) || !emit_function_op(r, kind, at)) return false;
  }
}

const char *vs_formula_read(const char *text, const vs_formula_scope *scope, vs_formula *formula,
                            const char **bad, char *why, size_t size) {
  reader r = {
      .text = text, .at = text, .scope = scope, .formula = formula, .why = why, .size = size};
  if (read_sum(&r)) return r.at;
  *bad = r.bad;
  return NULL;
}

/* ---- what is in a formula ---- */

void vs_formula_free(vs_formula *f) {
  free(f->ops);
  *f = (vs_formula){0};
}

bool vs_formula_has_terms(const vs_formula *f) {
  for (size_t k = 0; k < f->count; k++)
    if (f->ops[k].kind == VS_OP_TERM) return true;
  return false;
}

bool vs_formula_uses(const vs_formula *f, int term) {
  for (size_t k = 0; k < f->count; k++)
    if (f->ops[k].kind == VS_OP_TERM && f->ops[k].index == term) return true;
  return false;
}

int vs_formula_name_of(const vs_op *op) {
  return op->kind == VS_OP_NAME ? op->index : -1;
}

void vs_formula_bind(vs_formula *f, const double *values) {
  for (size_t k = 0; k < f->count; k++)
    if (f->ops[k].kind == VS_OP_NAME) f->ops[k].value = values[f->ops[k].index];
}

void vs_formula_fold(vs_formula *f) {
  size_t n = 0; /* how many operations are kept */
  for (size_t k = 0; k < f->count; k++) {
    vs_op op = f->ops[k], *top = &f->ops[n];
    size_t of = (size_t)taken(op.kind);
    bool fixed = of > 0;
    for (size_t m = 1; m <= of; m++)
      fixed = fixed && (top[-(int)m].kind == VS_OP_NUMBER || top[-(int)m].kind == VS_OP_NAME);
    if (fixed) {
      const vs_function *function = &vs_formula_functions[op.kind - VS_OP_FUNCTION];
      op.value =
          of == 2 ? function->of_two(top[-2].value, top[-1].value) : function->of(top[-1].value);
      op = (vs_op){.kind = VS_OP_NUMBER, .value = op.value, .at = op.at};
      n -= of;
    }
    f->ops[n++] = op;
  }
  f->count = n;
}

bool vs_formula_is_term(const vs_formula *f, int *term, double *factor) {
  double stack[VS_FORMULA_DEPTH + 1]; /* the values that wait, with the term at 1 */
  bool with[VS_FORMULA_DEPTH + 1];    /* whether the term is in the value */
  int top = -1, terms = 0;
  for (const vs_op *op = f->ops, *end = op + f->count; op < end; op++) {
    bool of_two =
        op->kind == VS_OP_FUNCTION + VS_MULTIPLY || op->kind == VS_OP_FUNCTION + VS_DIVIDE;
    if (op->kind == VS_OP_TERM || op->kind == VS_OP_NUMBER || op->kind == VS_OP_NAME) {
      with[++top] = op->kind == VS_OP_TERM;
      stack[top] = with[top] ? 1 : op->value;
      if (with[top]) *term = op->index;
      terms += with[top];
    } else if (op->kind == VS_OP_FUNCTION + VS_NEGATE) {
      stack[top] = -stack[top];
    } else if (of_two && !(op->kind == VS_OP_FUNCTION + VS_DIVIDE && with[top])) {
      top--;
      stack[top] = op->kind == VS_OP_FUNCTION + VS_DIVIDE ? stack[top] / stack[top + 1]
                                                          : stack[top] * stack[top + 1];
      with[top] = with[top] || with[top + 1];
    } else
      return false;
  }
  *factor = stack[0];
  return terms == 1;
}

vs_formula_prepared vs_formula_prepare(const vs_formula *f) {
  vs_formula_prepared q = {.formula = f};
  q.is_term = vs_formula_is_term(f, &q.term, &q.factor);
  return q;
}

/* ---- values ---- */

/* Two values side by side, on which one instruction works. */
typedef double pair __attribute__((vector_size(2 * sizeof(double))));

/* The values for both sets of terms, or, `both` being a constant that is false, for the first. */
static inline __attribute__((always_inline)) pair
evaluate_pair(const vs_formula *f, const double *first, const double *second, bool both) {
  pair y = {0, 0}, stack[VS_FORMULA_DEPTH + 1],
       *x = stack; /* y is the last value, *x the one before it */
  for (const vs_op *op = f->ops, *end = op + f->count; op < end; op++) switch (op->kind) {
    case VS_OP_TERM:
      *++x = y;
      y = (pair){first[op->index], second[op->index]};
      break;
    case VS_OP_NUMBER:
    case VS_OP_NAME:
      *++x = y;
      y = (pair){op->value, op->value};
      break;
    case VS_OP_FUNCTION + VS_ADD:
      y = *x-- + y;
      break;
    case VS_OP_FUNCTION + VS_SUBTRACT:
      y = *x-- - y;
      break;
    case VS_OP_FUNCTION + VS_MULTIPLY:
      y = *x-- * y;
      break;
    case VS_OP_FUNCTION + VS_DIVIDE:
      y = *x-- / y;
      break;
    case VS_OP_FUNCTION + VS_POWER:
      y = (pair){vs_formula_power((*x)[0], y[0]), both ? vs_formula_power((*x)[1], y[1]) : 0};
      x--;
      break;
    case VS_OP_FUNCTION + VS_NEGATE:
      y = -y;
      break;
    default: {
      const vs_function *function = &vs_formula_functions[op->kind - VS_OP_FUNCTION];
      if (function->of_two) {
        y = (pair){function->of_two((*x)[0], y[0]), both ? function->of_two((*x)[1], y[1]) : 0};
        x--;
      } else
        y = (pair){function->of(y[0]), both ? function->of(y[1]) : 0};
    }
    }
  return y;
}

void vs_formula_pair(const vs_formula *f, const double *first, const double *second,
                     double value[2]) {
  pair y = evaluate_pair(f, first, second, true);
  value[0] = y[0];
  value[1] = y[1];
}

double vs_formula_value(const vs_formula *f, const double *terms) {
  return evaluate_pair(f, terms, terms, false)[0];
}
