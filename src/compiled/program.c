/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "program.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"

/* Operations. Those from COMPARE on hold a branch in `value`; those up to KINK have one in it, too,
 * but only so that a step ends where the slope jumps. */
enum {
  MINIMUM,
  MAXIMUM,
  SIZE, /* abs(a) */
  LINE, /* pwl(a; points): b is the first of its points, c how many */
  KINK = LINE,
  CONSTANT,
  SIGNAL,
  ADD,
  SUBTRACT,
  MULTIPLY,
  DIVIDE,
  POWER,      /* |a|^b */
  SIGN_POWER, /* sgn(a) |a|^b */
  FUNCTION,
  POINT,   /* constants x in value; y in the next one */
  COMPARE, /* value of a comparison or logical operation; c: its sign */
  ROUND,   /* floor, ceil, nint or int of a */
  CHOICE,  /* a ? b : c */
  STEP,    /* u(a) */
  SIGN     /* sgn(a) */
};

typedef struct writing {
  const vs_cards *cards;
  vs_parameters *in;
  const vs_program_scope *scope;
  vs_compiled_program *p;
  vs_error *err;
} writing;

/* A name in a function's body that stands for an operation. */
typedef struct bound_op {
  vs_word name;
  int op;
  const struct bound_op *next;
} bound_op;

static int add_op(writing *w, vs_program_op op) {
  vs_compiled_program *p = w->p;
  if (p->count == VS_PROGRAM_OPS) {
    vs_fail(w->err, VS_INPUT, "the expression is too long: more than %d operations",
            VS_PROGRAM_OPS);
    return -1;
  }
  p->op = vs_alloc_grow(p->op, (size_t)p->count, sizeof *p->op);
  p->op[p->count] = op;
  p->chooses = p->chooses || op.kind >= COMPARE || op.kind <= KINK;
  return p->count++;
}

static int add_constant(writing *w, double value) {
  return add_op(w, (vs_program_op){.kind = CONSTANT, .value = value});
}

static bool is_constant(const writing *w, int op) {
  return w->p->op[op].kind == CONSTANT;
}

static int refuse(const writing *w, vs_word what) {
  vs_fail(w->err, VS_INPUT, "'%.*s' is not known in an expression here", (int)what.n, what.at);
  return -1;
}

static int add_signal(writing *w, const vs_program_signal *s) {
  vs_compiled_program *p = w->p;
  int k = 0;
  while (k < p->signals && (p->signal[k].plus != s->plus || p->signal[k].minus != s->minus)) k++;
  if (k == VS_PROGRAM_SIGNALS) {
    vs_fail(w->err, VS_INPUT, "the expression has more than %d voltages and currents",
            VS_PROGRAM_SIGNALS);
    return -1;
  }
  p->signal[k] = *s;
  p->signals += k == p->signals;
  return add_op(w, (vs_program_op){.kind = SIGNAL, .a = k});
}

static int write_tree(writing *w, const vs_expr *e, size_t node, const bound_op *bound);

/* v(a), v(a,b), i(Vx). */
static int write_signal(writing *w, const vs_expr *e, size_t node) {
  const vs_expr_node *n = &e->node[node];
  const size_t first = n->child, second = first ? e->node[first].next : 0;
  const bool voltage = vs_words_is(n->word, "v");
  vs_program_signal s = {-1, -1};
  if (!first || (second && !voltage)) return refuse(w, n->whole);
  s.plus = voltage ? w->scope->node(w->scope->ctx, w->in, e->node[first].word)
                   : w->scope->current(w->scope->ctx, w->in, e->node[first].word);
  if (second) s.minus = w->scope->node(w->scope->ctx, w->in, e->node[second].word);
  return s.plus < -1 || s.minus < -1 ? refuse(w, n->whole) : add_signal(w, &s);
}

/* What follows from constants alone is one. */
static int add_two(writing *w, int kind, int a, int b, double (*fold)(double, double)) {
  if (fold && is_constant(w, a) && is_constant(w, b))
    return add_constant(w, fold(w->p->op[a].value, w->p->op[b].value));
  return add_op(w, (vs_program_op){.kind = kind, .a = a, .b = b});
}

