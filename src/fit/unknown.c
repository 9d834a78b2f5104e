/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "fit/unknown.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"

/* ---- coordinates ---- */

double vs_unknown_natural(const vs_unknown *u, double x) {
  return u->log ? log(x) : x / u->scale;
}

double vs_unknown_value(const vs_unknown *u, double s) {
  return u->log ? exp(s) : s * u->scale;
}

double vs_unknown_least(const vs_unknown *u) {
  return isinf(u->from) || (u->log && u->from <= 0) ? -INFINITY : vs_unknown_natural(u, u->from);
}

double vs_unknown_most(const vs_unknown *u) {
  return isinf(u->to) ? INFINITY : vs_unknown_natural(u, u->to);
}

double vs_unknown_inside(const vs_unknown *u, double t) {
  double a = vs_unknown_least(u), b = vs_unknown_most(u);
  if (isfinite(a) && isfinite(b)) return a + (b - a) * (1 + sin(t)) / 2;
  if (isfinite(a)) return a - 1 + sqrt(1 + t * t);
  if (isfinite(b)) return b + 1 - sqrt(1 + t * t);
  return t;
}

double vs_unknown_slope(const vs_unknown *u, double t) {
  double a = vs_unknown_least(u), b = vs_unknown_most(u);
  if (isfinite(a) && isfinite(b)) return (b - a) * cos(t) / 2;
  if (isfinite(a)) return t / sqrt(1 + t * t);
  if (isfinite(b)) return -t / sqrt(1 + t * t);
  return 1;
}

/* How far inside, as a share of the range, a search begins that would begin on a bound. */
static const double INSIDE = 1e-3;

double vs_unknown_free_of(const vs_unknown *u, double s) {
  double a = vs_unknown_least(u), b = vs_unknown_most(u);
  if (isfinite(a) && isfinite(b)) {
    double part = fmin(fmax((s - a) / (b - a), INSIDE), 1 - INSIDE);
    return asin(2 * part - 1);
  }
  if (isfinite(a)) return sqrt(pow(1 + fmax(s - a, INSIDE), 2) - 1);
  if (isfinite(b)) return sqrt(pow(1 + fmax(b - s, INSIDE), 2) - 1);
  return s;
}

void vs_unknown_put(const vs_unknown *u, double s, vs_tree *tree) {
  vs_axis_put(&u->axis, vs_unknown_value(u, s), 17, tree);
}

/* ---- reading ---- */

vs_status vs_unknown_error(const vs_node *node, const char *what, const char *unit, double *error,
                           bool *relative, vs_error *err) {
  char why[256], share[256];
  *relative = true;
  if (node->kind != VS_NODE_TEXT || !*node->text)
    return vs_fail_at(err, node->where, "%s: an error is wanted, as '3 %%' or an amount in %s",
                      what, *unit ? unit : "numbers");
  bool percent = strchr(node->text, '%') != NULL;
  if (percent && !vs_units_read(node->text, "%", error, share, sizeof share))
    return vs_fail_at(err, node->where, "%s: error: %s", what, share);
  if (!percent) {
    *relative = false;
    if (!vs_units_read(node->text, unit, error, why, sizeof why))
      return vs_fail_at(err, node->where, "%s: error: %s", what, why);
  }
  if (!(*error > 0) || isinf(*error))
    return vs_fail_at(err, node->where,
                      "%s: the error '%s' is not above 0; what is known exactly belongs into 'set'",
                      what, node->text);
  return VS_OK;
}

static vs_status read_number_of_unknown(vs_unknown *u, const vs_node *map, const char *key,
                                        double *x, vs_error *err) {
  const vs_node *node = vs_tree_child(map, key);
  return node ? vs_axis_number(&u->axis, node, x, err) : VS_OK;
}

static vs_status check_bounds(const vs_unknown *u, const vs_node *map, vs_error *err) {
  const vs_node *start = vs_tree_child(map, "start");
  vs_where where = start ? start->where : u->axis.where;
  if (!(u->from < u->to))
    return vs_fail_at(err, vs_tree_child(map, "to")->where, "%s: the bounds %g..%g %s hold nothing",
                      u->name, u->from, u->to, u->axis.unit);
  if (u->start < u->from || u->start > u->to)
    return vs_fail_at(
        err, where, "%s: the bounds %g..%g %s exclude %g, at which the search starts%s", u->name,
        u->from, u->to, u->axis.unit, u->start, start ? "" : " as the scene says; add start");
  return VS_OK;
}

