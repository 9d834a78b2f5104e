/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/estimate.h"

#include <gsl/gsl_cdf.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fit/prediction.h"
#include "jacobian.h"

/* The data know nothing of a combination whose singular value is below FLAT: it may be wrong by a
 * factor of e^100. Nor of one below ROUNDING times the largest, as the slopes are not known
 * better. */
static const double FLAT = 1e-2, ROUNDING = 3e-7;
/* How much worse a combination with round exponents may be known than the exact one. */
static const double ROUND_COSTS = 1.25;
/* A pair is shown whose product or ratio is known so many times better than either alone. */
static const double PAIR_GAINS = 3;
/* Below this probability a model does not fit. */
static const double UNLIKELY = 1e-3;

/* ---- combinations ---- */

static double error_of(const vs_estimate *e, const double *exponent) {
  double sum = 0;
  for (size_t i = 0; i < e->n; i++)
    for (size_t k = 0; k < e->n; k++) sum += exponent[i] * e->covariance[i][k] * exponent[k];
  return sqrt(fmax(sum, 0));
}

/* Writes x^a * y^b; or a*x + b*y, each x divided by its scale, where not all s are logarithms. */
static void spell_combination(const vs_estimate *e, vs_combination *c) {
  vs_text text = {0};
  c->product = true;
  for (size_t k = 0; k < e->n; k++)
    if (c->exponent[k] != 0 && !e->inquiry->unknowns[k].log) c->product = false;
  for (size_t k = 0; k < e->n; k++) {
    const vs_unknown *u = &e->inquiry->unknowns[k];
    double x = c->exponent[k];
    if (x == 0) continue;
    if (c->product) {
      vs_text_add(&text, "%s%s", text.length ? (x < 0 && fabs(x) == 1 ? " / " : " * ") : "",
                  u->name);
      if (x != 1 && !(x == -1 && text.length > strlen(u->name))) vs_text_add(&text, "^%.4g", x);
    } else {
      vs_text_add(&text, "%s%.4g*", text.length ? " + " : "", x);
      if (u->log)
        vs_text_add(&text, "ln(%s)", u->name);
      else
        vs_text_add(&text, "%s/(%.4g %s)", u->name, u->scale, u->axis.unit);
    }
  }
  snprintf(c->text, sizeof c->text, "%s", text.text ? text.text : "");
  vs_text_free(&text);
}

/* Rounds a direction to the coarsest exponents that are as well known, and no better: 0 and 1, then
 * halves, thirds, tenths, hundredths, thousandths. */
static void round_exponents(const vs_estimate *e, vs_combination *c) {
  static const double PARTS[] = {1, 2, 3, 10, 100, 1000};
  double largest = 0, scaled[VS_INQUIRY_UNKNOWNS];
  for (size_t k = 0; k < e->n; k++)
    if (fabs(c->exact[k]) > fabs(largest)) largest = c->exact[k];
  for (size_t k = 0; k < e->n; k++) scaled[k] = c->exact[k] / largest;
  double exact = error_of(e, scaled);
  for (size_t p = 0; p < sizeof PARTS / sizeof *PARTS; p++) {
    for (size_t k = 0; k < e->n; k++) c->exponent[k] = round(scaled[k] * PARTS[p]) / PARTS[p];
    c->error = error_of(e, c->exponent);
    if (c->error < ROUND_COSTS * exact && c->error > exact / ROUND_COSTS) break;
  }
  spell_combination(e, c);
}

/* Of two unknowns that are strongly correlated, s_i/error_i -+ s_k/error_k is known best. */
static void find_pairs(vs_estimate *e) {
  e->pairs = vs_alloc(e->n * e->n + 1, sizeof *e->pairs);
  for (size_t i = 0; i < e->n; i++)
    for (size_t k = i + 1; k < e->n; k++) {
      vs_combination *c = &e->pairs[e->n_pairs];
      double r = vs_estimate_correlation(e, i, k);
      if (isnan(r)) continue;
      *c = (vs_combination){0};
      c->exact[i] = e->error[k];
      c->exact[k] = r < 0 ? e->error[i] : -e->error[i];
      round_exponents(e, c);
      if (c->error * PAIR_GAINS < fmin(e->error[i], e->error[k])) e->n_pairs++;
    }
}

/* ---- the matrix ---- */

typedef struct decomposed {
  size_t index[VS_INQUIRY_UNKNOWNS], count; /* unknowns that are on no bound */
  gsl_matrix *v;
  gsl_vector *s;
} decomposed;

/* all: with the unknowns that are on a bound. */
static void decompose_slopes(const vs_estimate *e, const gsl_matrix *slopes, bool all,
                             decomposed *d) {
  *d = (decomposed){.count = 0};
  for (size_t k = 0; k < e->n; k++)
    if (all || !e->minimum.bound[k]) d->index[d->count++] = k;
  if (!d->count) return;
  gsl_matrix *u = vs_checked(gsl_matrix_alloc(slopes->size1, d->count));
  for (size_t k = 0; k < d->count; k++) {
    gsl_vector_const_view column = gsl_matrix_const_column(slopes, d->index[k]);
    gsl_matrix_set_col(u, k, &column.vector);
  }
  d->v = vs_checked(gsl_matrix_alloc(d->count, d->count));
  d->s = vs_checked(gsl_vector_alloc(d->count));
  gsl_linalg_SV_decomp_jacobi(u, d->v, d->s);
  gsl_matrix_free(u);
}