static int add_function(writing *w, double (*of)(double), int a) {
  if (is_constant(w, a)) return add_constant(w, of(w->p->op[a].value));
  const bool rounds = of == floor || of == ceil || of == nearbyint || of == trunc;
  const int kind = rounds ? ROUND : of == fabs ? SIZE : FUNCTION;
  return add_op(w, (vs_program_op){.kind = kind, .a = a, .of = of});
}

/* uramp(a) = max(a, 0), u2(a) = min(max(a, 0), 1) */
static int write_ramp(writing *w, int a, bool ends) {
  const int zero = add_constant(w, 0);
  const int above = zero < 0 ? -1 : add_two(w, MAXIMUM, a, zero, fmax);
  const int one = above < 0 || !ends ? above : add_constant(w, 1);
  return one < 0 || !ends ? one : add_two(w, MINIMUM, above, one, fmin);
}

static int write_function(writing *w, const vs_netlist_definition *d, const int *given,
                          size_t count) {
  bound_op own[VS_WORDS_MOST];
  vs_word names[VS_WORDS_MOST];
  char text[1024];
  const char *end;
  snprintf(text, sizeof text, "(%.*s)", (int)d->arguments.n, d->arguments.at);
  if (vs_words_arguments(text, names, &end) != count) return refuse(w, d->name);
  for (size_t k = 0; k < count; k++)
    own[k] = (bound_op){names[k], given[k], k ? &own[k - 1] : NULL};
  vs_expr body;
  vs_expr_read(&body, d->body);
  int op = write_tree(w, &body, body.node[0].child, count ? &own[count - 1] : NULL);
  vs_expr_free(&body);
  return op;
}

static int write_line(writing *w, const vs_expr_node *n, const int *given, size_t count) {
  if (count < 5 || count % 2 == 0) return refuse(w, n->whole);
  for (size_t k = 1; k < count; k++)
    if (!is_constant(w, given[k])) return refuse(w, n->whole);
  int first = -1;
  double values[2 * VS_WORDS_MOST];
  for (size_t k = 1; k < count; k++) values[k] = w->p->op[given[k]].value;
  for (size_t k = 1; k < count; k++) {
    int op = add_op(w, (vs_program_op){.kind = POINT, .value = values[k]});
    if (op < 0) return -1;
    if (k == 1) first = op;
  }
  return add_op(
      w, (vs_program_op){.kind = LINE, .a = given[0], .b = first, .c = (int)((count - 1) / 2)});
}

/* limit(x, a, b) of PSpice's dialect, whose bounds may stand in either order. */
static int write_limit(writing *w, const int *given) {
  const int least = add_two(w, MINIMUM, given[1], given[2], fmin);
  const int most = least < 0 ? -1 : add_two(w, MAXIMUM, given[1], given[2], fmax);
  const int above = most < 0 ? -1 : add_two(w, MAXIMUM, given[0], least, fmax);
  return above < 0 ? -1 : add_two(w, MINIMUM, above, most, fmin);
}

