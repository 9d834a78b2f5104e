/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "lint/couplings.h"

#include <ctype.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "base/alloc.h"
#include "base/disjoint_sets.h"
#include "base/text.h"
#include "netlist/numbers.h"
#include "netlist/words.h"

/* ---- one line ---- */

/* Looks at "K1 La Lb 0.9". A name with a point may be an inductor within a subcircuit. */
vs_status vs_couplings_line(const vs_cards *one, vs_error *err) {
  const vs_netlist_card *card = one->card;
  const size_t n = card->count;
  double factor;
  if (card->letter != 'k') return VS_OK;
  for (size_t k = 0; k < 2 && n > 2; k++) {
    const vs_word w = one->arguments[k].value;
    if (isalpha((unsigned char)*w.at) && tolower((unsigned char)*w.at) != 'l' &&
        !memchr(w.at, '.', w.n))
      return vs_fail_at(err, vs_line_place(one->lines, w.at),
                        "%.*s is no inductor; a K couples inductors, the names of which begin "
                        "with L",
                        (int)w.n, w.at);
  }
  if (n == 2 && strchr("lL", *one->arguments[0].value.at) &&
      strchr("lL", *one->arguments[1].value.at))
    return vs_fail_at(err, one->lines->where,
                      "%.*s has no coupling; behind its inductors a factor up to 1 is wanted",
                      (int)card->name.n, card->name.at);
  for (size_t k = 1; k + 1 < n; k++)
    for (size_t m = 0; m < k; m++) {
      const vs_word w = one->arguments[k].value;
      if (vs_words_compare(w, one->arguments[m].value)) continue;
      return vs_fail_at(err, vs_line_place(one->lines, w.at),
                        "%.*s is coupled with itself; the names of two inductors are wanted",
                        (int)w.n, w.at);
    }
  if (n < 3) return VS_OK;
  const vs_word said = one->arguments[n - 1].value;
  return vs_numbers_read(said, &factor) && (factor > 1 || factor < -1)
             ? vs_fail_at(err, vs_line_place(one->lines, said.at),
                          "a coupling of %.*s is not possible; -1 to 1 is wanted", (int)said.n,
                          said.at)
             : VS_OK;
}

/* ---- sets ---- */

/* An inductor that a K names. */
typedef struct inductor {
  vs_word name;
  size_t scope; /* that it stands in */
  size_t set;   /* the least number of its set, once that is known */
  size_t place; /* its row in the matrix of its set */
} inductor;

/* A line K. */
typedef struct coupling {
  const vs_line *line;
  const char *at; /* its factor */
  size_t end[2];  /* its inductors */
  double factor;
  bool plain; /* the factor is a number, and the line stands outside of .if */
} coupling;

typedef struct couplings {
  inductor *inductor;
  coupling *list;
  size_t inductors, count;
} couplings;

static int compare_couplings(const void *a, const void *b) {
  const inductor *x = a, *y = b;
  if (x->scope != y->scope) return x->scope < y->scope ? -1 : 1;
  return vs_words_compare(x->name, y->name);
}

/* Reads "K1 La Lb 0.9" or "K1 La Lb k=0.9". False: it is none. */
static bool read_coupling(const vs_cards *cards, size_t number, coupling *c) {
  const vs_netlist_card *card = &cards->card[number];
  if (card->letter != 'k' || card->count != 3 || card->words < 2) return false;
  const vs_word factor = cards->arguments[card->first + 2].value;
  *c = (coupling){.line = &cards->lines[number], .at = factor.at};
  c->plain = vs_numbers_read(factor, &c->factor) && !card->conditional;
  return true;
}

/* Finds all lines K, and the inductors of each. */
static void find_couplings(couplings *all, const vs_cards *cards) {
  size_t n = 0;
  for (size_t k = 0; k < cards->count; k++) {
    const vs_netlist_card *card = &cards->card[k];
    coupling c;
    if (!read_coupling(cards, k, &c)) continue;
    all->list = vs_alloc_grow(all->list, all->count, sizeof *all->list);
    all->list[all->count++] = c;
    for (size_t e = 0; e < 2; e++) {
      all->inductor = vs_alloc_grow(all->inductor, n, sizeof *all->inductor);
      all->inductor[n++] = (inductor){.name = vs_cards_word(cards, card, e), .scope = card->scope};
    }
  }
  inductor *given = vs_alloc(n + 1, sizeof *given); /* two of each K, in the order of lines */
  if (n) memcpy(given, all->inductor, n * sizeof *given);
  if (n) qsort(all->inductor, n, sizeof *all->inductor, compare_couplings);
  for (size_t k = 0; k < n; k++)
    if (!k || compare_couplings(&all->inductor[k], &all->inductor[all->inductors - 1]))
      all->inductor[all->inductors++] = all->inductor[k];
  for (size_t k = 0; k < n; k++)
    all->list[k / 2].end[k % 2] =
        (size_t)((inductor *)bsearch(&given[k], all->inductor, all->inductors, sizeof *given,
                                     compare_couplings) -
                 all->inductor);
  free(given);
}

