/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/minimizations.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <gsl/gsl_multifit_nlinear.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fit/prediction.h"
#include "jacobian.h"
#include "study/random.h"

enum { MOST_ITERATIONS = 100, EARLY_ITERATIONS = 12 };
/* Parts of a recording, from its begin, that are fitted one after the other where a search begins
 * far from the minimum. A swing whose frequency is off by 1 % is half a turn late after 50 turns;
 * then chi2 falls to a minimum that is a whole turn wrong. Over a short part no phase is as far
 * off. */
static const double PARTS[] = {1. / 16, 1. / 8, 1. / 4, 1. / 2, 1};
enum { N_PARTS = sizeof PARTS / sizeof *PARTS };

/* Converged: see the header. WHOLE is where more steps would only follow rounding. */
static const double CONVERGED = 1e-4, WHOLE = 1e-12;
/* What a residual is where the machine does not exist: so large that no step leads there. */
static const double NOWHERE = 1e100;

/* One search at work. Its t are those of the unknowns that are not held. */
typedef struct search {
  vs_minimizer *d;
  const double *start;
  size_t index[VS_INQUIRY_UNKNOWNS], n_free; /* unknowns that are not held */
  double s[VS_INQUIRY_UNKNOWNS];             /* of the last run */
  double *computed;                          /* by the last run */
  gsl_matrix *slopes;                        /* d residual/d s, of all unknowns */
  vs_error failed;
  double part; /* of each recording's time that counts now */
} search;

/* True if the datum counts: a measure does, and a sample in the part of its recording. */
static bool datum_counts(const search *w, size_t datum) {
  const vs_fit_problem *q = w->d->prediction->inquiry;
  if (w->part >= 1 || datum >= q->n_data || q->data[datum].aim >= 0) return true;
  const vs_recording *r = &q->runs[q->data[datum].run].recording;
  double from_s = r->samples[0].t_s, to_s = r->samples[r->n_samples - 1].t_s;
  return r->samples[q->data[datum].sample].t_s <= from_s + w->part * (to_s - from_s);
}

/* ---- for GSL ---- */

static void take_t(search *w, const gsl_vector *t) {
  memcpy(w->s, w->start, w->d->prediction->n_unknowns * sizeof *w->s);
  for (size_t j = 0; j < w->n_free; j++) {
    const vs_unknown *u = &w->d->prediction->inquiry->unknowns[w->index[j]];
    w->s[w->index[j]] = vs_unknown_inside(u, gsl_vector_get(t, j));
  }
}

static bool run_residuals(search *w, const gsl_vector *t) {
  vs_error err = {0};
  take_t(w, t);
  if (!vs_prediction_run(w->d->prediction, -1, w->s, w->computed, &err)) return true;
  w->failed = err;
  return false;
}

static int find_residuals(const gsl_vector *t, void *ctx, gsl_vector *f) {
  search *w = ctx;
  bool good = run_residuals(w, t);
  if (vs_prediction_spent(w->d->prediction)) return GSL_EFAILED;
  if (good) vs_prediction_residuals(w->d->prediction, w->s, w->computed, f->data);
  for (size_t n = 0; n < f->size; n++)
    if (!good || !isfinite(gsl_vector_get(f, n)))
      gsl_vector_set(f, n, NOWHERE);
    else if (!datum_counts(w, n))
      gsl_vector_set(f, n, 0);
  return GSL_SUCCESS;
}

