/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "macros.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "base/text.h"

enum { ARGUMENTS = 12, NESTED = 20 };

/* A piece of a text. */
typedef struct piece {
  const char *at;
  size_t n;
} piece;

/* A function's definition, or a call of one. */
typedef struct call {
  piece name, argument[ARGUMENTS];
  int count;
  const char *behind; /* the text after the closing bracket */
} call;

static size_t name_length(const char *s) {
  size_t n = 0;
  if (!isalpha((unsigned char)*s) && *s != '_') return 0;
  while (isalnum((unsigned char)s[n]) || s[n] == '_') n++;
  return n;
}

static bool is_same(piece a, piece b) {
  return a.n == b.n && !strncasecmp(a.at, b.at, a.n);
}

/* A piece without the blanks at its ends. */
static piece trimmed(const char *begin, const char *end) {
  while (begin < end && strchr(" \t", *begin)) begin++;
  while (end > begin && strchr(" \t", end[-1])) end--;
  return (piece){begin, (size_t)(end - begin)};
}

/* Reads NAME(a, b) at `s`; false: there is none, or it has too many arguments. */
static bool read_call(const char *s, call *c) {
  int depth = 0;
  *c = (call){.name = {s, name_length(s)}};
  const char *open = s + c->name.n + strspn(s + c->name.n, " \t"), *begin = open + 1;
  if (!c->name.n || *open != '(') return false;
  for (s = open; *s; s++) {
    depth += (strchr("({", *s) != NULL) - (strchr(")}", *s) != NULL);
    if (depth > 1 || (depth == 1 && *s != ',')) continue;
    if (c->count == ARGUMENTS) return false;
    c->argument[c->count++] = trimmed(begin, s);
    begin = s + 1;
    if (depth == 0) break;
  }
  if (c->count == 1 && c->argument[0].n == 0) c->count = 0;
  c->behind = *s ? s + 1 : s;
  return *s == ')';
}

/* Finds the function of a call, and its body. */
static bool find_function(const vs_listing *l, const call *c, call *function, piece *body) {
  for (size_t k = 0; k < l->count; k++) {
    const vs_card *card = &l->cards[k];
    if (card->depth > 0 || !vs_listing_is(card, ".func")) continue;
    const char *s = card->text + strlen(".func");
    s += strspn(s, " \t");
    if (!read_call(s, function) || !is_same(function->name, c->name)) continue;
    s = function->behind + strspn(function->behind, " \t=");
    const char *end = s + strlen(s);
    *body = trimmed(s, end);
    return function->count == c->count;
  }
  return false;
}

/* Adds the body of a function, with the arguments of a call in brackets. */
static void add_body(const call *c, const call *function, piece body, vs_text *out) {
  vs_text_add(out, "(");
  for (const char *s = body.at; s < body.at + body.n;) {
    piece word = {s, name_length(s)};
    int which = 0;
    while (which < c->count && !is_same(word, function->argument[which])) which++;
    if (word.n && which < c->count)
      vs_text_add(out, "(%.*s)", (int)c->argument[which].n, c->argument[which].at);
    else if (word.n)
      vs_text_add(out, "%.*s", (int)word.n, s);
    else if (!strchr("'\"", *s))
      vs_text_add(out, "%c", *s == '{' ? '(' : *s == '}' ? ')' : *s);
    s += word.n ? word.n : 1;
  }
  vs_text_add(out, ")");
}

/* Replaces the calls in a text once, without looking into the replacements; true: there was one. */
static bool expand_once(const vs_listing *l, const char *text, vs_text *out) {
  bool any = false;
  vs_text_add(out, "%s", "");
  for (const char *s = text; *s;) {
    call c, function;
    piece body;
    size_t n = strspn(s, "0123456789."); /* a number's letters are no name */
    n = n ? n + name_length(s + n) : name_length(s);
    if (read_call(s, &c) && find_function(l, &c, &function, &body)) {
      add_body(&c, &function, body, out);
      s = c.behind;
      any = true;
    } else {
      vs_text_add(out, "%.*s", n ? (int)n : 1, s);
      s += n ? n : 1;
    }
  }
  return any;
}

char *vs_macros_expand(const vs_listing *l, const char *expression) {
  char *text = vs_copy(expression);
  bool any = l != NULL;
  for (int k = 0; any && k < NESTED; k++) { /* which ends a function that calls itself */
    vs_text out = {0};
    if (strlen(text) > 4096) break;
    any = expand_once(l, text, &out);
    free(text);
    text = out.text;
  }
  return text;
}
