/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "import/values.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/cursor.h"
#include "base/formula.h"
#include "base/text.h"
#include "netlist/numbers.h"
#include "netlist/reserved.h"
#include "netlist/words.h"

/* ---- numbers ---- */

/* True where the text has a number such as 0x10, which C reads and SPICE does not. */
static bool has_hexadecimal(const char *text) {
  for (const char *s = text; (s = strpbrk(s, "xX")); s++) {
    bool word = s > text + 1 && (isalnum((unsigned char)s[-2]) || strchr("_.", s[-2]));
    if (s > text && s[-1] == '0' && !word && isxdigit((unsigned char)s[1])) return true;
  }
  return false;
}

bool vs_values_number(const vs_values *v, const char *text, double *number) {
  char *end;
  text += strspn(text, " \t");
  if (!*text || !strchr("+-.0123456789", *text) || has_hexadecimal(text)) return false;
  *number = vs_text_to_number(text, &end);
  if (end == text || !isfinite(*number)) return false;
  bool whole = !memchr(text, '.', (size_t)(end - text));
  size_t length;
  double factor = vs_numbers_factor(end, &length);
  end += length;
  if (isdigit((unsigned char)*end)) { /* 4k7 */
    char fraction[32];
    size_t n = strspn(end, "0123456789");
    if (!v->rkm || factor == 1 || !whole || n > 20) return false;
    snprintf(fraction, sizeof fraction, "0.%.*s", (int)n, end);
    *number += copysign(strtod(fraction, NULL), *number);
    end += n;
  }
  *number *= factor;
  while (isalpha((unsigned char)*end) || *end == '%') end++;
  if (!strncmp(end, "\xce\xa9", 2)) end += 2;     /* Greek capital omega */
  if (!strncmp(end, "\xe2\x84\xa6", 3)) end += 3; /* sign of the ohm */
  end += strspn(end, " \t");
  return !*end;
}

/* ---- functions: lines .func outside of subcircuits ---- */

/* A call of a function: its definition, and the arguments of both. */
typedef struct call {
  const vs_netlist_definition *of;
  vs_word own[VS_WORDS_MOST], given[VS_WORDS_MOST];
  size_t count;
  const char *behind; /* the text behind the closing bracket */
} call;

/* False where no function is called at s, or with another number of arguments. */
static bool read_call(const vs_listing *l, const char *s, size_t n, call *c) {
  const char *open = s + n + strspn(s + n, " \t"), *end;
  if (!n || *open != '(') return false;
  c->count = vs_words_arguments(open, c->given, &c->behind);
  for (size_t k = 0; k < l->netlist.n_definitions && c->count; k++) {
    c->of = &l->netlist.definition[k];
    if (c->of->kind != VS_CARDS_FUNC || l->cards[c->of->card].depth > 0) continue;
    if (vs_words_compare(c->of->name, (vs_word){s, n})) continue;
    return vs_words_arguments(c->of->arguments.at - 1, c->own, &end) == c->count &&
           !c->own[0].n == !c->given[0].n;
  }
  return false;
}

static size_t name_length(const char *s) {
  size_t n = 0;
  while (!isdigit((unsigned char)*s) && vs_words_goes_on(s[n])) n++;
  return n;
}

/* Adds the body of a function, with the arguments of a call in brackets. */
static void add_body(const call *c, vs_text *out) {
  vs_text_add(out, "(");
  for (const char *s = c->of->body.at; s < c->of->body.at + c->of->body.n;) {
    const size_t n = name_length(s);
    size_t which = 0;
    while (which < c->count && vs_words_compare((vs_word){s, n}, c->own[which])) which++;
    if (n && which < c->count)
      vs_text_add(out, "(%.*s)", (int)c->given[which].n, c->given[which].at);
    else if (n)
      vs_text_add(out, "%.*s", (int)n, s);
    else if (!strchr("'\"=", *s))
      vs_text_add(out, "%c", *s == '{' ? '(' : *s == '}' ? ')' : *s);
    s += n ? n : 1;
  }
  vs_text_add(out, ")");
}

/* Replaces the calls in a text once, without looking into the replacements; true: there was one. */
static bool expand_once(const vs_listing *l, const char *text, vs_text *out) {
  bool any = false;
  call c;
  vs_text_add(out, "%s", "");
  for (const char *s = text; *s;) {
    const size_t digits = strspn(s, "0123456789."); /* a number's letters are no name */
    const size_t n = digits + name_length(s + digits);
    const bool is = !digits && read_call(l, s, n, &c);
    if (is)
      add_body(&c, out);
    else
      vs_text_add(out, "%.*s", n ? (int)n : 1, s);
    s = is ? c.behind : s + (n ? n : 1);
    any = any || is;
  }
  return any;
}

/* A copy of an expression in which each call of a function is replaced by its body. A call that
 * does not fit its function stays. */
static char *expand(const vs_listing *l, const char *expression) {
  enum { NESTED_CALLS = 20 }; /* which ends a function that calls itself */
  char *text = vs_copy(expression);
  bool any = l != NULL;
  for (int k = 0; any && k < NESTED_CALLS && strlen(text) <= 4096; k++) {
    vs_text out = {0};
    any = expand_once(l, text, &out);
    free(text);
    text = out.text;
  }
  return text;
}

