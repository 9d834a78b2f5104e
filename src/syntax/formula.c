/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "syntax/formula.h"

#include <ctype.h>
#include <gsl/gsl_math.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { NUMBER, TERM, NAME, ADD, SUBTRACT, MULTIPLY, DIVIDE, POWER, NEGATE, FUNCTIONS };

/* x^y. Most exponents are whole numbers, as of squares and of varistors' laws; for these pow is
 * five times slower than multiplying. */
static double power(double x, double y) {
  return y == rint(y) && fabs(y) <= 100 ? gsl_pow_int(x, (int)y) : pow(x, y);
}

static double sign_power(double x, double y) {
  return copysign(power(fabs(x), y), x);
}
static const struct function {
  const char *name;
  double (*of)(double);
  double (*of_two)(double, double); /* one of the two is NULL */
} FUNCTION[] = {{"abs", fabs, NULL},       {"sqrt", sqrt, NULL},   {"exp", exp, NULL},
                {"ln", log, NULL},         {"log10", log10, NULL}, {"pow", NULL, power},
                {"pwr", NULL, sign_power}, {"min", NULL, fmin},    {"max", NULL, fmax},
                {"sin", sin, NULL},        {"cos", cos, NULL}};
enum { N_FUNCTIONS = sizeof FUNCTION / sizeof *FUNCTION, WORD = 60, LEVELS = 50 };

typedef struct reader {
  const char *at, *bad;
  const vs_formula_scope *scope;
  vs_formula *formula;
  int depth, level; /* how many values wait; how many brackets are open */
  char *why;
  size_t size;
} reader;

static bool fail(reader *r, const char *what) {
  if (!r->bad) {
    r->bad = r->at;
    snprintf(r->why, r->size, "%s", what);
  }
  return false;
}

/* Adds an operation that takes `pops` values and leaves one. */
static bool emit(reader *r, vs_op op, int pops) {
  r->depth += 1 - pops;
  if (r->depth > VS_FORMULA_DEPTH) return fail(r, "too long a formula");
  vs_formula *f = r->formula;
  f->ops = realloc(f->ops, (f->count + 1) * sizeof *f->ops);
  if (!f->ops) abort();
  f->ops[f->count++] = op;
  return true;
}

static char next(reader *r) {
  r->at += strspn(r->at, " \t");
  return *r->at;
}

static bool take(reader *r, char symbol) {
  if (next(r) != symbol) return false;
  r->at++;
  return true;
}

static bool read_sum(reader *r);

static bool number(reader *r) {
  static const struct {
    const char *suffix;
    double factor;
  } SUFFIX[] = {{"meg", 1e6}, {"t", 1e12}, {"g", 1e9},   {"k", 1e3},  {"m", 1e-3},
                {"u", 1e-6},  {"n", 1e-9}, {"p", 1e-12}, {"f", 1e-15}};
  char *end;
  double value = strtod(r->at, &end);
  if (end == r->at || !isfinite(value)) return fail(r, "a number is wanted here");
  for (size_t k = 0; k < sizeof SUFFIX / sizeof *SUFFIX; k++)
    if (!strncasecmp(end, SUFFIX[k].suffix, strlen(SUFFIX[k].suffix))) {
      end += strlen(SUFFIX[k].suffix);
      value *= SUFFIX[k].factor;
      break;
    }
  r->at = end;
  if (isalnum((unsigned char)*end))
    return fail(r, "a number ends with t g meg k m u n p f or nothing");
  return emit(r, (vs_op){.kind = NUMBER, .value = value}, 0);
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
    s += n;
    s += strspn(s, " \t");
    if (*s != ',' || quantity == 'i') break;
    s++;
  }
  if (*s != ')') return false;
  *at = s + 1;
  return true;
}

static bool call(reader *r, const char *word) {
  for (int k = 0; k < N_FUNCTIONS; k++) {
    if (strcmp(word, FUNCTION[k].name)) continue;
    bool two = FUNCTION[k].of_two;
    if (!take(r, '(') || !read_sum(r)) return fail(r, "'(' is wanted here");
    if (two && (!take(r, ',') || !read_sum(r))) return fail(r, "',' and a second value are wanted");
    if (!take(r, ')')) return fail(r, "')' is wanted here");
    return emit(r, (vs_op){.kind = FUNCTIONS + k}, two ? 2 : 1);
  }
  return fail(r, "no such function; there are: abs sqrt exp ln log10 pow pwr min max sin cos");
}

