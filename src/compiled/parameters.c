/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "parameters.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "netlist/numbers.h"

/* ---- functions ---- */

static double sign(double x) {
  return (x > 0) - (x < 0);
}
static double square(double x) {
  return x * x;
}
static double unit_step(double x) {
  return x > 0;
}
static double ramp(double x) {
  return x > 0 ? x : 0;
}
static double saturate(double x) {
  return fmin(fmax(x, 0), 1);
}
/* ngspice takes the size of x for x^y and pow(x,y). */
static double power(double x, double y) {
  return pow(fabs(x), y);
}
static double sign_power(double x, double y) {
  return copysign(pow(fabs(x), y), x) * (x != 0 || y <= 0);
}

static const struct of_one {
  const char *name;
  vs_parameters_of_one *of;
} OF_ONE[] = {
    {"abs", fabs},    {"sqrt", sqrt},  {"exp", exp},        {"ln", log},       {"log", log},
    {"log10", log10}, {"sgn", sign},   {"sin", sin},        {"cos", cos},      {"tan", tan},
    {"asin", asin},   {"acos", acos},  {"atan", atan},      {"arctan", atan},  {"sinh", sinh},
    {"cosh", cosh},   {"tanh", tanh},  {"asinh", asinh},    {"acosh", acosh},  {"atanh", atanh},
    {"floor", floor}, {"ceil", ceil},  {"nint", nearbyint}, {"int", trunc},    {"sqr", square},
    {"u", unit_step}, {"uramp", ramp}, {"u2", saturate},    {"stp", unit_step}};
static const struct of_two {
  const char *name;
  vs_parameters_of_two *of;
} OF_TWO[] = {{"min", fmin}, {"max", fmax}, {"pow", power}, {"pwr", sign_power}},
  OF_TWO_PSPICE[] = {
      {"min", fmin}, {"max", fmax}, {"pow", power}, {"pwr", power}, {"pwrs", sign_power}};
enum {
  TWO = sizeof OF_TWO / sizeof *OF_TWO,
  TWO_PSPICE = sizeof OF_TWO_PSPICE / sizeof *OF_TWO_PSPICE
};

vs_parameters_of_one *vs_parameters_function(vs_word name) {
  for (size_t k = 0; k < sizeof OF_ONE / sizeof *OF_ONE; k++)
    if (vs_words_is(name, OF_ONE[k].name)) return OF_ONE[k].of;
  return NULL;
}

/* In PSpice's dialect ngspice has pwr(x,y) as |x|^y, and pwrs(x,y) with the sign of x. */
vs_parameters_of_two *vs_parameters_function_2(const vs_parameters *in, vs_word name) {
  while (in->caller) in = in->caller;
  const struct of_two *of = in->pspice ? OF_TWO_PSPICE : OF_TWO;
  for (size_t k = 0; k < (in->pspice ? TWO_PSPICE : TWO); k++)
    if (vs_words_is(name, of[k].name)) return of[k].of;
  return NULL;
}

bool vs_parameters_operate(vs_word op, double x, double y, double *value) {
  switch (op.n == 2 ? *op.at + 256 * op.at[1] : *op.at) {
  case '+':
    *value = x + y;
    return true;
  case '-':
    *value = x - y;
    return true;
  case '*':
    *value = x * y;
    return true;
  case '/':
    *value = x / y;
    return true;
  case '^':
  case '*' + 256 * '*':
    *value = power(x, y);
    return true;
  case '<':
    *value = x < y;
    return true;
  case '>':
    *value = x > y;
    return true;
  case '<' + 256 * '=':
    *value = x <= y;
    return true;
  case '>' + 256 * '=':
    *value = x >= y;
    return true;
  case '=' + 256 * '=':
    *value = x == y;
    return true;
  case '!' + 256 * '=':
  case '<' + 256 * '>':
    *value = x != y;
    return true;
  case '&':
  case '&' + 256 * '&':
    *value = x != 0 && y != 0;
    return true;
  case '|':
  case '|' + 256 * '|':
    *value = x != 0 || y != 0;
    return true;
  default:
    return false;
  }
}

