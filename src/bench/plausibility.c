/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "plausibility.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"
#include "netlist/kinds.h"
#include "netlist/parts.h"

/* ---- numbers by themselves ---- */

/* A figure stands in the file as the limit, as the parameter that the model is made with, or as
 * both. */
static void warn_of_range(const vs_stand *s, const char *kind, const vs_kind_limit *range,
                          vs_warnings *w) {
  const char *const names[] = {range->name, range->param};
  for (int n = 0; n < 2 && names[n] && range->most > 0; n++) {
    vs_figures_asked limit = vs_figures_limit(s, names[n]),
                     a = isfinite(limit.value) ? limit : vs_figures_any(s, names[n]);
    double shown = a.value / vs_units_factor(range->unit);
    if (isnan(shown) || (shown >= range->least && shown <= range->most)) continue;
    vs_fail_at(vs_warnings_add(w), a.where.file ? a.where : (vs_where){.file = s->name},
               "%s = %.4g %s is implausible: a%s %s has %.4g to %.4g %s; is the unit right?",
               names[n], shown, range->unit, strchr("aeio", *kind) ? "n" : "", kind, range->least,
               range->most, range->unit);
  }
}

/* ---- numbers side by side ---- */

/* Adds a warning where a over b is not within these ends. `text` says what is usual. */
static void warn_of_ratio(vs_figures_asked a, vs_figures_asked b, double least, double most,
                          const char *text, vs_warnings *w) {
  double ratio = a.value / b.value;
  if (isnan(ratio) || (ratio >= least && ratio <= most)) return;
  vs_fail_at(vs_warnings_add(w), a.where, "implausible: %s; here it is %.4g", text, ratio);
}

static void warn_of_pair(const vs_stand *s, const vs_kind_ratio *pair, vs_warnings *w) {
  char text[160];
  if (!(pair->most > 0)) return;
  snprintf(text, sizeof text, "%s is %.4g to %.4g times %s", pair->more, pair->least, pair->most,
           pair->less);
  warn_of_ratio(vs_figures_limit(s, pair->more), vs_figures_limit(s, pair->less), pair->least,
                pair->most, text, w);
}

/* A half sine of 10 ms and the peak I has I^2 * 5 ms. */
static void warn_of_surge(const vs_stand *s, const char *name, vs_warnings *w) {
  char text[160];
  if (!name) return;
  vs_figures_asked i2t = vs_figures_limit(s, "i2t"), surge = vs_figures_limit(s, name);
  surge.value *= surge.value * 5e-3;
  snprintf(text, sizeof text,
           "i2t is 0.5 to 1.5 times what a half sine of 10 ms and %s has, %s^2 * 5 ms", name, name);
  warn_of_ratio(i2t, surge, 0.5, 1.5, text, w);
}

/* A figure that stands in the file twice: as the limit that runs are held to, and as a parameter
 * that the model is made with. */
static void warn_of_twin(const vs_stand *s, const vs_kind_limit *twin, vs_warnings *w) {
  if (!(twin->is & VS_LIMIT_TWIN)) return;
  vs_figures_asked param = vs_figures_any(s, twin->param), limit = vs_figures_limit(s, twin->name);
  double ratio = param.value / limit.value;
  if (isnan(ratio) || fabs(ratio - 1) < 0.01) return;
  vs_fail_at(vs_warnings_add(w), param.where.file ? param.where : limit.where,
             "%s, by which the model is made, is %.4g times the limit %s: a run is held to the "
             "one, and the model does the other",
             twin->param, ratio, twin->name);
}

/* ---- heat ---- */

/* The place of the line `*$ part`. */
static vs_where part_line(const vs_stand *s) {
  const vs_part_file *file = vs_parts_file(&s->deck, s->file);
  return (vs_where){s->name, file ? file->where.line : 0, 1};
}

/* Without zth nothing is computed of the junction. With it, the rated current must not heat it from
 * a case at 25 degC beyond t_j_max. */