static bool word(reader *r) {
  char text[WORD], first[WORD], second[WORD];
  size_t n = 0;
  const char *begin = r->at;
  while (isalnum((unsigned char)begin[n]) || begin[n] == '_' ||
         (n && begin[n] == '.' && isalpha((unsigned char)begin[n + 1])))
    n++;
  if (n == 0 || n >= sizeof text) return fail(r, "a number, v(...), i(...) or a name is wanted");
  for (size_t k = 0; k < n; k++) text[k] = (char)tolower((unsigned char)begin[k]);
  text[n] = '\0';
  r->at = begin + n;
  int index;
  if (next(r) != '(') {
    index = r->scope->name(r->scope->ctx, begin, text);
    if (index >= VS_FORMULA_TERMS)
      return emit(r, (vs_op){.kind = TERM, .index = index - VS_FORMULA_TERMS}, 0);
    return index < 0 ? fail(r, "too many names")
                     : emit(r, (vs_op){.kind = NAME, .index = index}, 0);
  }
  if (strcmp(text, "v") && strcmp(text, "i")) return call(r, text);
  if (!vs_formula_term_read(&r->at, *text, first, second, sizeof first))
    return fail(r, "v(n), v(n,m) or i(Vx) is wanted");
  const vs_formula_term term = {*text, first, second};
  index = r->scope->term(r->scope->ctx, begin, &term);
  return index < 0 ? fail(r, "too many terms") : emit(r, (vs_op){.kind = TERM, .index = index}, 0);
}

static bool read_value(reader *r) {
  char c = next(r);
  if (c == '(' || c == '{') {
    if (++r->level > LEVELS) return fail(r, "too many brackets");
    r->at++;
    if (!read_sum(r)) return false;
    r->level--;
    return take(r, c == '(' ? ')' : '}') || fail(r, c == '(' ? "')' is wanted" : "'}' is wanted");
  }
  return isdigit((unsigned char)c) || c == '.' ? number(r) : word(r);
}

/* Reads a value or a power. -x^y is -(x^y); x^-y and x^y^z are read from the right. */
static bool read_power(reader *r) {
  if (take(r, '-')) {
    if (++r->level > LEVELS) return fail(r, "too many signs");
    return read_power(r) && r->level-- && emit(r, (vs_op){.kind = NEGATE}, 1);
  }
  if (!read_value(r)) return false;
  if (!take(r, '^')) return true;
  if (++r->level > LEVELS) return fail(r, "too many powers");
  return read_power(r) && r->level-- && emit(r, (vs_op){.kind = POWER}, 2);
}

static bool read_product(reader *r) {
  if (!read_power(r)) return false;
  for (;;) {
    int kind = take(r, '*') ? MULTIPLY : take(r, '/') ? DIVIDE : 0;
    if (!kind) return true;
    if (!read_power(r) || !emit(r, (vs_op){.kind = kind}, 2)) return false;
  }
}

static bool read_sum(reader *r) {
  if (!read_product(r)) return false;
  for (;;) {
    int kind = take(r, '+') ? ADD : take(r, '-') ? SUBTRACT : 0;
    if (!kind) return true;
    if (!read_product(r) || !emit(r, (vs_op){.kind = kind}, 2)) return false;
  }
}

const char *vs_formula_read(const char *text, const vs_formula_scope *scope, vs_formula *formula,
                            const char **bad, char *why, size_t size) {
  reader r = {.at = text, .scope = scope, .formula = formula, .why = why, .size = size};
  if (read_sum(&r)) return r.at;
  *bad = r.bad;
  return NULL;
}

void vs_formula_free(vs_formula *f) {
  free(f->ops);
  *f = (vs_formula){0};
}

bool vs_formula_has_terms(const vs_formula *f) {
  for (size_t k = 0; k < f->count; k++)
    if (f->ops[k].kind == TERM) return true;
  return false;
}

bool vs_formula_uses(const vs_formula *f, int term) {
  for (size_t k = 0; k < f->count; k++)
    if (f->ops[k].kind == TERM && f->ops[k].index == term) return true;
  return false;
}

int vs_formula_name_of(const vs_op *op) {
  return op->kind == NAME ? op->index : -1;
}

void vs_formula_bind(vs_formula *f, const double *values) {
  for (size_t k = 0; k < f->count; k++)
    if (f->ops[k].kind == NAME) f->ops[k].value = values[f->ops[k].index];
}