static int find_slopes(const gsl_vector *t, void *ctx, gsl_matrix *j) {
  search *w = ctx;
  vs_error err = {0};
  double last[VS_INQUIRY_UNKNOWNS];
  memcpy(last, w->s, sizeof last);
  take_t(w, t);
  bool same = !memcmp(last, w->s, w->d->prediction->n_unknowns * sizeof *last);
  if ((!same && !run_residuals(w, t)) ||
      vs_jacobian_fill(w->d->slopes, w->d->prediction, w->s, w->computed, w->slopes, &err)) {
    if (*err.text) w->failed = err;
    return GSL_EFAILED;
  }
  for (size_t n = 0; n < j->size1; n++)
    for (size_t k = 0; k < w->d->prediction->n_unknowns && !datum_counts(w, n); k++)
      gsl_matrix_set(w->slopes, n, k, 0);
  for (size_t k = 0; k < w->n_free; k++) {
    const vs_unknown *u = &w->d->prediction->inquiry->unknowns[w->index[k]];
    double slope = vs_unknown_slope(u, gsl_vector_get(t, k));
    for (size_t n = 0; n < j->size1; n++)
      gsl_matrix_set(j, n, k, slope * gsl_matrix_get(w->slopes, n, w->index[k]));
  }
  return GSL_SUCCESS;
}

/* ---- how far the minimum is ---- */

/* How far s may go on against the gradient until it meets a bound. */
static double room_to_bound(const vs_unknown *u, double s, double gradient) {
  return gradient > 0 ? s - vs_unknown_least(u) : vs_unknown_most(u) - s;
}

/* The fall of chi2 in a step of Gauss and Newton, g (J^T J)^-1 g with g = J^T r, over the unknowns
 * that no bound stops; of those that one stops it is 2 |g| times the way to it. */
static double find_decrement(search *w, const gsl_vector *residual, vs_minimization *out) {
  const vs_fit_problem *q = w->d->prediction->inquiry;
  size_t moving = 0, n = residual->size;
  double fall = 0;
  gsl_matrix *j = vs_checked(gsl_matrix_alloc(n, w->n_free));
  memset(out->bound, 0, sizeof out->bound);
  for (size_t k = 0; k < w->n_free; k++) {
    const vs_unknown *u = &q->unknowns[w->index[k]];
    gsl_vector_view column = gsl_matrix_column(w->slopes, w->index[k]);
    double g, size = gsl_blas_dnrm2(&column.vector);
    gsl_blas_ddot(&column.vector, residual, &g);
    double way = room_to_bound(u, w->s[w->index[k]], g);
    out->bound[w->index[k]] = size > 0 && fabs(g) / (size * size) > way;
    if (out->bound[w->index[k]])
      fall += 2 * fabs(g) * fmax(way, 0);
    else
      gsl_matrix_set_col(j, moving++, &column.vector);
  }
  if (moving) { /* |U^T r|^2 of the columns' singular values that are more than rounding */
    gsl_matrix_view u = gsl_matrix_submatrix(j, 0, 0, n, moving);
    gsl_matrix *v = vs_checked(gsl_matrix_alloc(moving, moving));
    gsl_vector *size = vs_checked(gsl_vector_alloc(moving)),
               *part = vs_checked(gsl_vector_alloc(moving));
    gsl_linalg_SV_decomp_jacobi(&u.matrix, v, size);
    gsl_blas_dgemv(CblasTrans, 1, &u.matrix, residual, 0, part);
    for (size_t k = 0; k < moving; k++)
      if (gsl_vector_get(size, k) > 1e-9 * gsl_vector_get(size, 0))
        fall += gsl_vector_get(part, k) * gsl_vector_get(part, k);
    gsl_vector_free(part);
    gsl_vector_free(size);
    gsl_matrix_free(v);
  }
  gsl_matrix_free(j);
  return fall;
}

/* ---- one search ---- */

/* Notes where the search stands. Returns true where it need not go on. */
static bool check_descent(search *w, const gsl_multifit_nlinear_workspace *gsl,
                          vs_minimization *out) {
  const gsl_vector *residual = gsl_multifit_nlinear_residual(gsl);
  take_t(w, gsl_multifit_nlinear_position(gsl));
  memcpy(out->s, w->s, sizeof out->s);
  gsl_blas_ddot(residual, residual, &out->chi2);
  out->decrement = find_decrement(w, residual, out);
  out->converged = out->decrement < CONVERGED * fmax(1, out->chi2);
  return out->decrement < WHOLE * fmax(1, out->chi2);
}

