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
#include "macros.h"
#include "netlist/numbers.h"
#include "netlist/reserved.h"

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
  char why[200], *plain = bare(text), *expression = vs_macros_expand(v->listing, plain);
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

static void add_param(vs_values *v, const char *name, size_t name_size, const char *text,
                      size_t size, size_t card) {
  v->item = vs_alloc_grow(v->item, v->count, sizeof *v->item);
  vs_value_param *p = &v->item[v->count];
  *p = (vs_value_param){.card = card, .text = vs_alloc(size + 1, 1)};
  memcpy(p->text, text, size);
  snprintf(p->name, sizeof p->name, "%.*s", (int)name_size, name);
  vs_cursor_lower(p->name);
  vs_names_put(&v->names, p->name, v->count++); /* the last one counts */
}

static bool is_name(char c) {
  return isalnum((unsigned char)c) || c == '_';
}

/* True where "NAME =" begins at `s`. */
static bool begins_assignment(const char *s) {
  size_t n = 0;
  if (!isalpha((unsigned char)*s) && *s != '_') return false;
  while (is_name(s[n])) n++;
  n += strspn(s + n, " \t");
  return s[n] == '=' && s[n + 1] != '=';
}

/* The end of the value that begins at `s`: before the next assignment, outside of brackets. */
static const char *end_of_value(const char *s) {
  int depth = 0;
  bool quoted = false;
  for (; *s; s++) {
    if (*s == '\'') quoted = !quoted;
    depth += (*s == '{' || *s == '(') - (*s == '}' || *s == ')');
    if (depth > 0 || quoted || !strchr(" \t,", *s)) continue;
    if (begins_assignment(s + strspn(s, " \t,"))) break;
  }
  return s;
}

static void read_line(vs_values *v, const vs_listing *l, size_t card) {
  const char *s = l->cards[card].text + strcspn(l->cards[card].text, " \t");
  while (*(s += strspn(s, " \t,"))) {
    const char *name = s;
    while (is_name(*s)) s++;
    size_t n = (size_t)(s - name);
    s += strspn(s, " \t=");
    const char *end = end_of_value(s), *last = end;
    while (last > s && strchr(" \t", last[-1])) last--;
    if (n == 0 || last == s) return; /* ngspice will refuse it */
    add_param(v, name, n, s, (size_t)(last - s), card);
    s = end;
  }
}

void vs_values_read(vs_values *v, const vs_listing *l) {
  v->listing = l;
  v->rkm = l->origin == VS_ORIGIN_LTSPICE || l->origin == VS_ORIGIN_KICAD;
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *card = &l->cards[k];
    if (card->depth == 0 && (vs_listing_is(card, ".param") || vs_listing_is(card, ".params") ||
                             vs_listing_is(card, ".parameters")))
      read_line(v, l, k);
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
