/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "found.h"

#include <math.h>
#include <string.h>

#include "base/csv.h"
#include "fitted.h"
#include "run/version.h"
#include "base/units.h"
#include "ngspice/trust.h"

enum { DIGITS = 12 };

/* ---- JSON ---- */

static void add_pair(vs_json *json, const char *key, double from, double to) {
  vs_json_array(json, key, VS_JSON_ROW);
  vs_json_number(json, NULL, from, DIGITS);
  vs_json_number(json, NULL, to, DIGITS);
  vs_json_end(json);
}

static void add_unknown(const vs_outcome *o, size_t k, vs_json *json) {
  const vs_estimate *e = &o->estimate;
  const vs_unknown *u = &e->inquiry->unknowns[k];
  vs_json_object(json, u->name, VS_JSON_ROW);
  vs_json_number(json, "value", e->value[k], DIGITS);
  vs_json_text(json, "unit", u->axis.unit);
  vs_json_number(json, "standard_error", e->error[k] * (u->log ? e->value[k] : u->scale), DIGITS);
  if (u->log) vs_json_number(json, "standard_error_of_ln", e->error[k], DIGITS);
  add_pair(json, "interval_95", e->least[k], e->most[k]);
  vs_json_number(json, "start", u->start, DIGITS);
  add_pair(json, "bounds", u->from, u->to);
  vs_json_bool(json, "on_bound", e->minimum.bound[k]);
  for (size_t p = 0; p < o->n_profiles; p++)
    if (o->profiles[p].unknown == k)
      add_pair(json, "profile_95", o->profiles[p].least, o->profiles[p].most);
  vs_json_end(json);
}