static void descend_by_trust_region(search *w, gsl_multifit_nlinear_workspace *gsl,
                                    vs_minimization *out) {
  int failed = GSL_SUCCESS;
  bool whole = check_descent(w, gsl, out);
  const int most = w->part < 1 ? EARLY_ITERATIONS : MOST_ITERATIONS;
  for (int n = 0; !whole && n < most && !(w->part < 1 && out->converged); n++) {
    failed = gsl_multifit_nlinear_iterate(gsl);
    if (failed) break;
    out->iterations++;
    whole = check_descent(w, gsl, out);
  }
  if (out->converged) return;
  if (failed && failed != GSL_ENOPROG && *w->failed.text)
    snprintf(out->why, sizeof out->why, "the slopes cannot be found: %.200s", w->failed.text);
  else
    snprintf(
        out->why, sizeof out->why, "%s after %d iterations, where chi2 could still fall by %.2g",
        failed ? "no further step is found" : "not converged", out->iterations, out->decrement);
}

/* Goes down from s[], as far as the part of the recordings that counts leads. */
static void go_down(search *w, gsl_multifit_nlinear_workspace *gsl, const double *s,
                    vs_minimization *out) {
  gsl_multifit_nlinear_fdf fdf = {.f = find_residuals,
                                  .df = find_slopes,
                                  .n = w->d->prediction->n_residuals,
                                  .p = w->n_free,
                                  .params = w};
  gsl_vector *t = vs_checked(gsl_vector_alloc(w->n_free));
  for (size_t j = 0; j < w->n_free; j++) {
    const vs_unknown *u = &w->d->prediction->inquiry->unknowns[w->index[j]];
    gsl_vector_set(t, j, vs_unknown_free_of(u, s[w->index[j]]));
  }
  *out = (vs_minimization){.iterations = out->iterations};
  int failed = gsl_multifit_nlinear_init(t, &fdf, gsl);
  double first = gsl_vector_get(gsl_multifit_nlinear_residual(gsl), 0);
  if (failed || first == NOWHERE)
    snprintf(out->why, sizeof out->why, "the run at its start fails: %.200s", w->failed.text);
  else
    descend_by_trust_region(w, gsl, out);
  gsl_vector_free(t);
}

/* One part after the other; a part that leads nowhere is passed over. */
static void go_by_parts(search *w, gsl_multifit_nlinear_workspace *gsl, vs_minimization *out) {
  double s[VS_INQUIRY_UNKNOWNS];
  memcpy(s, w->start, w->d->prediction->n_unknowns * sizeof *s);
  for (int k = w->d->by_parts ? 0 : N_PARTS - 1; k < N_PARTS; k++) {
    if (vs_prediction_spent(w->d->prediction)) return;
    w->part = PARTS[k];
    go_down(w, gsl, s, out);
    if (!*out->why || out->chi2 > 0) memcpy(s, out->s, w->d->prediction->n_unknowns * sizeof *s);
  }
}

/* All unknowns are held: chi2 is what it is. */
static void hold_all_unknowns(search *w, vs_minimization *out) {
  const vs_prediction *p = w->d->prediction;
  double *residual = vs_alloc(p->n_residuals, sizeof *residual);
  memcpy(out->s, w->start, p->n_unknowns * sizeof *out->s);
  vs_error err = {0};
  out->converged = !vs_prediction_run(w->d->prediction, -1, w->start, w->computed, &err);
  if (!out->converged) snprintf(out->why, sizeof out->why, "%.255s", err.text);
  if (out->converged) vs_prediction_residuals(p, w->start, w->computed, residual);
  for (size_t n = 0; n < p->n_residuals; n++) out->chi2 += residual[n] * residual[n];
  free(residual);
}