static int write_call(writing *w, const vs_expr *e, size_t node, const bound_op *bound) {
  const vs_expr_node *n = &e->node[node];
  int given[2 * VS_WORDS_MOST];
  size_t count = 0;
  if (vs_words_is(n->word, "v") || vs_words_is(n->word, "i")) return write_signal(w, e, node);
  for (size_t k = n->child; k; k = e->node[k].next) {
    if (count == 2 * VS_WORDS_MOST) return refuse(w, n->whole);
    if ((given[count++] = write_tree(w, e, k, bound)) < 0) return -1;
  }
  for (vs_parameters *at = w->in; at; at = at->caller) {
    const vs_netlist_definition *d =
        vs_cards_resolve(w->cards, at->in.scope, VS_CARDS_FUNC, n->word);
    if (d) return write_function(w, d, given, count);
  }
  if (vs_words_is(n->word, "pwl")) return write_line(w, n, given, count);
  if (count == 3 && (vs_words_is(n->word, "if") || vs_words_is(n->word, "ternary_fcn")))
    return add_op(w, (vs_program_op){CHOICE, given[0], given[1], given[2], 0, NULL});
  if (count == 3 && vs_words_is(n->word, "limit")) return write_limit(w, given);
  if (count == 1 && (vs_words_is(n->word, "u") || vs_words_is(n->word, "stp")))
    return add_op(w, (vs_program_op){.kind = STEP, .a = given[0]});
  if (count == 1 && vs_words_is(n->word, "sgn"))
    return add_op(w, (vs_program_op){.kind = SIGN, .a = given[0]});
  if (count == 1 && (vs_words_is(n->word, "uramp") || vs_words_is(n->word, "u2")))
    return write_ramp(w, given[0], vs_words_is(n->word, "u2"));
  vs_parameters_of_one *one = vs_parameters_function(n->word);
  vs_parameters_of_two *two = vs_parameters_function_2(w->in, n->word);
  if (one && count == 1) return add_function(w, one, given[0]);
  if (!two || count != 2) return refuse(w, n->whole);
  const int kind = vs_words_is(n->word, "min")   ? MINIMUM
                   : vs_words_is(n->word, "max") ? MAXIMUM
                   : two(-1, 1) < 0              ? SIGN_POWER
                                                 : POWER;
  return add_two(w, kind, given[0], given[1], two);
}

static int write_operator(writing *w, const vs_expr *e, const vs_expr_node *n,
                          const bound_op *bound) {
  int a = write_tree(w, e, n->child, bound);
  int b = a < 0 ? -1 : write_tree(w, e, e->node[n->child].next, bound);
  double value;
  if (b < 0) return -1;
  if (is_constant(w, a) && is_constant(w, b) &&
      vs_parameters_operate(n->word, w->p->op[a].value, w->p->op[b].value, &value))
    return add_constant(w, value);
  if (n->word.n == 1 && strchr("+-*/^", *n->word.at)) {
    static const int KINDS[] = {ADD, SUBTRACT, MULTIPLY, DIVIDE, POWER};
    return add_two(w, KINDS[strchr("+-*/^", *n->word.at) - "+-*/^"], a, b, NULL);
  }
  if (n->word.n == 2 && !memcmp(n->word.at, "**", 2)) return add_two(w, POWER, a, b, NULL);
  if (!vs_parameters_operate(n->word, 1, 1, &value)) return refuse(w, n->whole);
  const int sign = (unsigned char)n->word.at[0] + 256 * (n->word.n > 1 ? n->word.at[1] : 0);
  return add_op(w, (vs_program_op){.kind = COMPARE, .a = a, .b = b, .c = sign});
}

static int write_tree(writing *w, const vs_expr *e, size_t node, const bound_op *bound) {
  const vs_expr_node *n = &e->node[node];
  double value;
  int a, b, c;
  switch (n->kind) {
  case VS_EXPR_NAME:
    for (const bound_op *k = bound; k; k = k->next)
      if (!vs_words_compare(k->name, n->word)) return k->op;
    /* fallthrough */
  case VS_EXPR_NUMBER:
    if (vs_parameters_of_tree(w->cards, w->in, e, node, NULL, &value, w->err)) return -1;
    return add_constant(w, value);
  case VS_EXPR_BRACKET:
    return n->child ? write_tree(w, e, n->child, bound) : refuse(w, n->whole);
  case VS_EXPR_SIGN:
    a = write_tree(w, e, n->child, bound);
    if (a < 0 || *n->word.at == '+') return a;
    if (*n->word.at != '-') return refuse(w, n->whole);
    if (is_constant(w, a)) return add_constant(w, -w->p->op[a].value);
    b = add_constant(w, 0);
    return b < 0 ? -1 : add_two(w, SUBTRACT, b, a, NULL);
  case VS_EXPR_OPERATOR:
    return write_operator(w, e, n, bound);
  case VS_EXPR_CHOICE:
    a = write_tree(w, e, n->child, bound);
    node = e->node[n->child].next;
    b = a < 0 ? -1 : write_tree(w, e, node, bound);
    c = b < 0 ? -1 : write_tree(w, e, e->node[node].next, bound);
    return c < 0 ? -1 : add_op(w, (vs_program_op){CHOICE, a, b, c, 0, NULL});
  case VS_EXPR_CALL:
    return write_call(w, e, node, bound);
  default:
    return refuse(w, n->whole);
  }
}