/* How many values wait at the most while the formula is evaluated. */
static int depth_of(const vs_formula *f) {
  int depth = 0, most = 0;
  for (size_t k = 0; k < f->count; k++) {
    int kind = f->ops[k].kind;
    bool leaf = kind == NUMBER || kind == TERM || kind == NAME;
    bool of_two = kind < NEGATE || (kind >= FUNCTIONS && FUNCTION[kind - FUNCTIONS].of_two);
    depth += leaf ? 1 : of_two ? -1 : 0;
    if (depth > most) most = depth;
  }
  return most;
}

bool vs_formula_put_in(vs_formula *f, int name, const vs_formula *by) {
  size_t count = 0, n = 0;
  for (size_t k = 0; k < f->count; k++)
    count += vs_formula_name_of(&f->ops[k]) == name ? by->count : 1;
  vs_op *ops = malloc(count * sizeof *ops);
  if (!ops) abort();
  for (size_t k = 0; k < f->count; k++) {
    bool is_it = vs_formula_name_of(&f->ops[k]) == name;
    memcpy(ops + n, is_it ? by->ops : &f->ops[k], (is_it ? by->count : 1) * sizeof *ops);
    n += is_it ? by->count : 1;
  }
  free(f->ops);
  *f = (vs_formula){ops, count};
  return depth_of(f) <= VS_FORMULA_DEPTH;
}

bool vs_formula_is_term(const vs_formula *f, int *term, double *factor) {
  double stack[VS_FORMULA_DEPTH + 1]; /* the values that wait, with the term at 1 */
  bool with[VS_FORMULA_DEPTH + 1];    /* whether the term is in the value */
  int top = -1, terms = 0;
  for (const vs_op *op = f->ops, *end = op + f->count; op < end; op++) {
    bool of_two = op->kind == MULTIPLY || op->kind == DIVIDE;
    if (op->kind == TERM || op->kind == NUMBER || op->kind == NAME) {
      with[++top] = op->kind == TERM;
      stack[top] = with[top] ? 1 : op->value;
      if (with[top]) *term = op->index;
      terms += with[top];
    } else if (op->kind == NEGATE) {
      stack[top] = -stack[top];
    } else if (of_two && !(op->kind == DIVIDE && with[top])) {
      top--;
      stack[top] = op->kind == DIVIDE ? stack[top] / stack[top + 1] : stack[top] * stack[top + 1];
      with[top] = with[top] || with[top + 1];
    } else
      return false;
  }
  *factor = stack[0];
  return terms == 1;
}

typedef struct pair {
  double a, b;
} pair;

void vs_formula_pair(const vs_formula *f, const double *first, const double *second,
                     double value[2]) {
  pair y = {0, 0}, stack[VS_FORMULA_DEPTH + 1],
       *x = stack; /* y is the last value, *x the one before it */
  for (const vs_op *op = f->ops, *end = op + f->count; op < end; op++) switch (op->kind) {
    case TERM:
      *++x = y;
      y = (pair){first[op->index], second[op->index]};
      break;
    case NUMBER:
    case NAME:
      *++x = y;
      y = (pair){op->value, op->value};
      break;
    case ADD:
      y = (pair){x->a + y.a, x->b + y.b};
      x--;
      break;
    case SUBTRACT:
      y = (pair){x->a - y.a, x->b - y.b};
      x--;
      break;
    case MULTIPLY:
      y = (pair){x->a * y.a, x->b * y.b};
      x--;
      break;
    case DIVIDE:
      y = (pair){x->a / y.a, x->b / y.b};
      x--;
      break;
    case POWER:
      y = (pair){power(x->a, y.a), power(x->b, y.b)};
      x--;
      break;
    case NEGATE:
      y = (pair){-y.a, -y.b};
      break;
    default: {
      const struct function *function = &FUNCTION[op->kind - FUNCTIONS];
      if (function->of_two) {
        y = (pair){function->of_two(x->a, y.a), function->of_two(x->b, y.b)};
        x--;
      } else
        y = (pair){function->of(y.a), function->of(y.b)};
    }
    }
  value[0] = y.a;
  value[1] = y.b;
}

double vs_formula_value(const vs_formula *f, const double *terms) {
  double value[2];
  vs_formula_pair(f, terms, terms, value);
  return value[0];
}
