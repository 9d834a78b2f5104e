/* SPDX-License-Identifier: GPL-3.0-or-later
 * Formulas: the first byte chooses a circuit's words or a machine's. What is read is then used in
 * all ways that the program has, and what these promise each other is held to. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "plant/b_source.h"
#include "plant/derivative.h"
#include "plant/dimension.h"
#include "targets.h"

enum { WORDS = 8 }; /* terms, and names, that there are */

typedef struct words {
  char terms[WORDS][64], names[WORDS][64];
  int n_terms, n_names;
} words;

static int index_of(char list[WORDS][64], int *count, const char *word) {
  for (int k = 0; k < *count; k++)
    if (!strncmp(list[k], word, 63)) return k;
  if (*count == WORDS) return -1;
  snprintf(list[*count], 64, "%.63s", word);
  return (*count)++;
}

static int term(void *ctx, const char *at, const vs_formula_term *t) {
  words *w = ctx;
  char text[64];
  (void)at;
  FUZZ_HOLDS(t->quantity == 'v' || t->quantity == 'i');
  snprintf(text, sizeof text, "%c%.30s,%.30s", t->quantity, t->first, t->second);
  return index_of(w->terms, &w->n_terms, text);
}

static int name(void *ctx, const char *at, const char *word) {
  words *w = ctx;
  (void)at;
  return index_of(w->names, &w->n_names, word);
}

/* Of a machine: x, y and z are terms. */
static int named_term(void *ctx, const char *word) {
  words *w = ctx;
  if (strlen(word) != 1 || *word < 'x' || *word > 'z') return -1;
  return index_of(w->terms, &w->n_terms, word);
}

static const double VALUES[WORDS] = {1, -2.5, 0, 1e-3, 47e-9, 440, 3, 1e9};

static bool same(double a, double b) {
  return a == b || (isnan(a) && isnan(b));
}

/* What the terms and names are, for all texts. */
static struct {
  bool made;
  vs_dimension terms[WORDS], names[WORDS];
  vs_jet jets[WORDS];
} known;

static void make_known(void) {
  if (known.made) return;
  known.made = true;
  for (int k = 0; k < WORDS; k++) {
    known.terms[k] = vs_dimension_of(k % 2 ? "A" : "V");
    known.names[k] = vs_dimension_of(k % 2 ? "" : "N/m");
    known.jets[k] = (vs_jet){{VALUES[k], 1, 0}};
  }
}

static void find_units(const vs_formula *f) {
  vs_dimension found;
  vs_dimension_fault fault;
  char unit[VS_DIMENSION_TEXT];
  if (vs_dimension_find(f, known.terms, known.names, &found, &fault)) {
    vs_dimension_text(&found, unit);
    FUZZ_HOLDS(strlen(unit) < sizeof unit);
  } else
    FUZZ_HOLDS(*fault.why && fault.at >= 0);
}

static void use(vs_formula *f, bool derive) {
  static const char *const NODES[WORDS] = {"v(a)", "v(b)", "v(c)", "v(d)",
                                           "i(a)", "i(b)", "i(c)", "i(d)"};
  const double other[WORDS] = {-1, 2, 0.5, 7, -1e-9, 0, 4, -3};
  vs_text text = {0};
  vs_formula slope = {0};
  double both[2], factor;
  int of;
  find_units(f);
  vs_formula_bind(f, VALUES);
  double value = vs_formula_value(f, VALUES);
  vs_formula_pair(f, VALUES, other, both);
  FUZZ_HOLDS(same(both[0], value) && same(both[1], vs_formula_value(f, other)));
  FUZZ_HOLDS(same(vs_derivative_along(f, known.jets).d[0], value));
  if (vs_formula_is_term(f, &of, &factor)) FUZZ_HOLDS(of >= 0 && of < WORDS);
  vs_b_source_formula(&text, f, NODES);
  vs_text_free(&text);
  if (derive && vs_derivative_to(f, 0, &slope)) vs_formula_value(&slope, VALUES);
  vs_formula_free(&slope);
  vs_formula_fold(f);
  FUZZ_HOLDS(same(vs_formula_value(f, VALUES), value));
}

static void take(const char *text, size_t size) {
  make_known();
  bool machine = size && (*text & 1);
  words w = {.n_terms = 0};
  const vs_formula_scope scope = {.ctx = &w,
                                  .term = machine ? NULL : term,
                                  .name = name,
                                  .of_machine = machine,
                                  .named_term = machine ? named_term : NULL};
  const char *begin = text + (size > 0), *bad = begin, *end;
  char why[200] = "";
  vs_formula f = {0};
  end = vs_formula_read(begin, &scope, &f, &bad, why, sizeof why);
  FUZZ_HOLDS(end ? end >= begin && end <= text + size : *why && bad >= begin && bad <= text + size);
  if (end) use(&f, size % 4 == 0); /* a derivative takes ten times as long as the rest */
  vs_formula_free(&f);
}

const fuzz_target fuzz_formula = {"formula", take, NULL, NULL};
