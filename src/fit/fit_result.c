/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/fit_result.h"

#include <gsl/gsl_cdf.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fit/estimate.h"
#include "fit/minimizations.h"
#include "fit/prediction.h"
#include "jacobian.h"

/* ---- profile likelihood ---- */

/* The profile likelihood of an unknown: chi2 over its value, where all other unknowns are fitted
 * anew for each value. Its 95 % interval is where chi2 rises by no more than 3.841 above the least.
 * Where the model is not linear in the unknown, that interval is truer than the standard error. */

enum { MOST_STEPS = 24 };
/* How close to the rise of chi2 an end is found, as a share of its root, and how much lower than
 * the estimate's a chi2 must be to be another minimum's. */
static const double CLOSE = 1e-4, LOWER = 1e-3;

/* One side of a profile. */
typedef struct side {
  vs_minimizer *d;
  const vs_estimate *e;
  vs_likelihood *profile;
  size_t k;
  double near_s[VS_INQUIRY_UNKNOWNS]; /* the last point's unknowns, from which the next search
                                         starts */
} side;

/* The root of the rise of chi2 where the unknown is held at s; NaN: the search fails. */
static double rise_of_chi2(side *w, double s) {
  vs_minimization found;
  double start[VS_INQUIRY_UNKNOWNS];
  memcpy(start, w->near_s, sizeof start);
  start[w->k] = s;
  vs_minimization_from(w->d, start, &found);
  if (!found.converged) return NAN;
  memcpy(w->near_s, found.s, sizeof w->near_s);
  vs_likelihood *p = w->profile;
  double more = found.chi2 - w->e->minimum.chi2;
  if (p->count < VS_LIKELIHOOD_POINTS) p->point[p->count++] = (vs_likelihood_point){s, found.chi2};
  if (more < -LOWER * fmax(1, w->e->minimum.chi2)) p->lower_minimum = true;
  return sqrt(fmax(more, 0));
}

/* Goes from the estimate in steps until chi2 has risen by enough, then closes in: the root of the
 * rise is nearly straight over s. Returns s of the end; NaN: it is open. */
static double find_end_of_profile(side *w, double sign, double bound) {
  const double wanted = sqrt(gsl_cdf_chisq_Pinv(0.95, 1));
  double centre = w->e->minimum.s[w->k], error = w->e->error[w->k];
  double step = isnan(error) ? 0.05 : wanted * error;
  double inner = 0, inner_rise = 0, outer = NAN, outer_rise = NAN, most = fabs(bound - centre);
  memcpy(w->near_s, w->e->minimum.s, sizeof w->near_s);
  for (int n = 0; n < MOST_STEPS; n++) {
    double part = n % 4 == 3 ? 0.5 : (wanted - inner_rise) / (outer_rise - inner_rise);
    double way = isnan(outer) ? fmin(inner + step, most) : inner + (outer - inner) * part;
    double r = rise_of_chi2(w, centre + sign * way);
    if (isnan(r)) return NAN;
    if (fabs(r - wanted) < CLOSE * wanted) return centre + sign * way;
    if (r > wanted)
      outer = way, outer_rise = r;
    else if (way >= most)
      return NAN;
    else
      inner = way, inner_rise = r;
    if (isnan(outer) && n) step *= 1.5;
  }
  return NAN;
}

static int by_s(const void *a, const void *b) {
  const vs_likelihood_point *x = a, *y = b;
  return (x->s > y->s) - (x->s < y->s);
}

/* Follows the profile of the unknown on both sides of its estimate. */
static void follow_profile(vs_minimizer *d, const vs_estimate *e, size_t k, vs_likelihood *p) {
  const vs_unknown *u = &e->inquiry->unknowns[k];
  side w = {.d = d, .e = e, .profile = p, .k = k};
  *p = (vs_likelihood){.unknown = k, .count = 1, .point = {{e->minimum.s[k], e->minimum.chi2}}};
  bool held = d->held[k];
  d->held[k] = true;
  p->least = vs_unknown_value(u, find_end_of_profile(&w, -1, vs_unknown_least(u)));
  p->most = vs_unknown_value(u, find_end_of_profile(&w, 1, vs_unknown_most(u)));
  d->held[k] = held;
  qsort(p->point, p->count, sizeof *p->point, by_s);
}

/* ---- the outcome ---- */

/* Two searches came to the same minimum where their chi2 differ by less, or by less than this share
 * of it. */
static const double SAME = 1e-3;

static void count_starts(vs_fit_result *o) {
  const vs_minimizations *all = &o->descents;
  double least = all->item[all->best].chi2, same = SAME * fmax(1, least);
  o->next_chi2 = NAN;
  for (size_t k = 0; k < all->count; k++) {
    const vs_minimization *found = &all->item[k];
    if (!found->converged) continue;
    o->converged++;
    if (found->chi2 < least + same)
      o->reached++;
    else if (!(found->chi2 > o->next_chi2))
      o->next_chi2 = found->chi2;
  }
}