static int chosen_by(const vs_program_op *op) {
  return op->value != 0 ? op->b : op->c;
}

/* `held`: what a branch is chosen by does not count. */
static void mark_operands(const vs_program_op *op, bool held, bool *of) {
  if (op->kind == CONSTANT || op->kind == SIGNAL || op->kind == POINT) return;
  if (held && op->kind == CHOICE) of[chosen_by(op)] = true;
  if (held && op->kind >= COMPARE) return;
  of[op->a] = true;
  if (op->kind == CHOICE)
    of[chosen_by(op)] = true;
  else if ((op->kind >= ADD && op->kind <= SIGN_POWER) || op->kind <= MAXIMUM ||
           op->kind == COMPARE)
    of[op->b] = true;
}

static bool is_branch(const vs_program_op *op) {
  return op->kind >= COMPARE || op->kind <= KINK;
}

/* Lists the operations that the result follows from, by the branches that are held, and those of
 * them that decide. */
static void find_live(vs_compiled_program *p) {
  bool *live = vs_alloc((size_t)p->count, sizeof *live);
  bool *decides = vs_alloc((size_t)p->count, sizeof *decides);
  live[p->count - 1] = true;
  p->result = p->count - 1;
  while (p->op[p->result].kind == CHOICE) p->result = chosen_by(&p->op[p->result]);
  for (int k = p->count - 1; k >= 0; k--) {
    if (live[k]) mark_operands(&p->op[k], true, live);
    if (decides[k]) mark_operands(&p->op[k], false, decides);
    if (!live[k] || !is_branch(&p->op[k])) continue;
    decides[p->op[k].a] = true;
    if (p->op[k].kind == COMPARE || p->op[k].kind <= MAXIMUM) decides[p->op[k].b] = true;
  }
  p->n_live = p->n_decides = 0;
  for (int k = 0; k < p->count; k++) {
    if (p->op[k].kind == CONSTANT || p->op[k].kind == POINT) continue;
    if (live[k] && k <= p->result) p->live[p->n_live++] = k;
    if (decides[k] || (live[k] && is_branch(&p->op[k]))) p->decides[p->n_decides++] = k;
  }
  free(live);
  free(decides);
}

vs_status vs_program_read(const vs_cards *c, vs_parameters *in, vs_word text,
                          const vs_program_scope *scope, vs_compiled_program *p, vs_error *err) {
  writing w = {c, in, scope, p, err};
  vs_expr e;
  *p = (vs_compiled_program){0};
  vs_expr_read(&e, text);
  int result = e.whole ? write_tree(&w, &e, e.node[0].child, NULL) : refuse(&w, text);
  vs_expr_free(&e);
  if (result < 0) return VS_INPUT;
  if (result != p->count - 1) { /* the result is to be the last one */
    int zero = add_constant(&w, 0);
    if (zero < 0 || add_two(&w, ADD, result, zero, NULL) < 0) return VS_INPUT;
  }
  p->live = vs_alloc((size_t)p->count, sizeof *p->live);
  p->decides = vs_alloc((size_t)p->count, sizeof *p->decides);
  p->value = vs_alloc((size_t)p->count, sizeof *p->value);
  for (int k = 0; k < p->count; k++) p->value[k] = p->op[k].value;
  find_live(p);
  return VS_OK;
}

void vs_program_free(vs_compiled_program *p) {
  free(p->op);
  free(p->live);
  free(p->decides);
  free(p->value);
  *p = (vs_compiled_program){0};
}

/* ---- evaluated ---- */

/* Beyond this the exponential goes on as a straight line, so that a first guess far away overflows
 * nothing. */
static const double STEEPEST = 300;