static void free_decomposed(decomposed *d) {
  if (d->v) gsl_matrix_free(d->v);
  if (d->s) gsl_vector_free(d->s);
}

static void take_directions(vs_estimate *e, const decomposed *d) {
  e->n_directions = d->count;
  for (size_t c = 0; c < d->count; c++) {
    e->directions[c].singular = gsl_vector_get(d->s, c);
    for (size_t k = 0; k < d->count; k++)
      e->directions[c].exact[d->index[k]] = gsl_matrix_get(d->v, k, c);
  }
  for (size_t i = 0; i < d->count; i++)
    for (size_t k = 0; k < d->count; k++)
      for (size_t c = 0; c < d->count; c++)
        e->covariance[d->index[i]][d->index[k]] += gsl_matrix_get(d->v, i, c) *
                                                   gsl_matrix_get(d->v, k, c) /
                                                   pow(gsl_vector_get(d->s, c), 2);
}

/* Error: there is a combination of which the data know nothing. */
static vs_status find_flat(const vs_estimate *e, const decomposed *d, vs_error *err) {
  vs_text text = {0};
  double least = gsl_vector_get(d->s, d->count - 1), largest = gsl_vector_get(d->s, 0);
  if (least > FLAT && least > ROUNDING * largest) return VS_OK;
  size_t heaviest = 0;
  for (size_t k = 0; k < d->count; k++)
    if (fabs(gsl_matrix_get(d->v, k, d->count - 1)) >
        fabs(gsl_matrix_get(d->v, heaviest, d->count - 1)))
      heaviest = k;
  double top = gsl_matrix_get(d->v, heaviest, d->count - 1);
  for (size_t k = 0; k < d->count; k++) {
    double share = gsl_matrix_get(d->v, k, d->count - 1) / top;
    if (fabs(share) < 0.005) continue;
    vs_text_add(&text, "%s%s%s", text.length ? ", " : "", e->inquiry->unknowns[d->index[k]].name,
                k == heaviest ? ""
                : share > 0   ? " (the same way)"
                              : " (the other way)");
  }
  vs_status status = vs_fail_at(
      err, e->inquiry->unknowns[d->index[heaviest]].axis.where,
      "the data cannot tell so many unknowns apart: nothing that was measured changes when %s %s; "
      "hold one of these, add a prior, or measure more",
      text.text, strchr(text.text, ',') ? "change together" : "changes");
  vs_text_free(&text);
  return status;
}

static vs_status check_rank(const vs_estimate *e, const gsl_matrix *slopes, vs_error *err) {
  decomposed all;
  decompose_slopes(e, slopes, true, &all);
  vs_status status = find_flat(e, &all, err);
  free_decomposed(&all);
  return status;
}

/* ---- all of it ---- */

static void conclude_estimate(vs_estimate *e, size_t n_residuals) {
  size_t moving = 0;
  for (size_t k = 0; k < e->n; k++) {
    const vs_unknown *u = &e->inquiry->unknowns[k];
    bool bound = e->minimum.bound[k];
    double s = e->minimum.s[k], way = VS_ESTIMATE_95 * sqrt(e->covariance[k][k]);
    moving += !bound;
    e->value[k] = vs_unknown_value(u, s);
    e->error[k] = bound ? NAN : sqrt(e->covariance[k][k]);
    e->least[k] = bound ? NAN : vs_unknown_value(u, s - way);
    e->most[k] = bound ? NAN : vs_unknown_value(u, s + way);
  }
  e->freedom = (long)n_residuals - (long)moving;
  e->probability = e->freedom > 0 ? gsl_cdf_chisq_Q(e->minimum.chi2, (double)e->freedom) : NAN;
  for (size_t c = 0; c < e->n_directions; c++) round_exponents(e, &e->directions[c]);
  find_pairs(e);
}

vs_status vs_estimate_at(vs_minimizer *d, const vs_minimization *minimum, vs_estimate *e,
                         vs_error *err) {
  vs_prediction *p = d->prediction;
  *e = (vs_estimate){.inquiry = p->inquiry, .minimum = *minimum, .n = p->n_unknowns};
  e->computed = vs_alloc(p->inquiry->n_data, sizeof *e->computed);
  e->residual = vs_alloc(p->n_residuals, sizeof *e->residual);
  gsl_matrix *slopes = vs_checked(gsl_matrix_alloc(p->n_residuals, p->n_unknowns));
  vs_status status = vs_prediction_run(p, -1, minimum->s, e->computed, err);
  e->unstable = p->unstable;
  if (!status) status = vs_jacobian_fill(d->slopes, p, minimum->s, e->computed, slopes, err);
  if (!status) {
    vs_prediction_residuals(p, minimum->s, e->computed, e->residual);
    status = check_rank(e, slopes, err);
  }
  if (!status) {
    decomposed parts;
    decompose_slopes(e, slopes, false, &parts);
    take_directions(e, &parts);
    free_decomposed(&parts);
    conclude_estimate(e, p->n_residuals);
  }
  gsl_matrix_free(slopes);
  return status;
}

void vs_estimate_free(vs_estimate *e) {
  free(e->computed);
  free(e->residual);
  free(e->pairs);
  *e = (vs_estimate){0};
}

bool vs_estimate_fits(const vs_estimate *e) {
  return isnan(e->probability) || e->probability >= UNLIKELY;
}

double vs_estimate_correlation(const vs_estimate *e, size_t i, size_t k) {
  if (isnan(e->error[i]) || isnan(e->error[k])) return NAN;
  return e->covariance[i][k] / (e->error[i] * e->error[k]);
}
