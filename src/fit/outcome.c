/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/outcome.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

/* Two searches came to the same minimum where their chi2 differ by less, or by less than this share
 * of it. */
static const double SAME = 1e-3;

static void count_starts(vs_outcome *o) {
  const vs_descents *all = &o->descents;
  double least = all->item[all->best].chi2, same = SAME * fmax(1, least);
  o->next_chi2 = NAN;
  for (size_t k = 0; k < all->count; k++) {
    const vs_descent *found = &all->item[k];
    if (!found->converged) continue;
    o->converged++;
    if (found->chi2 < least + same)
      o->reached++;
    else if (!(found->chi2 > o->next_chi2))
      o->next_chi2 = found->chi2;
  }
}

/* A profile during which the budget is spent counts as not made: an end of it would look open. */
static vs_status follow_profiles(vs_descender *d, vs_outcome *o, vs_error *err) {
  vs_budget *budget = &o->prediction.budget;
  o->profiles = vs_alloc(o->inquiry->n_unknowns, sizeof *o->profiles);
  for (size_t k = 0; k < o->inquiry->n_unknowns; k++) {
    if (!o->inquiry->profiled[k]) continue;
    snprintf(budget->stage, sizeof budget->stage, "profile of %.64s", o->inquiry->unknowns[k].name);
    vs_likelihood_of(d, &o->estimate, k, &o->profiles[o->n_profiles]);
    if (vs_prediction_spent(&o->prediction))
      return vs_descents_spent(d, &o->descents, budget->stage, err);
    o->n_profiles++;
  }
  return VS_OK;
}

static vs_pattern test_column(const vs_outcome *o, size_t run, size_t column) {
  const vs_inquiry_run *r = &o->inquiry->runs[run];
  double *residual = vs_alloc(r->recording.n_samples, sizeof *residual);
  size_t count = 0, first = r->datum + r->aims.count;
  for (size_t k = 0; k < r->recording.n_samples; k++)
    if ((size_t)r->recording.samples[k].column == column)
      residual[count++] = o->estimate.residual[first + k];
  vs_pattern pattern = vs_pattern_of(residual, count);
  free(residual);
  return pattern;
}

static void test_columns(vs_outcome *o) {
  size_t room = 0;
  for (size_t r = 0; r < o->inquiry->n_runs; r++)
    room += o->inquiry->runs[r].recording.columns.count;
  o->columns = vs_alloc(room + 1, sizeof *o->columns);
  for (size_t r = 0; r < o->inquiry->n_runs; r++)
    for (size_t c = 0; c < o->inquiry->runs[r].recording.columns.count; c++)
      o->columns[o->n_columns++] = (vs_outcome_column){r, c, test_column(o, r, c)};
}

/* Who finds the slopes during the search, and who at the minimum. */
static const vs_slopes_kind *kind_of(const vs_outcome *o, bool searching) {
  vs_slopes_word word = o->inquiry->slopes;
  bool exact = word == VS_SLOPES_EXACT || (word == VS_SLOPES_AUTO && !searching);
  return exact && vs_slopes_exact.serves(&o->prediction) ? &vs_slopes_exact
                                                         : &vs_slopes_differences;
}

/* Goes on from the minimum with the slopes that its errors are told by. */
static void settle(vs_descender *d, vs_outcome *o) {
  vs_descent *best = &o->descents.item[o->descents.best], better;
  const vs_slopes_kind *kind = kind_of(o, false);
  o->slopes = kind->name;
  if (kind == d->slopes) return;
  d->slopes = kind;
  vs_descent_from(d, best->s, &better);
  if (better.converged && better.chi2 <= best->chi2 * (1 + SAME)) *best = better;
}

/* Iterations that a fit may take, in each of which every run is made with each unknown at four
 * values (fit/slopes.c) and once more: for each start, of which one more is for the minimum's own
 * slopes; and for each profile. Among the fits that come with the program and those of the tests a
 * start took 41 at most and a profile 135: six times as many are a search that gets nowhere. */
enum { FOR_A_START = 250, FOR_A_PROFILE = 800, VALUES = 4 };

static double runs_for(const vs_inquiry *q) {
  double iterations = FOR_A_START * ((double)q->starts + 1);
  for (size_t k = 0; k < q->n_unknowns; k++)
    if (q->profiled[k]) iterations += FOR_A_PROFILE;
  return iterations * (1 + VALUES * (double)q->n_unknowns);
}

/* Finds the minimum and what it tells. */
static vs_status find(vs_descender *d, vs_outcome *o, vs_error *err) {
  vs_budget *budget = &o->prediction.budget;
  d->slopes = kind_of(o, true);
  vs_status status = vs_descents_search(d, &o->descents, err);
  if (status) return status;
  snprintf(budget->stage, sizeof budget->stage, "slopes at the minimum");
  settle(d, o);
  status = vs_estimate_at(d, &o->descents.item[o->descents.best], &o->estimate, err);
  if (vs_prediction_spent(&o->prediction))
    status = vs_descents_spent(d, &o->descents, budget->stage, err);
  if (status) return status;
  d->slopes = kind_of(o, true);
  count_starts(o);
  o->told = true;
  test_columns(o);
  return follow_profiles(d, o, err);
}

vs_status vs_outcome_of(const vs_inquiry *q, vs_outcome *o, vs_error *err) {
  *o = (vs_outcome){.inquiry = q};
  o->prediction = vs_prediction_of(q);
  vs_descender d = {.prediction = &o->prediction};
  vs_prediction_limit(&o->prediction, runs_for(q));
  vs_status status = find(&d, o, err);
  vs_prediction_unlimit(&o->prediction);
  return status;
}

void vs_outcome_free(vs_outcome *o) {
  vs_descents_free(&o->descents);
  vs_estimate_free(&o->estimate);
  free(o->profiles);
  free(o->columns);
  *o = (vs_outcome){0};
}