static double slope_of(double (*of)(double), double x, double value) {
  if (of == exp) return x > STEEPEST ? exp(STEEPEST) : value;
  if (of == log) return 1 / x;
  if (of == log10) return 1 / (x * M_LN10);
  if (of == sqrt) return value > 0 ? 0.5 / value : 0;
  if (of == sin) return cos(x);
  if (of == cos) return -sin(x);
  if (of == tan) return 1 + value * value;
  if (of == atan) return 1 / (1 + x * x);
  if (of == asin) return 1 / sqrt(1 - x * x);
  if (of == acos) return -1 / sqrt(1 - x * x);
  if (of == sinh) return cosh(x);
  if (of == cosh) return sinh(x);
  if (of == tanh) return 1 - value * value;
  if (of == asinh) return 1 / sqrt(1 + x * x);
  if (of == acosh) return 1 / sqrt(x * x - 1);
  if (of == atanh) return 1 / (1 - x * x);
  const double h = 1e-6 * fmax(fabs(x), 1); /* sqr */
  return (of(x + h) - of(x - h)) / (2 * h);
}

static double power_of(double a, double b) {
  if (b == 2) return a * a;
  return pow(fabs(a), b);
}

/* Where a lies among the points of a line, and the line's value and slope there. Outside it goes on
 * with its first or last value, as ngspice's pwl does with its slope. */
static double line_value(const vs_compiled_program *p, const vs_program_op *op, double x,
                         double *slope) {
  const vs_program_op *point = &p->op[op->b];
  int lo = 0, hi = op->c - 1;
  while (hi - lo > 1) {
    int mid = (lo + hi) / 2;
    if (point[2 * mid].value <= x)
      lo = mid;
    else
      hi = mid;
  }
  double x0 = point[2 * lo].value, x1 = point[2 * hi].value;
  double y0 = point[2 * lo + 1].value, y1 = point[2 * hi + 1].value;
  *slope = (y1 - y0) / (x1 - x0);
  return y0 + *slope * (x - x0);
}

static double compare(int sign, double a, double b) {
  const char text[2] = {(char)(sign & 255), (char)(sign >> 8)};
  double value = 0;
  vs_parameters_operate((vs_word){text, sign >> 8 ? 2 : 1}, a, b, &value);
  return value;
}

static inline __attribute__((always_inline)) void take_forward(const vs_compiled_program *p, int k,
                                                               const double *y) {
  double slope, *v = p->value;
  const vs_program_op *op = &p->op[k];
  switch (op->kind) {
  case SIGNAL: {
    const vs_program_signal *s = &p->signal[op->a];
    v[k] = (s->plus < 0 ? 0 : y[s->plus]) - (s->minus < 0 ? 0 : y[s->minus]);
    break;
  }
  case ADD:
    v[k] = v[op->a] + v[op->b];
    break;
  case SUBTRACT:
    v[k] = v[op->a] - v[op->b];
    break;
  case MULTIPLY:
    v[k] = v[op->a] * v[op->b];
    break;
  case DIVIDE:
    v[k] = v[op->a] / v[op->b];
    break;
  case POWER:
    v[k] = power_of(v[op->a], v[op->b]);
    break;
  case SIGN_POWER:
    v[k] = copysign(pow(fabs(v[op->a]), v[op->b]), v[op->a]);
    break;
  case MINIMUM:
    v[k] = v[op->b] < v[op->a] ? v[op->b] : v[op->a];
    break;
  case MAXIMUM:
    v[k] = v[op->b] > v[op->a] ? v[op->b] : v[op->a];
    break;
  case FUNCTION:
    v[k] = op->of == exp && v[op->a] > STEEPEST ? exp(STEEPEST) * (1 + v[op->a] - STEEPEST)
                                                : op->of(v[op->a]);
    break;
  case LINE:
    v[k] = line_value(p, op, v[op->a], &slope);
    break;
  case SIZE:
    v[k] = fabs(v[op->a]);
    break;
  case CHOICE:
    v[k] = v[chosen_by(op)];
    break;
  default:
    v[k] = op->value;
    break; /* COMPARE, ROUND, STEP, SIGN */
  }
}

static void go_forward(const vs_compiled_program *p, const double *y) {
  for (int n = 0; n < p->n_live; n++) take_forward(p, p->live[n], y);
}