static void add_correlation(const vs_estimate *e, vs_json *json) {
  vs_json_array(json, "correlation", VS_JSON_LINES);
  for (size_t i = 0; i < e->n; i++) {
    vs_json_array(json, NULL, VS_JSON_ROW);
    for (size_t k = 0; k < e->n; k++)
      vs_json_number(json, NULL, vs_estimate_correlation(e, i, k), DIGITS);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_exponents(const vs_estimate *e, const char *key, const double *exponent,
                          vs_json *json) {
  vs_json_object(json, key, VS_JSON_ROW);
  for (size_t k = 0; k < e->n; k++)
    if (exponent[k] != 0) vs_json_number(json, e->inquiry->unknowns[k].name, exponent[k], DIGITS);
  vs_json_end(json);
}

static void add_combination(const vs_estimate *e, const vs_combination *c, vs_json *json) {
  vs_json_object(json, NULL, VS_JSON_LINES);
  vs_json_text(json, "combination", c->text);
  vs_json_number(json, "standard_error", c->error, DIGITS);
  vs_json_bool(json, "of_logarithm", c->product);
  add_exponents(e, "exponents", c->exponent, json);
  if (c->singular > 0) {
    vs_json_number(json, "singular_value", c->singular, DIGITS);
    add_exponents(e, "direction", c->exact, json);
  }
  vs_json_end(json);
}

static void add_combinations(const vs_estimate *e, vs_json *json) {
  vs_json_array(json, "singular_values", VS_JSON_ROW);
  for (size_t k = 0; k < e->n_directions; k++)
    vs_json_number(json, NULL, e->directions[k].singular, DIGITS);
  vs_json_end(json);
  vs_json_array(json, "directions", VS_JSON_LINES);
  for (size_t k = 0; k < e->n_directions; k++) add_combination(e, &e->directions[k], json);
  vs_json_end(json);
  vs_json_array(json, "pairs", VS_JSON_LINES);
  for (size_t k = 0; k < e->n_pairs; k++) add_combination(e, &e->pairs[k], json);
  vs_json_end(json);
}

static void add_measures(const vs_outcome *o, vs_json *json) {
  const vs_inquiry *q = o->inquiry;
  vs_json_array(json, "measures", VS_JSON_LINES);
  for (size_t n = 0; n < q->n_data; n++) {
    const vs_datum *d = &q->data[n];
    const char *unit = vs_inquiry_unit(q, d);
    if (d->aim < 0) continue;
    vs_json_object(json, NULL, VS_JSON_ROW);
    vs_json_whole(json, "run", d->run + 1);
    vs_json_text(json, "name", vs_inquiry_name(q, d));
    vs_json_text(json, "unit", unit);
    vs_json_number(json, "measured", d->value / vs_units_factor(unit), DIGITS);
    vs_json_number(json, "fitted", o->estimate.computed[n] / vs_units_factor(unit), DIGITS);
    vs_json_number(json, "residual", o->estimate.residual[n], DIGITS);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_columns(const vs_outcome *o, vs_json *json) {
  vs_json_array(json, "columns", VS_JSON_LINES);
  for (size_t k = 0; k < o->n_columns; k++) {
    const vs_outcome_column *c = &o->columns[k];
    const vs_pattern *p = &c->pattern;
    vs_json_object(json, NULL, VS_JSON_LINES);
    vs_json_whole(json, "run", (int64_t)c->run + 1);
    vs_json_text(json, "name", o->inquiry->runs[c->run].recording.columns.item[c->column].name);
    vs_json_whole(json, "samples", (int64_t)p->count);
    vs_json_number(json, "rms", p->rms, DIGITS);
    vs_json_whole(json, "runs", p->runs);
    vs_json_number(json, "runs_expected", p->runs_expected, DIGITS);
    vs_json_number(json, "runs_probability", p->runs_probability, DIGITS);
    vs_json_whole(json, "lags", p->lags);
    vs_json_number(json, "ljung_box", p->ljung_box, DIGITS);
    vs_json_number(json, "ljung_box_probability", p->ljung_box_probability, DIGITS);
    vs_json_number(json, "durbin_watson", p->durbin_watson, DIGITS);
    vs_json_bool(json, "pattern", p->found);
    vs_json_end(json);
  }
  vs_json_end(json);
}

static void add_warning(void *ctx, const char *text) {
  vs_json_text(ctx, NULL, text);
}

static void add_warnings(const vs_outcome *o, vs_json *json) {
  bool circuit = false;
  for (size_t r = 0; r < o->inquiry->n_runs; r++)
    circuit = circuit || o->inquiry->runs[r].scene->tier->has_circuit;
  vs_json_array(json, "warnings", VS_JSON_LINES);
  if (circuit && *vs_trust_text()) add_warning(json, vs_trust_text());
  vs_fitted_warnings(o, add_warning, json);
  vs_json_end(json);
}

static void add_search(const vs_outcome *o, vs_json *json) {
  vs_json_object(json, "search", VS_JSON_ROW);
  vs_json_whole(json, "starts", (int64_t)o->descents.count);
  vs_json_whole(json, "converged", (int64_t)o->converged);
  vs_json_whole(json, "reached_least", (int64_t)o->reached);
  vs_json_number(json, "next_chi2", o->next_chi2, DIGITS);
  vs_json_whole(json, "runs", o->prediction.runs);
  vs_json_whole(json, "failed_runs", o->prediction.failures);
  vs_json_text(json, "slopes", o->slopes);
  vs_json_whole(json, "slopes_not_exact", o->prediction.inexact);
  vs_json_end(json);
}

void vs_found_json(const vs_outcome *o, vs_text *text) {
  const vs_estimate *e = &o->estimate;
  vs_json json = vs_json_new(text);
  vs_json_object(&json, NULL, VS_JSON_LINES);
  vs_version_json(&json);
  const char *slash = strrchr(o->inquiry->path, '/');
  vs_json_text(&json, "fit", slash ? slash + 1 : o->inquiry->path);
  add_search(o, &json);
  vs_json_whole(&json, "data", (int64_t)o->inquiry->n_data);
  vs_json_whole(&json, "priors", (int64_t)o->inquiry->n_priors);
  vs_json_text(&json, "residual", o->inquiry->difference ? "difference" : "logarithm");
  vs_json_number(&json, "chi2_at_start", o->descents.first_chi2, DIGITS);
  vs_json_number(&json, "chi2", e->minimum.chi2, DIGITS);
  vs_json_whole(&json, "degrees_of_freedom", e->freedom);
  vs_json_number(&json, "probability", e->probability, DIGITS);
  vs_json_bool(&json, "fits", vs_estimate_fits(e));
  vs_json_object(&json, "unknowns", VS_JSON_LINES);
  for (size_t k = 0; k < e->n; k++) add_unknown(o, k, &json);
  vs_json_end(&json);
  add_correlation(e, &json);
  add_combinations(e, &json);
  add_measures(o, &json);
  add_columns(o, &json);
  add_warnings(o, &json);
  vs_json_end(&json);
  vs_text_add(text, "\n");
}

/* ---- CSV ---- */

static void add_number(vs_text *row, double value, int digits) {
  char text[VS_NUMBER_SIZE];
  vs_text_number(text, value, digits);
  vs_text_add(row, ",%s", text);
}

void vs_found_residuals(const vs_outcome *o, int digits, FILE *out) {
  const vs_inquiry *q = o->inquiry;
  fputs("run,name,unit,t_s,measured,computed,error,residual\n", out);
  for (size_t n = 0; n < q->n_data; n++) {
    const vs_datum *d = &q->data[n];
    const double si = vs_units_factor(vs_inquiry_unit(q, d));
    vs_text row = {0};
    vs_text_add(&row, "%d,", d->run + 1);
    vs_csv_cell(&row, vs_inquiry_name(q, d));
    vs_text_add(&row, ",%s", vs_inquiry_unit(q, d));
    if (d->aim < 0)
      add_number(&row, q->runs[d->run].recording.samples[d->sample].t_s, digits);
    else
      vs_text_add(&row, ",");
    add_number(&row, d->value / si, digits);
    add_number(&row, o->estimate.computed[n] / si, digits);
    add_number(&row, (d->relative ? fabs(d->error * d->value) : d->error) / si, digits);
    add_number(&row, o->estimate.residual[n], digits);
    fprintf(out, "%s\n", row.text);
    vs_text_free(&row);
  }
}

void vs_found_profiles(const vs_outcome *o, int digits, FILE *out) {
  fputs("unknown,unit,value,chi2\n", out);
  for (size_t p = 0; p < o->n_profiles; p++) {
    const vs_likelihood *profile = &o->profiles[p];
    const vs_unknown *u = &o->inquiry->unknowns[profile->unknown];
    for (size_t k = 0; k < profile->count; k++) {
      vs_text row = {0};
      vs_csv_cell(&row, u->name);
      vs_text_add(&row, ",%s", u->axis.unit);
      add_number(&row, vs_unknown_value(u, profile->point[k].s), digits);
      add_number(&row, profile->point[k].chi2, digits);
      fprintf(out, "%s\n", row.text);
      vs_text_free(&row);
    }
  }
}