static void warn_of_heat(const vs_stand *s, const vs_kind *kind, vs_warnings *w) {
  static const double WARM_K = 150; /* from 25 degC to 175 degC; few chips go beyond */
  if (!kind->heat.current) return;
  double k_per_w = 0, i = vs_figures_limit(s, kind->heat.current).value,
         v0 = vs_figures_any(s, "on_voltage").value, r = vs_figures_any(s, "on_resistance").value;
  vs_where first = {0};
  for (size_t k = 0; k < s->deck.n_zth; k++) {
    const vs_zth *z = &s->deck.zth[k];
    if (strcmp(z->where.file, s->file)) continue;
    const vs_where where = {s->name, z->where.line, z->where.column};
    if (!first.file) first = where;
    k_per_w += z->k_per_w;
    if (z->tau_s < 1e-6 || z->tau_s > 1e4)
      vs_fail_at(vs_warnings_add(w), where,
                 "implausible: a time constant of %.4g s; chips and cases have 1 us to 10,000 s",
                 z->tau_s);
  }
  if (!first.file)
    vs_fail_at(vs_warnings_add(w), part_line(s),
               "no line 'zth': the junction's temperature is not computed, so that nothing tells "
               "when it is too hot; give the terms of Z_th(j-c)");
  const double mean_a = kind->heat.mean * i, rms_a = kind->heat.rms * i;
  double loss_w = mean_a; /* at 1 V */
  if (isfinite(r)) loss_w = (isfinite(v0) ? v0 : 0) * mean_a + r * rms_a * rms_a;
  if (first.file && k_per_w * loss_w > WARM_K)
    vs_fail_at(vs_warnings_add(w), first,
               "implausible: the lines zth make %.4g K/W, by which %s = %.4g A heats the "
               "junction by %.4g K",
               k_per_w, kind->heat.current, i, k_per_w * loss_w);
}

/* ---- what was measured ---- */

/* True where a warning speaks of that line. */
static bool is_named(const vs_warnings *w, int line) {
  for (size_t k = 0; k < w->count; k++)
    if (w->item[k].line == line && line) return true;
  return false;
}

/* A model may meet what is asked because it is ideal, as no device is. */
static void warn_of_figure(const vs_stand *s, const vs_figure *row, vs_warnings *w) {
  static const double FAR = 20; /* times better than what is asked */
  vs_where where = row->where.file ? row->where : part_line(s);
  double factor = vs_units_factor(row->unit), limit = vs_figures_limit(s, "di_dt").value;
  if (isnan(row->got)) return;
  if (!strcmp(row->name, "V_GT") && (row->got < 0.55 || row->got > 5))
    vs_fail_at(
        vs_warnings_add(w), where,
        "implausible: the model's gate fires at %.3g V; a gate's junction wants 0.55 to 5 V, "
        "and noise below that would fire it in a run",
        row->got);
  if (!strcmp(row->name, "di/dt") && row->got > 100 * limit)
    vs_fail_at(
        vs_warnings_add(w), vs_figures_limit(s, "di_dt").where,
        "implausible: di_dt = %.4g A/us, and the model turns on at %.3g A/us: a run's margin "
        "of di_dt would be %.2g %%, and tell nothing of the device; look at the unit, or "
        "give the circuit its inductance",
        limit * 1e-6, row->got * 1e-6, 100 * (1 - row->got / limit));
  if (is_named(w, row->where.line)) return; /* what is asked is wrong already */
  bool better = (row->held == VS_HELD_AT_MOST && row->got < row->asked / FAR) ||
                (row->held == VS_HELD_AT_LEAST && row->got > row->asked * FAR);
  if (better && isinf(row->got))
    vs_fail_at(vs_warnings_add(w), where,
               "implausible: the model never shows %s, and %.4g %s is asked: runs will not tell "
               "when the device would",
               row->name, row->asked / factor, row->unit);
  else if (better)
    vs_fail_at(vs_warnings_add(w), where,
               "implausible: %s is %.3g %s, and %.4g %s is asked: a model that is better than its "
               "device by so much hides what the device would do",
               row->name, row->got / factor, row->unit, row->asked / factor, row->unit);
}

static void warn_of_kind(const vs_stand *s, const vs_kind *kind, vs_warnings *w) {
  for (size_t k = 0; k < kind->n_limits; k++) warn_of_range(s, kind->name, &kind->limits[k], w);
  for (int k = 0; k < VS_KIND_RATIOS && kind->ratios[k].more; k++)
    warn_of_pair(s, &kind->ratios[k], w);
  warn_of_surge(s, vs_kinds_surge_limit(kind->name), w);
  for (size_t k = 0; k < kind->n_limits; k++) warn_of_twin(s, &kind->limits[k], w);
  warn_of_heat(s, kind, w);
}

/* By line, in the order of the file. */
static void sort(vs_warnings *w, size_t first) {
  for (size_t k = first + 1; k < w->count; k++)
    for (size_t n = k; n > first && w->item[n - 1].line > w->item[n].line; n--) {
      vs_error other = w->item[n];
      w->item[n] = w->item[n - 1];
      w->item[n - 1] = other;
    }
}

void vs_plausibility_warn(const vs_stand *s, const vs_figures *figures, vs_warnings *w) {
  const vs_part_file *file = vs_parts_file(&s->deck, s->file);
  const vs_kind *kind = file ? vs_kinds_find(file->kind) : NULL;
  size_t first = w->count;
  if (!file || !vs_parts_is_real(&s->deck, s->file)) return;
  if (kind) warn_of_kind(s, kind, w);
  for (size_t k = 0; k < figures->count; k++) warn_of_figure(s, &figures->row[k], w);
  sort(w, first);
}