/* Chooses the natural coordinate. */
static vs_status choose_scale(vs_unknown *u, vs_error *err) {
  u->scale = 1;
  u->log = u->start > 0 && (u->axis.field->min >= 0 || u->from >= 0);
  if (u->log) return VS_OK;
  u->scale = isfinite(u->from) && isfinite(u->to) ? u->to - u->from : fabs(u->start);
  if (u->scale > 0) return VS_OK;
  return vs_fail_at(
      err, u->axis.where,
      "%s starts at 0, so that nothing tells how large a change is; write from and to", u->name);
}

/* prior: {value: 0.83 kg, error: 5 %}; value may be missing. */
static vs_status read_prior(vs_unknown *u, const vs_node *map, vs_error *err) {
  static const char *const KEYS[] = {"value", "error"};
  const vs_node *prior = vs_tree_child(map, "prior"), *error = vs_tree_child(prior, "error");
  double x = u->start, amount;
  bool relative;
  u->prior = u->prior_error = NAN;
  if (!prior) return VS_OK;
  if (prior->kind != VS_NODE_MAP || !error)
    return vs_fail_at(err, prior->where, "%s: prior: {value: %g %s, error: 5 %%} is wanted",
                      u->name, u->start, u->axis.unit);
  vs_status status = vs_field_known_keys(prior, "prior", KEYS, 2, err);
  if (!status) status = read_number_of_unknown(u, prior, "value", &x, err);
  if (!status) status = vs_unknown_error(error, u->name, u->axis.unit, &amount, &relative, err);
  if (status) return status;
  if (!relative) amount /= vs_units_factor(u->axis.unit);
  if (u->log && !(x > 0))
    return vs_fail_at(err, prior->where, "%s: prior: a value above 0 is wanted", u->name);
  u->prior = vs_unknown_natural(u, x);
  if (u->log)
    u->prior_error = relative ? amount : amount / x;
  else
    u->prior_error = (relative ? fabs(amount * x) : amount) / u->scale;
  return u->prior_error > 0
             ? VS_OK
             : vs_fail_at(err, error->where, "%s: prior: a share of 0 is no error; write an amount",
                          u->name);
}

vs_status vs_unknown_read(vs_unknown *u, const vs_scene *scene, const vs_node *node, int run,
                          vs_error *err) {
  static const char *const KEYS[] = {"from", "to", "start", "prior"};
  *u = (vs_unknown){.run = run, .from = -INFINITY, .to = INFINITY};
  snprintf(u->name, sizeof u->name, "%.180s", node->key);
  if (run >= 0) snprintf(u->name, sizeof u->name, "%d.%.180s", run + 1, node->key);
  vs_status status = vs_axis_init(&u->axis, scene, node, "free", err);
  if (status) return status;
  if (u->axis.is_word || !vs_field_is_real(u->axis.field))
    return vs_fail_at(err, node->key_where, "%s is not a real number, so no slope leads to it",
                      u->name);
  if (node->kind == VS_NODE_LIST || (node->kind == VS_NODE_TEXT && *node->text))
    return vs_fail_at(err, node->where, "%s: a map is wanted: {from: A, to: B}, or nothing",
                      u->name);
  const vs_node *map = node->kind == VS_NODE_MAP ? node : NULL;
  status = vs_field_known_keys(map, u->name, KEYS, 4, err);
  u->start = u->axis.nominal;
  if (!status) status = read_number_of_unknown(u, map, "from", &u->from, err);
  if (!status) status = read_number_of_unknown(u, map, "to", &u->to, err);
  if (!status) status = read_number_of_unknown(u, map, "start", &u->start, err);
  if (status) return status;
  if (isnan(u->start))
    return vs_fail_at(err, u->axis.where, "%s: the scene has no number here; add start", u->name);
  status = check_bounds(u, map, err);
  if (!status) status = choose_scale(u, err);
  return status ? status : read_prior(u, map, err);
}

void vs_unknown_free(vs_unknown *u) {
  vs_axis_free(&u->axis);
}
