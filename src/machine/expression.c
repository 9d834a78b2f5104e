/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "machine/expression.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "syntax/units.h"

vs_where vs_expression_place(const vs_expression *e, const char *at) {
  vs_where where = e->where;
  if (at && where.line > 0) where.column += vs_text_column(e->text, at) - 1;
  return where;
}

/* ---- names ---- */

enum { MOST_WORDS = VS_MACHINE_NAMES + VS_MACHINE_TERM_Q + 3 * VS_MACHINE_COORDINATES };

typedef struct reader {
  const vs_machine *machine;
  vs_expression *expression;
  vs_expression_kind kind;
  const char *what;
  vs_status status; /* of the names so far */
  vs_error *err;
} reader;

/* The words that stand for terms: word, and the term's number. Returns how many there are. */
static int term_words(const reader *r, const char *words[MOST_WORDS], int terms[MOST_WORDS]) {
  static const char *const LAW[] = {"lambda", "z"};
  static const char *const PROBE[] = {[VS_MACHINE_TERM_Z] = "z",
                                      [VS_MACHINE_TERM_LAMBDA] = "lambda",
                                      [VS_MACHINE_TERM_I] = "i",
                                      [VS_MACHINE_TERM_FORCE] = "force"};
  const vs_machine *m = r->machine;
  int n = 0;
  if (r->kind == VS_EXPRESSION_CONSTANT) return 0;
  if (r->kind != VS_EXPRESSION_PROBE) {
    for (int k = 0; k < 2; k++, n++) words[n] = LAW[k], terms[n] = k;
    return n;
  }
  for (int k = 0; k < 4; k++, n++) words[n] = PROBE[k], terms[n] = k;
  for (int k = 0; k < m->dof; k++) {
    const vs_coordinate *c = &m->coordinates[k];
    const char *const own[] = {c->name, c->rate, c->rate2};
    for (int d = 0; d < 3; d++, n++)
      words[n] = own[d], terms[n] = VS_MACHINE_TERM_Q + d * m->dof + k;
  }
  return n;
}

/* True where the file has a let of that name which is not read yet. */
static bool stands_below(const vs_machine *m, const char *name) {
  const vs_node *lets = vs_tree_child(m->tree.root, "let");
  for (const vs_node *n = lets ? lets->child : NULL; n; n = n->next)
    if (n->key && !strcasecmp(n->key, name)) return true;
  return false;
}

static vs_status unknown_name(const reader *r, const char *at, const char *name) {
  const vs_machine *m = r->machine;
  const char *words[2 * MOST_WORDS];
  int terms[MOST_WORDS], n = term_words(r, words, terms);
  vs_where where = vs_expression_place(r->expression, at);
  if (stands_below(m, name))
    return vs_fail_at(r->err, where, "%s: let '%s' is not read yet; a let names those above it",
                      r->what, name);
  if (r->kind == VS_EXPRESSION_CONSTANT && (!strcmp(name, "lambda") || !strcmp(name, "z")))
    return vs_fail_at(r->err, where, "%s: %s is known to the formulas under actuator and probes",
                      r->what, name);
  for (int k = 0; k < m->n_names; k++) words[n++] = m->names[k].name;
  const char *nearest = vs_text_nearest(name, words, (size_t)n);
  return vs_fail_at(r->err, where, "%s: no parameter or let '%s'%s%s%s", r->what, name,
                    nearest ? "; did you mean '" : "", nearest ? nearest : "", nearest ? "'?" : "");
}

static int find_term(void *ctx, const char *at, const vs_formula_term *term) {
  reader *r = ctx;
  if (!r->status)
    r->status = vs_fail_at(r->err, vs_expression_place(r->expression, at),
                           "%s: %c(...) is of circuits; a machine has names alone", r->what,
                           term->quantity);
  return 0;
}

/* A let of lambda and z may be named where these may be. */
static vs_status check_use(const reader *r, const char *at, int name) {
  const vs_machine *m = r->machine;
  if (name < m->n_parameters || !m->lets[name - m->n_parameters].of_gap) return VS_OK;
  if (r->kind == VS_EXPRESSION_LET || r->kind == VS_EXPRESSION_LAW) return VS_OK;
  return vs_fail_at(r->err, vs_expression_place(r->expression, at),
                    "%s: let '%s' is made of lambda or z; it is for the formulas under actuator",
                    r->what, m->names[name].name);
}

