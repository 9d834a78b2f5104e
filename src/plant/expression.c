/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "expression.h"
#include "base/text.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- names ---- */

enum { MOST_TERMS = VS_MACHINE_TERM_Q + 3 * VS_MACHINE_COORDINATES };

/* A word that stands for a term. */
typedef struct word {
  const char *name, *unit; /* unit NULL: there is no such term */
} word;

typedef struct reader {
  const vs_machine *machine;
  const vs_expression_use *use;
  vs_expression *expression;
  word terms[MOST_TERMS]; /* by the term's number */
  vs_status status;       /* of the names so far */
  vs_error *err;
} reader;

static void know_terms(reader *r) {
  static const word LAW[] = {{"lambda", "Wb"}, {"z", "m"}};
  static const word PROBE[] = {[VS_MACHINE_TERM_Z] = {"z", "m"},
                               [VS_MACHINE_TERM_LAMBDA] = {"lambda", "Wb"},
                               [VS_MACHINE_TERM_I] = {"i", "A"},
                               [VS_MACHINE_TERM_FORCE] = {"force", "N"}};
  const vs_machine *m = r->machine;
  if (r->use->kind == VS_EXPRESSION_CONSTANT) return;
  if (r->use->kind == VS_EXPRESSION_MOTION) {
    for (int k = 0; k < m->dof; k++)
      r->terms[k] = (word){m->coordinates[k].name, m->coordinates[k].unit};
    return;
  }
  if (r->use->kind != VS_EXPRESSION_PROBE) {
    memcpy(r->terms, LAW, sizeof LAW);
    return;
  }
  memcpy(r->terms, PROBE, sizeof PROBE);
  for (int k = 0; k < m->dof; k++) {
    const vs_coordinate *c = &m->coordinates[k];
    word *first = &r->terms[VS_MACHINE_TERM_Q + k];
    first[0] = (word){c->name, c->unit};
    first[m->dof] = (word){c->rate, c->rate_unit};
    first[2 * m->dof] = (word){c->rate2, c->rate2_unit};
  }
}

static int named_term(void *ctx, const char *name) {
  reader *r = ctx;
  for (int k = 0; k < MOST_TERMS; k++)
    if (r->terms[k].unit && !strcmp(r->terms[k].name, name)) {
      r->expression->of_gap = true;
      return k;
    }
  return -1;
}

static int find_name(const vs_machine *m, const char *name) {
  for (int k = 0; k < m->n_names; k++)
    if (!strcmp(m->names[k].name, name)) return k;
  return -1;
}

/* The let of that index among the names, where it is made of lambda or z; NULL: it is not. */
static const vs_expression *let_of_gap(const vs_machine *m, int name) {
  const vs_expression *let = name < m->n_parameters ? NULL : &m->lets[name - m->n_parameters];
  return let && let->of_gap ? let : NULL;
}

/* A let of lambda and z takes the place of its name, where these may be named. */
static const vs_formula *named_formula(void *ctx, const char *name) {
  reader *r = ctx;
  const vs_expression *let = let_of_gap(r->machine, find_name(r->machine, name));
  if (!let || (r->use->kind != VS_EXPRESSION_LET && r->use->kind != VS_EXPRESSION_LAW)) return NULL;
  r->expression->of_gap = true;
  return &let->of;
}

static vs_where place_in_expression(const vs_expression *e, const char *at) {
  vs_where where = e->where;
  if (where.line > 0) where.column += vs_text_column(e->text, at) - 1;
  return where;
}

/* True where the file has a let of that name which is not read yet. */
static bool stands_below(const vs_machine *m, const char *name) {
  return vs_tree_child(vs_tree_child(m->tree.root, "let"), name) != NULL;
}

static vs_status unknown_name(const reader *r, const char *at, const char *name) {
  const vs_machine *m = r->machine;
  const char *names[MOST_TERMS + VS_MACHINE_NAMES], *what = r->use->what;
  size_t n = 0;
  vs_where where = place_in_expression(r->expression, at);
  if (stands_below(m, name))
    return vs_fail_at(r->err, where, "%s: let '%s' is not read yet; a let names those above it",
                      what, name);
  if (r->use->kind == VS_EXPRESSION_CONSTANT && (!strcmp(name, "lambda") || !strcmp(name, "z")))
    return vs_fail_at(r->err, where, "%s: %s is known to the formulas under actuator and probes",
                      what, name);
  for (int k = 0; k < MOST_TERMS; k++)
    if (r->terms[k].unit) names[n++] = r->terms[k].name;
  for (int k = 0; k < m->n_names; k++) names[n++] = m->names[k].name;
  return vs_fail_at(r->err, where, "%s: no parameter or let '%s'%s", what, name,
                    vs_text_hint(name, names, n, "").text);
}