/* ---- expressions ---- */

/* Most names in an expression, and most parameters nested in one another: each level takes some
 * kilobytes of the stack or the heap. */
enum { NAMES = 64, NESTED = 200 };

/* The names that an expression uses, in the order of their indices. */
typedef struct names {
  char name[NAMES][VS_VALUES_NAME];
  size_t count;
} names;

static int take_name(void *ctx, const char *at, const char *name) {
  names *n = ctx;
  (void)at;
  for (size_t k = 0; k < n->count; k++)
    if (!strcmp(n->name[k], name)) return (int)k;
  if (n->count == NAMES) return -1;
  snprintf(n->name[n->count], VS_VALUES_NAME, "%s", name);
  return (int)n->count++;
}

const vs_value_param *vs_values_find(const vs_values *v, const char *name) {
  size_t k;
  return vs_names_find(&v->names, name, strlen(name), &k) ? &v->item[k] : NULL;
}

static bool evaluate(const vs_values *v, const char *text, int level, double *value);

/* Evaluates a parameter, once. One that depends on itself is not known. */
static void settle(const vs_values *v, vs_value_param *p, int level) {
  if (p->tried) return;
  p->tried = true;
  p->known = evaluate(v, p->text, level, &p->value);
}

static bool value_of_name(const vs_values *v, const char *name, int level, double *value) {
  size_t k;
  *value = vs_reserved_constant(name);
  if (!vs_names_find(&v->names, name, strlen(name), &k)) return !isnan(*value);
  settle(v, &v->item[k], level + 1);
  *value = v->item[k].value;
  return v->item[k].known;
}

/* A copy of the expression without its quotes, and with brackets for braces. */
static char *bare(const char *text) {
  vs_text t = {0};
  vs_text_add(&t, "%s", "");
  for (; *text; text++)
    if (!strchr("'\"", *text))
      vs_text_add(&t, "%c", *text == '{' ? '(' : *text == '}' ? ')' : *text);
  return t.text;
}

/* Replaces `**` by '^'. */
static void tame_powers(char *text) {
  char *to = text;
  for (const char *s = text; *s; s++)
    if (s[0] == '*' && s[1] == '*')
      *to++ = '^', s++;
    else
      *to++ = *s;
  *to = '\0';
}

static bool evaluate(const vs_values *v, const char *text, int level, double *value) {
  if (has_hexadecimal(text)) return false;
  if (vs_values_number(v, text, value)) return true;
  if (level > NESTED) return false;
  names *n = vs_alloc(1, sizeof *n);
  double known[NAMES] = {0};
  char why[200], *plain = bare(text), *expression = expand(v->listing, plain);
  free(plain);
  tame_powers(expression);
  const char *bad = NULL;
  const vs_formula_scope scope = {.ctx = n, .name = take_name};
  vs_formula formula = {0};
  const char *end = vs_formula_read(expression, &scope, &formula, &bad, why, sizeof why);
  bool good = end && !end[strspn(end, " \t")];
  for (size_t k = 0; k < n->count && good; k++)
    good = value_of_name(v, n->name[k], level, &known[k]);
  if (good) {
    vs_formula_bind(&formula, known);
    *value = vs_formula_value(&formula, NULL);
    good = isfinite(*value);
  }
  vs_formula_free(&formula);
  free(expression);
  free(n);
  return good;
}

bool vs_values_of(const vs_values *v, const char *text, double *value) {
  return evaluate(v, text, 0, value);
}

/* ---- .param ---- */

void vs_values_read(vs_values *v, const vs_listing *l) {
  const vs_cards *c = &l->netlist;
  v->listing = l;
  v->rkm = l->origin == VS_ORIGIN_LTSPICE || l->origin == VS_ORIGIN_KICAD;
  for (size_t k = 0; k < c->n_definitions; k++) {
    const vs_netlist_definition *d = &c->definition[k];
    if (c->card[d->card].kind != VS_CARDS_PARAM || d->kind != VS_CARDS_PARAM) continue;
    if (l->cards[d->card].depth || !d->body.n) continue;
    v->item = vs_alloc_grow(v->item, v->count, sizeof *v->item);
    vs_value_param *p = &v->item[v->count];
    *p = (vs_value_param){.card = d->card, .text = vs_alloc_part(d->body.at, d->body.n)};
    snprintf(p->name, sizeof p->name, "%.*s", (int)d->name.n, d->name.at);
    vs_cursor_lower(p->name);
    vs_names_put(&v->names, p->name, v->count++); /* the last one counts */
  }
  for (size_t k = 0; k < v->count; k++) {
    vs_value_param *p = &v->item[k];
    double value;
    p->number = vs_values_number(v, p->text, &value);
    settle(v, p, 0);
  }
}

void vs_values_free(vs_values *v) {
  for (size_t k = 0; k < v->count; k++) free(v->item[k].text);
  free(v->item);
  vs_names_free(&v->names);
  *v = (vs_values){0};
}
