/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "netlist/expr.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* What is left of a text that is read. */
typedef struct reading {
  vs_expr *e;
  const char *at, *end;
  int depth; /* of what is within each other */
} reading;

/* Each level takes some hundred bytes of the stack. What lies deeper is passed by. */
enum { DEEPEST = 1000 };

/* ---- words ---- */

static void skip_blanks(reading *r) {
  while (r->at < r->end && strchr(" \t", *r->at)) r->at++;
}

/* The next character; '\0' at the end. */
static char here(const reading *r) {
  return r->at < r->end ? *r->at : '\0';
}

static bool begins_name(char c) {
  return isalpha((unsigned char)c) || c == '_';
}

/* The number at the place, with its unit. */
static vs_word number_here(const reading *r) {
  const char *s = r->at;
  while (s < r->end && (isdigit((unsigned char)*s) || *s == '.')) s++;
  if (s + 1 < r->end && strchr("eE", *s) && strchr("+-", s[1])) s += 2;
  while (s < r->end && (vs_words_goes_on(*s) || *s == '.')) s++;
  return (vs_word){r->at, (size_t)(s - r->at)};
}

static vs_word name_here(const reading *r) {
  const char *s = r->at;
  while (s < r->end && vs_words_goes_on(*s)) s++;
  return (vs_word){r->at, (size_t)(s - r->at)};
}

/* Operators of two operands, and how tightly they bind. */
static const struct binary {
  const char *sign;
  int binds;
} OPERATORS[] = {{"||", 2}, {"&&", 3}, {"==", 4}, {"!=", 4}, {"<>", 4}, {"<=", 5}, {">=", 5},
                 {"**", 9}, {"|", 2},  {"&", 3},  {"<", 5},  {">", 5},  {"+", 6},  {"-", 6},
                 {"*", 7},  {"/", 7},  {"%", 7},  {"\\", 7}, {"^", 9}};
enum { CHOICE = 1, SIGNS = 8 };

static const struct binary *operator_here(const reading *r) {
  for (size_t k = 0; k < sizeof OPERATORS / sizeof *OPERATORS; k++) {
    const size_t n = strlen(OPERATORS[k].sign);
    if ((size_t)(r->end - r->at) >= n && !memcmp(r->at, OPERATORS[k].sign, n)) return &OPERATORS[k];
  }
  return NULL;
}

/* ---- trees ---- */

static size_t add_node(reading *r, int kind, vs_word word, size_t child) {
  vs_expr *e = r->e;
  e->node = vs_alloc_grow(e->node, e->count, sizeof *e->node);
  e->node[e->count] = (vs_expr_node){kind, word, word, child, 0};
  return e->count++;
}

/* Says that a node's text goes from there up to what is read so far. */
static size_t end_node(reading *r, size_t node, const char *from) {
  r->e->node[node].whole = (vs_word){from, (size_t)(r->at - from)};
  return node;
}

static size_t read_operation(reading *r, int binds);

/* Reads what stands in a bracket, up to that sign and behind it: parts with commas between them.
 * Returns the first. */
static size_t read_parts(reading *r, char close, bool signals) {
  size_t first = 0, last = 0;
  for (;;) {
    skip_blanks(r);
    if (r->at >= r->end || *r->at == close) break;
    const char *from = r->at;
    size_t part = 0;
    if (signals) {
      while (r->at < r->end && !strchr(" \t,)", *r->at)) r->at++;
      if (r->at > from)
        part = add_node(r, VS_EXPR_SIGNAL, (vs_word){from, (size_t)(r->at - from)}, 0);
    } else
      part = read_operation(r, CHOICE);
    if (part && last) r->e->node[last].next = part;
    if (part) last = part;
    first = first ? first : part;
    skip_blanks(r);
    if (here(r) == ',')
      r->at++;
    else if (r->at < r->end && *r->at != close) {
      r->e->whole = r->e->whole && signals;
      r->at += r->at == from; /* passed by */
    }
  }
  r->e->whole = r->e->whole && r->at < r->end;
  r->at += r->at < r->end;
  return first;
}

static size_t read_call(reading *r, vs_word name) {
  const bool signals = vs_words_is(name, "v") || vs_words_is(name, "i");
  const size_t call = add_node(r, VS_EXPR_CALL, name, 0);
  r->at++;
  const size_t child = read_parts(r, ')', signals);
  r->e->node[call].child = child;
  return end_node(r, call, name.at);
}

static size_t read_bracket(reading *r, const char *from) {
  const size_t bracket = add_node(r, VS_EXPR_BRACKET, (vs_word){from, 1}, 0);
  r->at++;
  const size_t child = read_parts(r, *from == '(' ? ')' : *from == '{' ? '}' : *from, false);
  r->e->node[bracket].child = child;
  return end_node(r, bracket, from);
}