void vs_minimization_from(vs_minimizer *d, const double *start, vs_minimization *out) {
  vs_prediction *p = d->prediction;
  search w = {.d = d, .start = start, .computed = vs_alloc(p->inquiry->n_data, sizeof(double))};
  *out = (vs_minimization){0};
  for (size_t k = 0; k < p->n_unknowns; k++)
    if (!d->held[k]) w.index[w.n_free++] = k;
  w.slopes = vs_checked(gsl_matrix_calloc(p->n_residuals, p->n_unknowns));
  gsl_multifit_nlinear_parameters parameters = gsl_multifit_nlinear_default_parameters();
  parameters.solver = gsl_multifit_nlinear_solver_svd;
  if (w.n_free) {
    gsl_multifit_nlinear_workspace *gsl = vs_checked(gsl_multifit_nlinear_alloc(
        gsl_multifit_nlinear_trust, &parameters, p->n_residuals, w.n_free));
    go_by_parts(&w, gsl, out);
    gsl_multifit_nlinear_free(gsl);
  } else
    hold_all_unknowns(&w, out);
  gsl_matrix_free(w.slopes);
  free(w.computed);
}

/* ---- several searches ---- */

/* How far an unknown without a bound may start from its first start, in s. */
static const double AWAY = 0.7;

static void place_start(const vs_fit_problem *q, const vs_sobol *sobol, size_t index, double *s) {
  for (size_t k = 0; k < q->n_unknowns; k++) {
    const vs_unknown *u = &q->unknowns[k];
    double first = vs_unknown_natural(u, u->start), a = vs_unknown_least(u), b = vs_unknown_most(u);
    if (isinf(a)) a = fmin(first, b) - AWAY;
    if (isinf(b)) b = fmax(first, a) + AWAY;
    s[k] = index ? a + (b - a) * vs_random_sobol_at(sobol, index, k) : first;
  }
}

/* Looks at the first start alone: its signs, and whether anything runs there. */
static vs_status try_first(vs_minimizer *d, const double *s, double *chi2, vs_error *err) {
  vs_prediction *p = d->prediction;
  double *computed = vs_alloc(p->inquiry->n_data, sizeof *computed);
  double *residual = vs_alloc(p->n_residuals, sizeof *residual);
  vs_error failed = {0};
  vs_status status = VS_OK;
  bool ran = !vs_prediction_run(p, -1, s, computed, &failed);
  *chi2 = ran ? 0 : NAN;
  if (ran) status = vs_prediction_check_signs(p, computed, err);
  if (ran) vs_prediction_residuals(p, s, computed, residual);
  for (size_t n = 0; n < p->n_residuals; n++) *chi2 += residual[n] * residual[n];
  free(residual);
  free(computed);
  return status;
}

/* A slope so small that all residuals change by less than a hundredth while s changes by 1. */
static const double FLAT = 1e-2;

/* Error: nothing that is fitted changes with one of the unknowns, at the first start. */
static vs_status check_effects(vs_minimizer *d, const double *s, vs_error *err) {
  vs_prediction *p = d->prediction;
  double *computed = vs_alloc(p->inquiry->n_data, sizeof *computed);
  gsl_matrix *slopes = vs_checked(gsl_matrix_alloc(p->n_residuals, p->n_unknowns));
  vs_error failed = {0};
  vs_status status = vs_prediction_run(p, -1, s, computed, &failed);
  if (!status) status = vs_jacobian_fill(d->slopes, p, s, computed, slopes, &failed);
  bool ran = !status;
  status = VS_OK;
  for (size_t k = 0; k < p->n_unknowns && ran && !status; k++) {
    gsl_vector_view column = gsl_matrix_column(slopes, k);
    if (gsl_blas_dnrm2(&column.vector) < FLAT)
      status =
          vs_fail_at(err, p->inquiry->unknowns[k].axis.where,
                     "nothing that was measured changes when %s changes: hold it, add a prior, "
                     "or start elsewhere",
                     p->inquiry->unknowns[k].name);
  }
  gsl_matrix_free(slopes);
  free(computed);
  return status;
}

/* The least chi2 that was come to; its place in all->item, or all->count where no run is told. */
static size_t least_of(const vs_minimizations *all) {
  size_t least = all->count;
  for (size_t k = 0; k < all->count; k++)
    if (all->item[k].chi2 > 0 && (least == all->count || all->item[k].chi2 < all->item[least].chi2))
      least = k;
  return least;
}