static int find_name(void *ctx, const char *at, const char *name) {
  reader *r = ctx;
  const char *words[MOST_WORDS];
  int terms[MOST_WORDS], n = term_words(r, words, terms);
  for (int k = 0; k < n; k++)
    if (!strcasecmp(words[k], name)) {
      r->expression->of_gap = true;
      return VS_FORMULA_TERMS + terms[k];
    }
  for (int k = 0; k < r->machine->n_names; k++)
    if (!strcasecmp(r->machine->names[k].name, name)) {
      if (!r->status) r->status = check_use(r, at, k);
      return k;
    }
  if (!r->status) r->status = unknown_name(r, at, name);
  return 0;
}

/* ---- reading ---- */

/* A number with a unit, which stands behind a blank: "20 kN/m" is 20000. A formula never looks so.
 */
static bool is_quantity(const char *text, double *si) {
  char *end, why[8];
  double value = strtod(text, &end);
  if (end == text || !isfinite(value) || *end != ' ') return false;
  end += strspn(end, " ");
  if (!isalpha((unsigned char)*end) && (unsigned char)*end < 0x80) return false;
  return vs_units_known(end) && vs_units_read(text, end, si, why, sizeof why);
}

/* Puts the lets that are made of lambda and z in the places of their names. */
static vs_status put_lets_in(const reader *r) {
  const vs_machine *m = r->machine;
  vs_expression *e = r->expression;
  for (int k = m->n_names - m->n_parameters; k-- > 0;) {
    bool named = false;
    for (size_t n = 0; n < e->of.count && !named; n++)
      named = vs_formula_name_of(&e->of.ops[n]) == m->n_parameters + k;
    if (!named || !m->lets[k].of_gap) continue;
    e->of_gap = true;
    if (!vs_formula_put_in(&e->of, m->n_parameters + k, &m->lets[k].of))
      return vs_fail_at(r->err, e->where, "%s: too long a formula, with its lets", r->what);
  }
  return VS_OK;
}

static vs_status read_formula(reader *r) {
  vs_expression *e = r->expression;
  char why[200] = "an operator or the end of the formula is wanted here";
  const char *bad = NULL;
  const vs_formula_scope scope = {r, find_term, find_name};
  const char *end = vs_formula_read(e->text, &scope, &e->of, &bad, why, sizeof why);
  if (end) end += strspn(end, " \t\n");
  if (r->status) return r->status;
  if (!end || *end)
    return vs_fail_at(r->err, vs_expression_place(e, end ? end : bad), "%s: %s%s", r->what, why,
                      strchr(e->text, '(') && !strchr(e->text, ')')
                          ? "; inside [ ] or { } a formula with a comma stands in quotes"
                          : "");
  return put_lets_in(r);
}

vs_status vs_expression_read(const vs_machine *machine, const vs_node *node,
                             vs_expression_kind kind, const char *what, vs_expression *out,
                             vs_error *err) {
  reader r = {machine, out, kind, what, VS_OK, err};
  char number[VS_NUMBER_SIZE];
  double si;
  *out = (vs_expression){.where = node->where};
  if (node->kind != VS_NODE_TEXT || !*node->text)
    return vs_fail_at(err, node->where, "%s: a formula or a number is wanted", what);
  out->text = node->text;
  if (!is_quantity(out->text, &si)) {
    vs_status status = read_formula(&r);
    if (status) vs_formula_free(&out->of);
    return status;
  }
  const char *bad = NULL, *sign = signbit(si) ? "-" : "";
  snprintf(number, sizeof number, "%s%.17g", sign, fabs(si));
  const vs_formula_scope scope = {&r, find_term, find_name};
  vs_formula_read(number, &scope, &out->of, &bad, (char[8]){0}, 8);
  return VS_OK;
}

vs_status vs_expression_value(vs_expression *e, const double values[VS_MACHINE_NAMES],
                              const char *what, double *value, vs_error *err) {
  *value = 0;
  if (!e->text) return VS_OK;
  vs_formula_bind(&e->of, values);
  *value = vs_formula_value(&e->of, NULL);
  return isfinite(*value)
             ? VS_OK
             : vs_fail_at(err, e->where, "%s: the value is not finite (%g) with these parameters",
                          what, *value);
}