/* A value with the signs before it. 0: there is none. */
static size_t read_value(reading *r) {
  skip_blanks(r);
  const char *from = r->at;
  const char c = here(r);
  if (c && strchr("+-!~", c)) {
    r->at++;
    const size_t of = read_operation(r, SIGNS);
    const size_t sign = add_node(r, VS_EXPR_SIGN, (vs_word){from, 1}, of);
    r->e->whole = r->e->whole && of;
    return end_node(r, sign, from);
  }
  if (c && strchr("({'", c)) return read_bracket(r, from);
  if (c == '"') {
    const char *close = memchr(from + 1, '"', (size_t)(r->end - from - 1));
    r->at = close ? close + 1 : r->end;
    r->e->whole = r->e->whole && close;
    return add_node(r, VS_EXPR_TEXT, (vs_word){from, (size_t)(r->at - from)}, 0);
  }
  if (isdigit((unsigned char)c) ||
      (c == '.' && from + 1 < r->end && isdigit((unsigned char)from[1]))) {
    const vs_word number = number_here(r);
    r->at += number.n;
    return add_node(r, VS_EXPR_NUMBER, number, 0);
  }
  if (!begins_name(c)) return 0;
  const vs_word name = name_here(r);
  r->at += name.n;
  skip_blanks(r);
  if (here(r) == '(') return read_call(r, name);
  r->at = name.at + name.n;
  return add_node(r, VS_EXPR_NAME, name, 0);
}

/* Adds `a ? b : c` behind its a. */
static size_t read_choice(reading *r, size_t a, const char *from) {
  const vs_word sign = {r->at++, 1};
  const size_t b = read_operation(r, CHOICE);
  skip_blanks(r);
  const bool colon = here(r) == ':';
  r->at += colon;
  const size_t c = colon ? read_operation(r, CHOICE) : 0;
  r->e->whole = r->e->whole && b && c;
  r->e->node[a].next = b ? b : c;
  if (b) r->e->node[b].next = c;
  return end_node(r, add_node(r, VS_EXPR_CHOICE, sign, a), from);
}

/* A value and all that is bound to it at least so tightly. 0: there is none. */
static size_t read_operation(reading *r, int binds) {
  if (r->depth == DEEPEST) return 0;
  r->depth++;
  size_t a = read_value(r);
  const char *from = a ? r->e->node[a].whole.at : r->at;
  while (a) {
    skip_blanks(r);
    if (here(r) == '?' && binds <= CHOICE) {
      a = read_choice(r, a, from);
      continue;
    }
    const struct binary *op = operator_here(r);
    if (!op || op->binds < binds) break;
    const vs_word sign = {r->at, strlen(op->sign)};
    r->at += sign.n;
    const size_t b = read_operation(r, op->binds + 1);
    r->e->node[a].next = b;
    r->e->whole = r->e->whole && b;
    a = end_node(r, add_node(r, VS_EXPR_OPERATOR, sign, a), from);
  }
  if (a) r->at = r->e->node[a].whole.at + r->e->node[a].whole.n;
  r->depth--;
  return a;
}

void vs_expr_read(vs_expr *e, vs_word text) {
  reading r = {.e = e, .at = text.at, .end = text.at + text.n};
  *e = (vs_expr){.whole = true};
  add_node(&r, VS_EXPR_BRACKET, (vs_word){text.at, 0}, 0);
  e->node[0].whole = text;
  for (size_t last = 0; skip_blanks(&r), r.at < r.end;) {
    const char *from = r.at;
    const size_t next = read_operation(&r, CHOICE);
    if (next && last) e->node[last].next = next;
    if (next && !e->node[0].child) e->node[0].child = next;
    e->whole = e->whole && next && !last;
    last = next ? next : last;
    r.at += r.at == from; /* passed by */
  }
  e->whole = e->whole && e->node[0].child;
}

void vs_expr_free(vs_expr *e) {
  free(e->node);
  *e = (vs_expr){0};
}

void vs_expr_write(const vs_expr *e, size_t node, vs_text *out) {
  const vs_expr_node *n = &e->node[node];
  const bool call = n->kind == VS_EXPR_CALL, bracket = n->kind == VS_EXPR_BRACKET && node;
  const bool before = n->kind != VS_EXPR_OPERATOR && n->kind != VS_EXPR_CHOICE;
  if (before) vs_text_add(out, "%.*s%s", (int)n->word.n, n->word.at, call ? "(" : "");
  size_t k = 0;
  for (size_t child = n->child; child; child = e->node[child].next, k++) {
    if (k && (call || bracket)) vs_text_add(out, ",");
    if (k && !before)
      vs_text_add(out, " %.*s ", k > 1 ? 1 : (int)n->word.n, k > 1 ? ":" : n->word.at);
    vs_expr_write(e, child, out);
  }
  if (call || bracket)
    vs_text_add(out, "%c",
                call || *n->word.at == '(' ? ')'
                : *n->word.at == '{'       ? '}'
                                           : *n->word.at);
}
