/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/orbit_columns.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "run/axis.h"

/* ---- the key ---- */

static const char KEY[] = "steady";
const vs_inside vs_orbit_columns_keys = {.rows = VS_ROWS({"period", .kind = VS_COUNT})};
enum { MOST_PERIODS = 1000 };

vs_status vs_orbit_columns_read(const vs_node *holder, int *periods, vs_error *err) {
  const vs_node *node = vs_tree_child(holder, KEY);
  const bool word = node && node->kind == VS_NODE_TEXT;
  uint64_t n = 1;
  *periods = 0;
  if (!node || (word && !strcmp(node->text, "false"))) return VS_OK;
  *periods = 1;
  if (word && !strcmp(node->text, "true")) return VS_OK;
  if (node->kind != VS_NODE_MAP)
    return vs_fail_at(err, node->where,
                      "steady: true is wanted, or a map: {period: N}, N firing periods");
  vs_status status = vs_field_map_keys(node, KEY, &vs_orbit_columns_keys, err);
  if (!status)
    status = vs_error_keep(
        err, vs_axis_whole(node, vs_orbit_columns_keys.rows->key, 1, MOST_PERIODS, &n, err));
  *periods = (int)n;
  return status;
}

/* ---- measures that stand for lists ---- */

static bool is_found(const vs_steady *s) {
  return s->orbit.count > 0;
}

static bool has_multipliers(const vs_steady *s) {
  return vs_steady_multipliers(s) > 0;
}

static bool is_judged(const vs_steady *s) {
  return is_found(s) && vs_steady_is_judged(s);
}

static double multiplier_max(const vs_steady *s) {
  return hypot(s->orbit.multiplier[0].re, s->orbit.multiplier[0].im);
}

static double is_stable(const vs_steady *s) {
  return s->orbit.stable;
}

static double worst_part(const vs_steady *s) {
  double worst = 0;
  for (int n = 2; n < VS_SPECTRUM_LINES; n++)
    worst = fmax(worst, vs_spectrum_judged(&s->spectrum, n) / vs_spectrum_limit(n));
  return worst;
}

static const struct {
  const char *name, *text;
  bool (*known)(const vs_steady *steady);
  double (*value)(const vs_steady *steady);
} ROWS[] = {
    {"multiplier_max", "size of the orbit's largest multiplier", has_multipliers, multiplier_max},
    {VS_ORBIT_COLUMNS_STABLE, "1: the orbit is stable; 0: it is not", is_judged, is_stable},
    {"harmonic_part", "largest part that a harmonic takes of its limit, IEC 61000-3-2, class A",
     is_found, worst_part}};
enum { N_ROWS = sizeof ROWS / sizeof *ROWS };

/* ---- all of the orbit's ---- */

static bool row_at(const vs_steady *s, int k, vs_listed_measure *m) {
  if (k >= N_ROWS) return false;
  snprintf(m->name, sizeof m->name, "%s", ROWS[k].name);
  snprintf(m->text, sizeof m->text, "%s", ROWS[k].text);
  m->unit = "";
  const bool known = ROWS[k].known(s);
  m->value = (vs_value){known, known ? ROWS[k].value(s) : NAN, NAN};
  return true;
}

static bool harmonic_at(const vs_steady *s, int n, vs_listed_measure *m) {
  if (n >= VS_SPECTRUM_LINES) return false;
  snprintf(m->name, sizeof m->name, "harmonic_%d", n);
  snprintf(m->text, sizeof m->text,
           n ? "harmonic %d of the mains current, rms" : "its mean, harmonic %d", n);
  m->unit = "A";
  m->value =
      (vs_value){is_found(s), is_found(s) ? vs_spectrum_harmonic(&s->spectrum, n) : NAN, NAN};
  return true;
}

bool vs_orbit_columns_default(const vs_steady *s, int k, vs_listed_measure *m) {
  vs_steady_measure of_orbit;
  int count = 0;
  *m = (vs_listed_measure){.limit = NAN, .channel = -1};
  while (count <= k && vs_steady_at(s, count, &of_orbit)) count++;
  if (count <= k) return row_at(s, k - count, m);
  snprintf(m->name, sizeof m->name, "%s", of_orbit.name);
  snprintf(m->text, sizeof m->text, "%s", of_orbit.text);
  m->unit = of_orbit.unit;
  m->value = of_orbit.value;
  return true;
}

/* The k-th harmonic of the currents whose quality the scene asks for. False: there are no more. */
static bool harmonic_of_quality(const vs_result *r, int k, vs_listed_measure *m) {
  vs_quality_measure of;
  for (int q = 0; q < r->n_quality; q++) {
    int n = 0;
    while (vs_quality_at(&r->quality[q], n, false, &of)) n++; /* which are shown already */
    for (; vs_quality_at(&r->quality[q], n, true, &of); n++)
      if (k-- == 0) {
        snprintf(m->name, sizeof m->name, "%s", of.name);
        snprintf(m->text, sizeof m->text, "%s", of.text);
        m->unit = of.unit;
        m->value = of.value;
        return true;
      }
  }
  return false;
}

/* ---- all ---- */

bool vs_orbit_columns_at(const vs_orbit_columns *of, int k, vs_listed_measure *m) {
  if (vs_listed_measure_at(of->frame, of->result, k, m)) return true;
  if (!of->steady && !of->result->n_quality) return false;
  int first = 0, usual = 0;
  vs_listed_measure other;
  while (vs_listed_measure_at(of->frame, of->result, first, &other)) first++;
  if (!of->steady) return harmonic_of_quality(of->result, k - first, m);
  if (vs_orbit_columns_default(of->steady, k - first, m)) return true;
  while (vs_orbit_columns_default(of->steady, usual, &other)) usual++;
  return harmonic_at(of->steady, k - first - usual, m) ||
         harmonic_of_quality(of->result, k - first - usual - VS_SPECTRUM_LINES, m);
}