/* ---- names ---- */

static vs_status value_of_name(const vs_cards *c, vs_parameters *in, vs_word name, double *value,
                               vs_error *err);

/* The text that gives a parameter of this instance its value, and the instance in which that is to
 * be read; no bytes: it has no such parameter. */
static vs_word given_to(const vs_cards *c, vs_parameters *in, vs_word name, vs_parameters **reads) {
  const vs_netlist_definition *d = vs_cards_find(c, in->in.scope, VS_CARDS_PARAM, name);
  *reads = in;
  if (in->in.card && d && c->card[d->card].kind == VS_CARDS_SUBCKT) {
    char own[128];
    snprintf(own, sizeof own, "%.*s", (int)name.n, name.at);
    vs_word given = vs_cards_value(c, in->in.card, own);
    if (given.n) {
      *reads = in->caller;
      return given;
    }
  }
  return d ? d->body : (vs_word){name.at, 0};
}

static vs_parameter_value *find_known(vs_parameters *in, vs_word name) {
  for (size_t k = 0; k < in->count; k++)
    if (!vs_words_compare(in->known[k].name, name)) return &in->known[k];
  return NULL;
}

/* A parameter that names itself, as in "r={r}", means the one further out. */
static vs_status value_of_name(const vs_cards *c, vs_parameters *in, vs_word name, double *value,
                               vs_error *err) {
  for (; in; in = in->caller) {
    vs_parameter_value *known = find_known(in, name);
    if (known && !known->known) continue;
    if (known) {
      *value = known->value;
      return VS_OK;
    }
    vs_parameters *reads;
    const vs_word text = given_to(c, in, name, &reads);
    if (!text.n) continue;
    const size_t at = in->count;
    in->known = vs_alloc_grow(in->known, in->count, sizeof *in->known);
    in->known[in->count++] = (vs_parameter_value){.name = name};
    vs_status status = vs_parameters_of(c, reads, text, value, err);
    if (status) return status;
    in->known[at].value = *value;
    in->known[at].known = true;
    return VS_OK;
  }
  if (vs_words_is(name, "pi")) {
    *value = M_PI;
    return VS_OK;
  }
  return vs_fail(err, VS_INPUT, "'%.*s' is no parameter", (int)name.n, name.at);
}

/* ---- trees ---- */

static vs_status value_of_call(const vs_cards *c, vs_parameters *in, const vs_expr *e, size_t node,
                               const vs_binding *bound, double *value, vs_error *err);

vs_status vs_parameters_of_tree(const vs_cards *c, vs_parameters *in, const vs_expr *e, size_t node,
                                const vs_binding *bound, double *value, vs_error *err) {
  const vs_expr_node *n = &e->node[node];
  double x = 0, y = 0;
  vs_status status = VS_OK;
  switch (n->kind) {
  case VS_EXPR_NUMBER:
    if (vs_numbers_read(n->word, value)) return VS_OK;
    break;
  case VS_EXPR_NAME:
    for (const vs_binding *b = bound; b; b = b->next)
      if (!vs_words_compare(b->name, n->word)) {
        *value = b->value;
        return VS_OK;
      }
    return value_of_name(c, in, n->word, value, err);
  case VS_EXPR_BRACKET:
    if (n->child) return vs_parameters_of_tree(c, in, e, n->child, bound, value, err);
    break;
  case VS_EXPR_SIGN:
    status = vs_parameters_of_tree(c, in, e, n->child, bound, &x, err);
    *value = *n->word.at == '-' ? -x : *n->word.at == '!' ? x == 0 : x;
    return status;
  case VS_EXPR_OPERATOR:
    status = vs_parameters_of_tree(c, in, e, n->child, bound, &x, err);
    if (!status) status = vs_parameters_of_tree(c, in, e, e->node[n->child].next, bound, &y, err);
    if (status) return status;
    if (vs_parameters_operate(n->word, x, y, value)) return VS_OK;
    break;
  case VS_EXPR_CHOICE:
    status = vs_parameters_of_tree(c, in, e, n->child, bound, &x, err);
    if (status) return status;
    node = e->node[n->child].next;
    return vs_parameters_of_tree(c, in, e, x != 0 ? node : e->node[node].next, bound, value, err);
  case VS_EXPR_CALL:
    return value_of_call(c, in, e, node, bound, value, err);
  default:
    break;
  }
  return vs_fail(err, VS_INPUT, "'%.*s' is no number here", (int)n->whole.n, n->whole.at);
}