static int take_name(void *ctx, const char *at, const char *name) {
  reader *r = ctx;
  int k = find_name(r->machine, name);
  if (r->status) return 0;
  if (k < 0)
    r->status = unknown_name(r, at, name);
  else if (let_of_gap(r->machine, k))
    r->status = vs_fail_at(
        r->err, place_in_expression(r->expression, at),
        "%s: let '%s' is made of lambda or z; it is for the formulas under actuator alone",
        r->use->what, name);
  return k < 0 ? 0 : k;
}

/* ---- units ---- */

static vs_status check_units(const reader *r) {
  vs_dimension terms[MOST_TERMS], names[VS_MACHINE_NAMES];
  vs_dimension_fault fault;
  vs_expression *e = r->expression;
  for (int k = 0; k < MOST_TERMS; k++) terms[k] = vs_dimension_of(r->terms[k].unit);
  for (int k = 0; k < r->machine->n_names; k++) names[k] = r->machine->names[k].dimension;
  if (!vs_dimension_find(&e->of, terms, names, &e->dimension, &fault))
    return vs_fail_at(r->err, place_in_expression(e, e->text + fault.at), "%s: %s", r->use->what,
                      fault.why);
  return VS_OK;
}

static vs_status check_wanted(const reader *r) {
  char found[VS_DIMENSION_TEXT], wanted[VS_DIMENSION_TEXT];
  const vs_expression *e = r->expression;
  if (!r->use->wanted || vs_dimension_fits(&e->dimension, r->use->wanted)) return VS_OK;
  vs_dimension_text(&e->dimension, found);
  vs_dimension_text(r->use->wanted, wanted);
  return vs_fail_at(r->err, e->where, "%s: the formula is in %s; wanted: %s", r->use->what, found,
                    wanted);
}

/* ---- reading ---- */

/* A number with a unit, which stands behind a blank: "20 kN/m" is 20000. No formula looks like
 * this. Returns the unit; NULL: it is none. */
static const char *unit_of_quantity(const char *text, double *si) {
  char *end, why[200];
  double value = vs_text_to_number(text, &end);
  if (end == text || !isfinite(value) || *end != ' ') return NULL;
  end += strspn(end, " ");
  if (!isalpha((unsigned char)*end) && (unsigned char)*end < 0x80) return NULL;
  return vs_units_known(end) && vs_units_read(text, end, si, why, sizeof why) ? end : NULL;
}

/* Parses the text into r->expression. An error of a name, which the callbacks left in r->status,
 * comes before one of the grammar; `why` begins as what is wrong where text is left over. */
static vs_status parse_expression(reader *r, const char *text) {
  vs_expression *e = r->expression;
  char why[200] = "an operator or the end of the formula is wanted here";
  const char *bad = NULL;
  const vs_formula_scope scope = {.ctx = r,
                                  .name = take_name,
                                  .of_machine = true,
                                  .named_term = named_term,
                                  .named_formula = named_formula};
  const char *end = vs_formula_read(text, &scope, &e->of, &bad, why, sizeof why);
  if (end) end += strspn(end, " \t\n");
  if (r->status) return r->status;
  return end && !*end ? VS_OK
                      : vs_fail_at(r->err, place_in_expression(e, end ? end : bad), "%s: %s",
                                   r->use->what, why);
}

vs_status vs_expression_read(const vs_machine *machine, const vs_node *node,
                             const vs_expression_use *use, vs_expression *out, vs_error *err) {
  reader r = {.machine = machine, .use = use, .expression = out, .err = err};
  char number[VS_NUMBER_SIZE];
  double si = 0;
  *out = (vs_expression){.where = node->where};
  if (node->kind != VS_NODE_TEXT || !*node->text)
    return vs_fail_at(err, node->where, "%s: a formula or a number is wanted", use->what);
  out->text = node->text;
  know_terms(&r);
  const char *unit = unit_of_quantity(node->text, &si);
  snprintf(number, sizeof number, "%.17g", si);
  vs_status status = parse_expression(&r, unit ? number : node->text);
  if (!status && !unit) status = check_units(&r);
  if (unit) out->dimension = vs_dimension_of(unit);
  if (!status) status = check_wanted(&r);
  if (!status) return VS_OK;
  vs_formula_free(&out->of);
  *out = (vs_expression){0};
  return status;
}

bool vs_expression_value(vs_expression *e, const double values[VS_MACHINE_NAMES], double *value) {
  *value = 0;
  if (!e->text) return true;
  vs_formula_bind(&e->of, values);
  *value = vs_formula_value(&e->of, NULL);
  return isfinite(*value);
}
