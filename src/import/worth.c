/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "worth.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/formula.h"
#include "netlist/reserved.h"

/* What all functions here read from. */
typedef struct reader {
  const vs_elements *wiring;
  const vs_values *values;
} reader;

/* Only numbers a formula's names and terms. */
static int any_name(void *ctx, const char *at, const char *name) {
  (void)at;
  (void)name;
  return (*(int *)ctx)++;
}

static bool is_formula(const char *text) {
  int count = 0;
  char why[200];
  const char *bad = NULL;
  const vs_formula_scope scope = {.ctx = &count, .name = any_name};
  vs_formula formula = {0};
  const char *end = vs_formula_read(text, &scope, &formula, &bad, why, sizeof why);
  vs_formula_free(&formula);
  return end && !*end;
}

/* Writes an expression in terms of the deck's parameters alone; other parameters are replaced by
 * what they stand for. */
static void expand(const reader *p, const char *text, int level, vs_text *out) {
  vs_text_add(out, "(");
  for (const char *s = text; *s;) {
    char name[VS_VALUES_NAME];
    size_t n = strspn(s, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789.");
    snprintf(name, sizeof name, "%.*s", (int)n, s);
    const vs_value_param *v = n ? vs_values_find(p->values, name) : NULL;
    bool other = v && level < 20 && (!v->number || p->wiring->listing->cards[v->card].included);
    if (other)
      expand(p, v->text, level + 1, out);
    else if (n)
      vs_text_add(out, "%.*s", (int)n, s);
    else if (!strchr("'\"", *s))
      vs_text_add(out, "%c", *s == '{' ? '(' : *s == '}' ? ')' : *s);
    s += n ? n : 1;
  }
  vs_text_add(out, ")");
}

/* True where the element's value depends on temperature and its temperature is set. Without temp=
 * and dtemp= coefficients have no effect: a deck runs at 27 degC, which they refer to. */
static bool is_warm(const reader *p, const vs_element *e) {
  bool heats = vs_elements_sets(p->wiring, p->values, e, "tc") ||
               vs_elements_sets(p->wiring, p->values, e, "tc1") ||
               vs_elements_sets(p->wiring, p->values, e, "tc2");
  char *temp = vs_elements_option(p->wiring, e, "temp");
  bool warm = heats && (temp || vs_elements_sets(p->wiring, p->values, e, "dtemp"));
  free(temp);
  return warm;
}

/* Adds "*2" or "/2" for an option that the element has. Returns false where the option is no number
 * above 0 that is known before a run. */
static bool add_factor(const reader *p, const vs_element *e, const char *name, char sign,
                       vs_text *out) {
  double value = 1;
  char *text = vs_elements_option(p->wiring, e, name);
  bool known = !text || (vs_values_of(p->values, text, &value) && value > 0), plain = false;
  if (text && known) {
    plain = vs_values_number(p->values, text, &value);
    vs_text_add(out, "%c", sign);
    if (plain) vs_text_add(out, "%.15g", value);
    if (!plain) expand(p, text, 0, out);
  }
  free(text);
  return known;
}

/* Applies m= and scale= to the value: m resistors or inductors in parallel are less, m capacitors
 * are more. Empties the formula where the value is not known. */
static void multiply(const reader *p, const vs_element *e, vs_text *value) {
  vs_text factors = {0}, whole = {0};
  bool known = value->text && !is_warm(p, e) && add_factor(p, e, "scale", '*', &factors) &&
               add_factor(p, e, "m", e->letter == 'c' ? '*' : '/', &factors);
  if (known && factors.text) vs_text_add(&whole, "(%s%s)", value->text, factors.text);
  vs_text_free(&factors);
  if (known && !whole.text) return;
  vs_text_free(value);
  *value = whole;
}

/* Adds a parameter with the element's value, a number, and its name as a formula. */
static void add_param(const vs_element *e, double number, vs_declared *sheet,
                      char param[VS_ELEMENTS_NAME], vs_text *formula) {
  static const char *const WHAT[] = {"resistor", "capacitor", "inductor"};
  char wanted[VS_DECK_NAME], text[VS_DECK_TEXT];
  bool taken = vs_deck_is_standard(e->key) || vs_reserved_is(e->key, false);
  snprintf(wanted, sizeof wanted, "%.50s%s", e->key, taken ? "_value" : "");
  vs_declared_name(sheet, wanted, param);
  size_t before = sheet->counts[VS_DECLARED_PARAM];
  snprintf(text, sizeof text, "%s %s", WHAT[strchr("rcl", e->letter) - "rcl"], e->name);
  vs_declared_param(sheet, param, e->letter, number, text);
  if (sheet->counts[VS_DECLARED_PARAM] == before) *param = '\0'; /* no room: it stays */
  if (*param)
    vs_text_add(formula, "{%s}", param);
  else
    vs_text_add(formula, "%.15g", number);
}

/* Adds an expression, or the name of a deck's parameter if it is just that. */
static void add_expression(const reader *p, const char *word, vs_text *formula) {
  char name[VS_VALUES_NAME];
  size_t n = strcspn(word + 1, "}");
  snprintf(name, sizeof name, "%.*s", *word == '{' && n < sizeof name ? (int)n : 0, word + 1);
  const vs_value_param *v = vs_values_find(p->values, name);
  if (v && v->number && !p->wiring->listing->cards[v->card].included)
    vs_text_add(formula, "{%s}", v->name);
  else
    expand(p, word, 0, formula);
}

char *vs_worth_make(const vs_elements *w, const vs_values *v, const vs_element *e,
                    vs_declared *sheet, char param[VS_ELEMENTS_NAME]) {
  const reader p = {w, v};
  char *word = vs_elements_word_of(w, e, e->n_nodes + 1);
  double value;
  vs_text formula = {0};
  /* ngspice does not see the model after "{r1}", so that the netlist's number stays there */
  if (vs_elements_has_model(w, e))
    *param = '\0';
  else if (vs_values_number(v, word, &value) && value > 0)
    add_param(e, value, sheet, param, &formula);
  else if (vs_values_of(v, word, &value) && value > 0)
    add_expression(&p, word, &formula);
  multiply(&p, e, &formula);
  free(word);
  if (formula.text && is_formula(formula.text)) return formula.text;
  vs_text_free(&formula);
  return NULL;
}