/* A profile during which the budget is spent counts as not made: an end of it would look open. */
static vs_status follow_profiles(vs_minimizer *d, vs_fit_result *o, vs_error *err) {
  vs_budget *budget = &o->prediction.budget;
  o->profiles = vs_alloc(o->inquiry->n_unknowns, sizeof *o->profiles);
  for (size_t k = 0; k < o->inquiry->n_unknowns; k++) {
    if (!o->inquiry->profiled[k]) continue;
    snprintf(budget->stage, sizeof budget->stage, "profile of %.64s", o->inquiry->unknowns[k].name);
    follow_profile(d, &o->estimate, k, &o->profiles[o->n_profiles]);
    if (vs_prediction_spent(&o->prediction))
      return vs_minimizations_spent(d, &o->descents, budget->stage, err);
    o->n_profiles++;
  }
  return VS_OK;
}

static vs_residual_tests test_column(const vs_fit_result *o, size_t run, size_t column) {
  const vs_fit_problem_run *r = &o->inquiry->runs[run];
  double *residual = vs_alloc(r->recording.n_samples, sizeof *residual);
  size_t count = 0, first = r->datum + r->aims.count;
  for (size_t k = 0; k < r->recording.n_samples; k++)
    if ((size_t)r->recording.samples[k].column == column)
      residual[count++] = o->estimate.residual[first + k];
  vs_residual_tests pattern = vs_residual_tests_of(residual, count);
  free(residual);
  return pattern;
}

static void test_columns(vs_fit_result *o) {
  size_t room = 0;
  for (size_t r = 0; r < o->inquiry->n_runs; r++)
    room += o->inquiry->runs[r].recording.columns.count;
  o->columns = vs_alloc(room + 1, sizeof *o->columns);
  for (size_t r = 0; r < o->inquiry->n_runs; r++)
    for (size_t c = 0; c < o->inquiry->runs[r].recording.columns.count; c++)
      o->columns[o->n_columns++] = (vs_fit_result_column){r, c, test_column(o, r, c)};
}

/* Who finds the slopes during the search, and who at the minimum. */
static const vs_jacobian_kind *kind_of_slopes(const vs_fit_result *o, bool searching) {
  vs_jacobian_word word = o->inquiry->slopes;
  bool exact = word == VS_SLOPES_EXACT || (word == VS_SLOPES_AUTO && !searching);
  return exact && vs_jacobian_exact.serves(&o->prediction) ? &vs_jacobian_exact
                                                           : &vs_jacobian_differences;
}

/* Goes on from the minimum with the slopes that its errors are told by. */
static void settle_at_minimum(vs_minimizer *d, vs_fit_result *o) {
  vs_minimization *best = &o->descents.item[o->descents.best], better;
  const vs_jacobian_kind *kind = kind_of_slopes(o, false);
  o->slopes = kind->name;
  if (kind == d->slopes) return;
  d->slopes = kind;
  vs_minimization_from(d, best->s, &better);
  if (better.converged && better.chi2 <= best->chi2 * (1 + SAME)) *best = better;
}

/* Iterations that a fit may take, in each of which every run is made with each unknown at four
 * values (fit/jacobian.c) and once more: for each start, of which one more is for the minimum's own
 * slopes; and for each profile. Among the fits that come with the program and those of the tests a
 * start took 41 at most and a profile 135: six times as many are a search that gets nowhere. */
enum { FOR_A_START = 250, FOR_A_PROFILE = 800, VALUES = 4 };

static double runs_for(const vs_fit_problem *q) {
  double iterations = FOR_A_START * ((double)q->starts + 1);
  for (size_t k = 0; k < q->n_unknowns; k++)
    if (q->profiled[k]) iterations += FOR_A_PROFILE;
  return iterations * (1 + VALUES * (double)q->n_unknowns);
}

/* Finds the minimum, from all starts; then errors, correlations and residuals at it; then the
 * profiles that are wanted. */
static vs_status find_outcome(vs_minimizer *d, vs_fit_result *o, vs_error *err) {
  vs_budget *budget = &o->prediction.budget;
  d->slopes = kind_of_slopes(o, true);
  vs_status status = vs_minimizations_search(d, &o->descents, err);
  if (status) return status;
  snprintf(budget->stage, sizeof budget->stage, "slopes at the minimum");

  /* The search may have used differences for its slopes. Errors want the exact ones where the tier
   * has them, and so the last steps to the minimum are made with these. */
  settle_at_minimum(d, o);
  status = vs_estimate_at(d, &o->descents.item[o->descents.best], &o->estimate, err);
  if (vs_prediction_spent(&o->prediction))
    status = vs_minimizations_spent(d, &o->descents, budget->stage, err);
  if (status) return status;
  d->slopes = kind_of_slopes(o, true);
  count_starts(o);
  o->told = true;
  test_columns(o);
  return follow_profiles(d, o, err);
}

vs_status vs_fit_result_of(const vs_fit_problem *q, vs_fit_result *o, vs_error *err) {
  *o = (vs_fit_result){.inquiry = q};
  o->prediction = vs_prediction_of(q);
  vs_minimizer d = {.prediction = &o->prediction};
  vs_prediction_limit(&o->prediction, runs_for(q));
  vs_status status = find_outcome(&d, o, err);
  vs_prediction_unlimit(&o->prediction);
  return status;
}

void vs_fit_result_free(vs_fit_result *o) {
  vs_minimizations_free(&o->descents);
  vs_estimate_free(&o->estimate);
  free(o->profiles);
  free(o->columns);
  *o = (vs_fit_result){0};
}
