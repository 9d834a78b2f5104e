/* SPDX-License-Identifier: GPL-3.0-or-later
 * How a grammar changes a text: line by line and word by word. */
#include <stdio.h>
#include <string.h>

#include "target.h"

/* A text of limited size that is being written. */
typedef struct draft {
  char *text;
  size_t size, most;
} draft;

/* Numbers at random, by xorshift (Marsaglia 2003). */
static unsigned next(unsigned *seed) {
  unsigned x = *seed ? *seed : 2463534242u;
  x ^= x << 13, x ^= x >> 17, x ^= x << 5;
  return *seed = x;
}
static size_t below(unsigned *seed, size_t count) {
  return next(seed) % count;
}

static void put(draft *d, char c) {
  if (d->size < d->most) d->text[d->size++] = c;
}

enum {
  DEPTH = 8
}; /* rules within rules; deeper ones take their first form, which is a plain one */

static const fuzz_rule *rule_of(const fuzz_grammar *g, char name) {
  for (size_t k = 0; k < g->count; k++)
    if (g->rules[k].name == name) return &g->rules[k];
  return NULL;
}

static void expand(const fuzz_grammar *g, char name, unsigned *seed, int depth, draft *d) {
  const fuzz_rule *rule = rule_of(g, name);
  size_t count = 0;
  FUZZ_HOLDS(rule);
  while (rule->forms[count]) count++;
  for (const char *s = rule->forms[depth < DEPTH ? below(seed, count) : 0]; *s; s++)
    if (*s != '@')
      put(d, *s);
    else if (*++s == '@')
      put(d, '@');
    else if (depth < 2 * DEPTH)
      expand(g, *s, seed, depth + 1, d);
}

/* Makes size bytes of room at `at`, or takes -size bytes away there. False: there is no room. */
static bool shift(draft *d, size_t at, long by) {
  if (by > 0 && d->size + (size_t)by > d->most) return false;
  size_t from = by < 0 ? at + (size_t)-by : at, to = by < 0 ? at : at + (size_t)by;
  memmove(d->text + to, d->text + from, d->size - from);
  d->size = d->size - from + to;
  return true;
}

static void insert(draft *d, size_t at, const char *text, size_t size) {
  if (shift(d, at, (long)size)) memcpy(d->text + at, text, size);
}

/* The begin of a line chosen at random; *end is behind its line break. */
static size_t line_at(const draft *d, unsigned *seed, size_t *end) {
  size_t at = d->size ? below(seed, d->size) : 0;
  while (at && d->text[at - 1] != '\n') at--;
  const char *stop = memchr(d->text + at, '\n', d->size - at);
  *end = stop ? (size_t)(stop - d->text) + 1 : d->size;
  return at;
}

static bool is_word(char c) {
  return (c >= '0' && c <= '9') || ((c | 32) >= 'a' && (c | 32) <= 'z') || c == '_' || c == '.';
}

/* A word chosen at random, or nothing where none is near. */
static size_t word_at(const draft *d, unsigned *seed, size_t *end) {
  size_t at = d->size ? below(seed, d->size) : 0;
  while (at < d->size && !is_word(d->text[at])) at++;
  while (at && is_word(d->text[at - 1])) at--;
  for (*end = at; *end < d->size && is_word(d->text[*end]);) ++*end;
  return at;
}

enum { PIECE = 2048 };

/* Puts what the rule makes in the place of text[at..end). */
static void replace(const fuzz_grammar *g, draft *d, size_t at, size_t end, char rule,
                    unsigned *seed) {
  char piece[PIECE];
  draft made = {piece, 0, sizeof piece};
  expand(g, rule, seed, 0, &made);
  if (rule != 'W') put(&made, '\n');
  shift(d, at, -(long)(end - at));
  insert(d, at, made.text, made.size);
}

static void change_line(const fuzz_grammar *g, draft *d, unsigned *seed) {
  size_t end, at = line_at(d, seed, &end), to, length = end - at;
  char line[PIECE];
  if (length > sizeof line) length = sizeof line;
  memcpy(line, d->text + at, length);
  switch (below(seed, 4)) {
  case 0: /* one more of the grammar's */
    replace(g, d, at, at, 'L', seed);
    break;
  case 1: /* in its place */
    replace(g, d, at, end, 'L', seed);
    break;
  case 2: /* moved */
    shift(d, at, -(long)(end - at));
    at = line_at(d, seed, &to);
    insert(d, at, line, length);
    break;
  default: /* doubled elsewhere */
    to = line_at(d, seed, &end);
    insert(d, to, line, length);
  }
}

static void change_word(const fuzz_grammar *g, draft *d, unsigned *seed) {
  size_t end, at = word_at(d, seed, &end), from, stop;
  char word[64];
  switch (below(seed, 4)) {
  case 0: /* another of the text's own */
    from = word_at(d, seed, &stop);
    if (stop - from > sizeof word) return;
    memcpy(word, d->text + from, stop - from);
    shift(d, at, -(long)(end - at));
    insert(d, at, word, stop - from);
    break;
  case 1: /* none */
    shift(d, at, -(long)(end - at));
    break;
  default:
    replace(g, d, at, end, 'W', seed);
  }
}

size_t fuzz_grammar_change(const fuzz_grammar *g, char *text, size_t size, size_t most,
                           unsigned seed) {
  draft d = {text, size, most};
  next(&seed);
  for (size_t k = 1 + below(&seed, 4); k; k--) {
    size_t end, at;
    switch (below(&seed, 8)) {
    case 0: /* a line less */
      at = line_at(&d, &seed, &end);
      shift(&d, at, -(long)(end - at));
      break;
    case 1: /* another file begins */
      at = line_at(&d, &seed, &end);
      if (!below(&seed, 4)) replace(g, &d, at, at, 'F', &seed);
      break;
    case 2:
    case 3:
    case 4:
      change_line(g, &d, &seed);
      break;
    default:
      change_word(g, &d, &seed);
    }
  }
  return d.size;
}