/* Calls the function of a .func with these values. */
static vs_status value_of_function(const vs_cards *c, vs_parameters *in,
                                   const vs_netlist_definition *d, const double *given,
                                   size_t count, double *value, vs_error *err) {
  vs_binding own[VS_WORDS_MOST];
  char text[1024];
  snprintf(text, sizeof text, "(%.*s)", (int)d->arguments.n, d->arguments.at);
  vs_word names[VS_WORDS_MOST];
  const char *end;
  if (vs_words_arguments(text, names, &end) != count)
    return vs_fail(err, VS_INPUT, "'%.*s' has another number of arguments", (int)d->name.n,
                   d->name.at);
  for (size_t k = 0; k < count; k++)
    own[k] = (vs_binding){names[k], given[k], k ? &own[k - 1] : NULL};
  vs_expr body;
  vs_expr_read(&body, d->body);
  vs_status status = vs_parameters_of_tree(c, in, &body, body.node[0].child,
                                           count ? &own[count - 1] : NULL, value, err);
  vs_expr_free(&body);
  return status;
}

static vs_status value_of_call(const vs_cards *c, vs_parameters *in, const vs_expr *e, size_t node,
                               const vs_binding *bound, double *value, vs_error *err) {
  const vs_expr_node *n = &e->node[node];
  double given[VS_WORDS_MOST];
  size_t count = 0;
  vs_status status = VS_OK;
  for (size_t k = n->child; k && count < VS_WORDS_MOST && !status; k = e->node[k].next)
    status = vs_parameters_of_tree(c, in, e, k, bound, &given[count++], err);
  if (status) return status;
  for (vs_parameters *at = in; at; at = at->caller) {
    const vs_netlist_definition *d = vs_cards_resolve(c, at->in.scope, VS_CARDS_FUNC, n->word);
    if (d) return value_of_function(c, in, d, given, count, value, err);
  }
  vs_parameters_of_one *one = vs_parameters_function(n->word);
  vs_parameters_of_two *two = vs_parameters_function_2(in, n->word);
  if (one && count == 1) {
    *value = one(given[0]);
  } else if (two && count == 2) {
    *value = two(given[0], given[1]);
  } else if (count == 3 && (vs_words_is(n->word, "if") || vs_words_is(n->word, "ternary_fcn"))) {
    *value = given[0] != 0 ? given[1] : given[2];
  } else if (count == 3 && vs_words_is(n->word, "limit")) {
    *value = fmin(fmax(given[0], fmin(given[1], given[2])), fmax(given[1], given[2]));
  } else {
    return vs_fail(err, VS_INPUT, "the function '%.*s' with %zu values is not known",
                   (int)n->word.n, n->word.at, count);
  }
  return VS_OK;
}

vs_status vs_parameters_of(const vs_cards *c, vs_parameters *in, vs_word text, double *value,
                           vs_error *err) {
  if (vs_numbers_read(text, value)) return VS_OK;
  vs_expr e;
  vs_expr_read(&e, text);
  vs_status status = e.whole ? vs_parameters_of_tree(c, in, &e, e.node[0].child, NULL, value, err)
                             : vs_fail(err, VS_INPUT, "'%.*s' is no number", (int)text.n, text.at);
  vs_expr_free(&e);
  return status;
}

void vs_parameters_free(vs_parameters *in) {
  free(in->known);
  in->known = NULL;
  in->count = 0;
}