static void find_sets(couplings *all) {
  vs_disjoint_sets sets = {0};
  for (size_t k = 0; k < all->inductors; k++) vs_disjoint_sets_add(&sets);
  for (size_t k = 0; k < all->count; k++)
    vs_disjoint_sets_join(&sets, all->list[k].end[0], all->list[k].end[1]);
  for (size_t k = 0; k < all->inductors; k++)
    all->inductor[k].set = vs_disjoint_sets_find(&sets, k);
  vs_disjoint_sets_free(&sets);
}

/* Windings without leakage, K of 1 between all, have a matrix whose least eigenvalue is 0. What
 * rounding makes of that, for the largest set, is far below this. */
static const double ROUNDING = 1e-12;

enum { MOST_IN_SET = 300 }; /* of a larger one the decomposition takes too long */

/* True where the set can give more energy than it was given. */
static bool gives_energy(const couplings *all, const coupling *const *of, size_t n_of, size_t n) {
  gsl_matrix *m = vs_checked(gsl_matrix_alloc(n, n));
  gsl_matrix_set_identity(m);
  gsl_matrix_scale(m, 1 + ROUNDING);
  for (size_t k = 0; k < n_of; k++) { /* ngspice adds up several K of one pair */
    const size_t i = all->inductor[of[k]->end[0]].place, j = all->inductor[of[k]->end[1]].place;
    *gsl_matrix_ptr(m, i, j) += of[k]->factor;
    *gsl_matrix_ptr(m, j, i) += of[k]->factor;
  }
  gsl_error_handler_t *before = gsl_set_error_handler_off();
  const bool bad = gsl_linalg_cholesky_decomp1(m) != GSL_SUCCESS;
  gsl_set_error_handler(before);
  gsl_matrix_free(m);
  return bad;
}

static vs_status refuse_set(const couplings *all, size_t set, const coupling *first,
                            vs_error *err) {
  enum { SHOWN = 6 };
  vs_text names = {0};
  size_t n = 0;
  for (size_t k = set; k < all->inductors; k++) {
    if (all->inductor[k].set != set) continue;
    if (n < SHOWN)
      vs_text_add(&names, "%s%.*s", n ? ", " : "", (int)all->inductor[k].name.n,
                  all->inductor[k].name.at);
    n++;
  }
  if (n > SHOWN) vs_text_add(&names, " and %zu more", n - SHOWN);
  vs_status status =
      vs_fail_at(err, vs_line_place_of(first->line, vs_words_at(first->at)),
                 "the couplings of %s do not fit together: their matrix is not positive definite, "
                 "and such windings give energy from nothing; a pair without a K counts as 0, and "
                 "where La-Lb and Lb-Lc are near 1, a K of La-Lc near their product is wanted",
                 names.text);
  vs_text_free(&names);
  return status;
}

/* Looks at the set of that number, whose couplings are among all those of the netlist. */
static vs_status check_set(couplings *all, size_t set, const coupling **of, size_t n_of,
                           vs_error *err) {
  size_t n = 0;
  for (size_t k = set; k < all->inductors; k++)
    if (all->inductor[k].set == set) all->inductor[k].place = n++;
  for (size_t k = 0; k < n_of; k++)
    if (!of[k]->plain) return VS_OK;
  if (n > MOST_IN_SET || n_of < 2 || !gives_energy(all, of, n_of, n)) return VS_OK;
  return refuse_set(all, set, of[0], err);
}

static int compare_sets(const void *a, const void *b, void *ctx) {
  const coupling *x = *(const coupling *const *)a, *y = *(const coupling *const *)b;
  const couplings *all = ctx;
  const size_t s = all->inductor[x->end[0]].set, t = all->inductor[y->end[0]].set;
  return s != t ? (s > t) - (s < t) : (x > y) - (x < y);
}

vs_status vs_couplings_check(const vs_cards *cards, vs_error *err) {
  couplings all = {0};
  vs_status status = VS_OK;
  find_couplings(&all, cards);
  find_sets(&all);
  const coupling **sorted = vs_alloc(all.count + 1, sizeof *sorted);
  for (size_t k = 0; k < all.count; k++) sorted[k] = &all.list[k];
  qsort_r(sorted, all.count, sizeof *sorted, compare_sets, &all);
  for (size_t k = 0, end; k < all.count && !status; k = end) {
    const size_t set = all.inductor[sorted[k]->end[0]].set;
    for (end = k; end < all.count && all.inductor[sorted[end]->end[0]].set == set;) end++;
    status = vs_error_keep(err, check_set(&all, set, sorted + k, end - k, err));
  }
  free(sorted);
  free(all.list);
  free(all.inductor);
  return status;
}