/* From the result back to the signals: the derivative by each operation. */
static void go_back(const vs_compiled_program *p, double *slope) {
  double d[VS_PROGRAM_OPS], at;
  const double *v = p->value;
  memset(d, 0, (size_t)p->count * sizeof *d);
  for (int k = 0; k < p->signals; k++) slope[k] = 0;
  d[p->result] = 1;
  for (int n = p->n_live - 1; n >= 0; n--) {
    const int k = p->live[n];
    const vs_program_op *op = &p->op[k];
    const double g = d[k];
    if (g == 0) continue;
    switch (op->kind) {
    case SIGNAL:
      slope[op->a] += g;
      break;
    case ADD:
      d[op->a] += g, d[op->b] += g;
      break;
    case SUBTRACT:
      d[op->a] += g, d[op->b] -= g;
      break;
    case MULTIPLY:
      d[op->a] += g * v[op->b], d[op->b] += g * v[op->a];
      break;
    case DIVIDE:
      d[op->a] += g / v[op->b], d[op->b] -= g * v[k] / v[op->b];
      break;
    case POWER:
    case SIGN_POWER: {
      const double a = v[op->a], b = v[op->b], size = fabs(a);
      const double rate = b == 0 ? 0 : b * pow(size, b - 1);
      d[op->a] += g * (op->kind == POWER && a < 0 ? -rate : rate);
      if (p->op[op->b].kind != CONSTANT && size > 0) d[op->b] += g * v[k] * log(size);
      break;
    }
    case MINIMUM:
      d[v[op->a] <= v[op->b] ? op->a : op->b] += g;
      break;
    case MAXIMUM:
      d[v[op->a] >= v[op->b] ? op->a : op->b] += g;
      break;
    case FUNCTION:
      d[op->a] += g * slope_of(op->of, v[op->a], v[k]);
      break;
    case LINE:
      line_value(p, op, v[op->a], &at);
      d[op->a] += g * at;
      break;
    case SIZE:
      d[op->a] += v[op->a] < 0 ? -g : g;
      break;
    case CHOICE:
      d[chosen_by(op)] += g;
      break;
    default:
      break;
    }
  }
}

double vs_program_value(const vs_compiled_program *p, const double *y, double *slope) {
  if (p->n_live) go_forward(p, y);
  if (slope) go_back(p, slope);
  return p->value[p->result];
}

/* What is this far beyond a kink is on its other side. Less says nothing, so that rounding about 0
 * makes no steps. */
static const double BEYOND = 1e-6;

/* What the operation's branch is due to be, by the values of all. */
static double due_branch(const vs_compiled_program *p, const vs_program_op *op, const double *v) {
  const double a = v[op->a], over = op->kind <= MAXIMUM ? a - v[op->b] : a;
  int k = 1;
  switch (op->kind) {
  case COMPARE:
    return compare(op->c, a, v[op->b]);
  case ROUND:
    return op->of(a);
  case SIGN:
    return (a > 0) - (a < 0);
  case STEP:
    return a > 0;
  case CHOICE:
    return a != 0;
  case LINE:
    while (k + 1 < op->c && p->op[op->b + 2 * k].value < a) k++;
    for (int end = k - 1; end <= k; end++)
      if (fabs(a - p->op[op->b + 2 * end].value) <= BEYOND) return op->value;
    return k;
  default:
    return over > BEYOND ? 1 : over < -BEYOND ? -1 : op->value;
  }
}

/* Branches are taken from the first operation to the last, so that what a later one chooses by is
 * known. With each the operations that count are others. */
bool vs_program_choose(vs_compiled_program *p, const double *y, bool only_ask) {
  bool other = false;
  for (int n = 0; p->chooses && n < p->n_decides; n++) {
    vs_program_op *op = &p->op[p->decides[n]];
    take_forward(p, p->decides[n], y);
    if (!is_branch(op)) continue;
    const double due = due_branch(p, op, p->value);
    if (due == op->value || isnan(due)) continue;
    const bool holds = op->kind >= COMPARE;
    other = other || holds || op->value != 0; /* a kink's first side is none that is left */
    if (only_ask && (holds || op->value != 0)) return true;
    if (only_ask) continue;
    op->value = due;
    if (!holds) continue;
    find_live(p);
    n = -1;
  }
  return other;
}