static vs_status none_converged(vs_minimizer *d, const vs_minimizations *all, const double *first,
                                vs_error *err) {
  vs_status status = check_effects(d, first, err);
  if (status) return status;
  const size_t found = least_of(all), least = found < all->count ? found : 0;
  return vs_fail(err, VS_RUN, "the fit does not converge from any of %zu starts; start %zu: %s",
                 all->count, least + 1, all->item[least].why);
}

vs_status vs_minimizations_spent(const vs_minimizer *d, const vs_minimizations *all,
                                 const char *stage, vs_error *err) {
  const vs_prediction *p = d->prediction;
  const int kind = p->budget.out[VS_BUDGET_CIRCUIT] ? VS_BUDGET_CIRCUIT : VS_BUDGET_IDEAL;
  const size_t least = least_of(all);
  vs_text at = {0};
  if (least < all->count)
    vs_text_add(&at, "the least chi2 is %.6g, in start %zu, %s, at", all->item[least].chi2,
                least + 1, all->item[least].converged ? "which converged" : "not converged");
  else
    vs_text_add(&at, "no chi2 is known");
  for (size_t k = 0; k < p->n_unknowns && least < all->count; k++) {
    const vs_unknown *u = &p->inquiry->unknowns[k];
    vs_text_add(&at, "%s %s = %.6g%s%s", k ? "," : "", u->name,
                vs_unknown_value(u, all->item[least].s[k]), *u->axis.unit ? " " : "", u->axis.unit);
  }
  vs_status status = vs_fail(err, VS_BUDGET,
                             "the fit's budget of %ld cycles of the mains %s is spent after %ld "
                             "runs, %s; so far %s; fewer unknowns, or a start that is nearer, need "
                             "fewer",
                             p->budget.most[kind],
                             kind == VS_BUDGET_CIRCUIT ? "in the circuit" : "on the ideal tiers",
                             p->runs, stage, at.text);
  vs_text_free(&at);
  return status;
}

vs_status vs_minimizations_search(vs_minimizer *d, vs_minimizations *all, vs_error *err) {
  const vs_fit_problem *q = d->prediction->inquiry;
  double s[VS_INQUIRY_UNKNOWNS], first[VS_INQUIRY_UNKNOWNS];
  vs_sobol *sobol = vs_alloc(1, sizeof *sobol);
  *all = (vs_minimizations){.count = (size_t)q->starts};
  all->item = vs_alloc(all->count, sizeof *all->item);
  all->best = all->count;
  vs_random_sobol_begin(sobol, q->n_unknowns, q->starts, q->seed);
  place_start(q, sobol, 0, first);
  vs_status status = try_first(d, first, &all->first_chi2, err);
  if (!status && vs_prediction_spent(d->prediction))
    status = vs_minimizations_spent(d, all, "before the first start", err);
  for (size_t r = 0; r < q->n_runs; r++) d->by_parts = d->by_parts || q->runs[r].recorded;
  for (size_t k = 0; k < all->count && !status; k++) {
    vs_minimization *found = &all->item[k];
    vs_budget *budget = &d->prediction->budget;
    place_start(q, sobol, k, s);
    snprintf(budget->stage, sizeof budget->stage, "start %zu of %zu", k + 1, all->count);
    vs_minimization_from(d, s, found);
    if (vs_prediction_spent(d->prediction))
      status = vs_minimizations_spent(d, all, budget->stage, err);
    bool none = all->best == all->count;
    if (found->converged && (none || found->chi2 < all->item[all->best].chi2)) all->best = k;
  }
  d->by_parts = false;
  free(sobol);
  if (!status && all->best == all->count) status = none_converged(d, all, first, err);
  return status;
}

void vs_minimizations_free(vs_minimizations *all) {
  free(all->item);
  *all = (vs_minimizations){0};
}
