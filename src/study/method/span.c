/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "method/span.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"
#include "run/keys.h"

static vs_status misread(const vs_axis *axis, const vs_node *node, vs_error *err) {
  const char *unit = *axis->unit ? axis->unit : "1";
  return vs_fail_at(err, node->where,
                    "%s: '%s' is no spread; write '5 %% normal', '5 %% normal within 2 sigma', "
                    "'10 %% uniform', '1 %s uniform', '-20 %% .. 5 %%', 'A .. B' or [A, B, ...]",
                    axis->key, node->text, unit);
}

/* Takes the last word off the text and returns it; NULL: there is only one. */
static char *last_word(char *text) {
  size_t length = strlen(text);
  while (length && text[length - 1] == ' ') text[--length] = '\0';
  char *word = strrchr(text, ' ');
  if (word) *word++ = '\0';
  return word;
}

/* Takes "within K sigma" off the end of the text, if it is there. false: the text ends in something
 * like it that is wrong. */
static bool take_cut(char *text, double *cut) {
  char *at = strstr(text, " within "), *end;
  *cut = 0;
  if (!at) return true;
  *cut = vs_text_to_number(at + strlen(" within "), &end);
  *at = '\0';
  while (*end == ' ') end++;
  return *cut > 0 && *cut <= 10 && !strcmp(end, "sigma");
}

static vs_status check_reach(const vs_axis *axis, const vs_node *node, double reach,
                             vs_error *err) {
  const vs_field *f = axis->field;
  double low = axis->nominal - reach, high = axis->nominal + reach;
  char range[128];
  if (f->open ? low > f->min && high < f->max : low >= f->min && high <= f->max) return VS_OK;
  vs_field_range(f, range, sizeof range);
  return vs_fail_at(err, node->where, "%s: '%s' about %.6g %s goes from %.6g to %.6g; allowed: %s",
                    axis->key, node->text, axis->nominal, axis->unit, low, high, range);
}

/* Reads a width in the axis' unit; per cent are of its nominal value. */
static vs_status read_width(const vs_axis *axis, const vs_node *node, const char *text,
                            double *width, vs_error *err) {
  char why[256];
  double si;
  const bool relative = strchr(text, '%') != NULL;
  const bool kelvin = !strcmp(axis->unit, "degC") && strchr(text, 'K'); /* a difference of two */
  if (!vs_units_read(text, relative ? "%" : kelvin ? "K" : axis->unit, &si, why, sizeof why))
    return vs_fail_at(err, node->where, "%s: %s, or a part of its value in %%", axis->key, why);
  if (isnan(axis->nominal))
    return vs_fail_at(err, node->where,
                      "%s: the scene has no number there to spread about; write "
                      "{from: A, to: B} or [A, B, ...]",
                      axis->key);
  if (relative && axis->nominal == 0)
    return vs_fail_at(err, node->where,
                      "%s: it is 0 in the scene, and any per cent of that are 0; write for example "
                      "'1 %s normal'",
                      axis->key, axis->unit);
  *width = relative ? si * fabs(axis->nominal) : si / vs_units_factor(axis->unit);
  if (*width > 0) return VS_OK;
  return vs_fail_at(err, node->where, "%s: a spread is more than 0", axis->key);
}

/* Makes the axis even between two parts of its nominal value. Errors: it has none, or is 0; an end
 * is out of the key's range. */
static vs_status read_parts(vs_axis *axis, const vs_node *node, const double part[2],
                            vs_error *err) {
  const double low = axis->nominal * part[0], high = axis->nominal * part[1];
  const vs_field *f = axis->field;
  char range[128];
  if (isnan(axis->nominal) || axis->nominal == 0)
    return vs_fail_at(err, node->where,
                      "%s: the scene has no number there of which '%s' is a part; 'A .. B' is "
                      "wanted",
                      axis->key, node->text);
  if (axis->is_word || f->kind == VS_COUNT || !(part[0] < part[1]))
    return vs_fail_at(err, node->where,
                      axis->is_word || f->kind == VS_COUNT
                          ? "%s: '%s' needs a key with values in between; [A, B, ...] is wanted"
                          : "%s: '%s': two different ends are wanted, the lesser first",
                      axis->key, node->text);
  if (fmin(low, high) < f->min || fmax(low, high) > f->max ||
      (f->open && (fmin(low, high) <= f->min || fmax(low, high) >= f->max))) {
    vs_field_range(f, range, sizeof range);
    return vs_fail_at(err, node->where, "%s: '%s' of %.6g %s goes from %.6g to %.6g; allowed: %s",
                      axis->key, node->text, axis->nominal, axis->unit, low, high, range);
  }
  axis->ranged = true;
  axis->from = vs_text_rounded(low, 12);
  axis->to = vs_text_rounded(high, 12);
  return VS_OK;
}

/* True for '-20 % .. 5 %' of an axis that is not in per cent itself. */
static bool is_parts(const vs_axis *axis, const vs_node *node) {
  return strstr(node->text, " .. ") && strchr(node->text, '%') && strcmp(axis->unit, "%") != 0;
}

static vs_status read_percents(vs_axis *axis, const vs_node *node, vs_error *err) {
  const char *dots = strstr(node->text, " .. ");
  char *first = vs_alloc_part(node->text, (size_t)(dots - node->text)), why[256];
  double part[2];
  const bool good = vs_units_read(first, "%", &part[0], why, sizeof why) &&
                    vs_units_read(dots + strlen(" .. "), "%", &part[1], why, sizeof why);
  free(first);
  if (!good) return misread(axis, node, err);
  for (int k = 0; k < 2; k++) part[k]++;
  return read_parts(axis, node, part, err);
}

/* Reads the spread in words of a part's file, or a range in text. False: it is neither. */
static bool is_between(vs_axis *axis, const vs_node *node, const vs_scene *scene, vs_status *status,
                       vs_error *err) {
  double part[2] = {1, 1};
  if (is_parts(axis, node))
    *status = read_percents(axis, node, err);
  else if (strstr(node->text, " .. "))
    *status = vs_axis_values(axis, node, err);
  else if (vs_key_is_figure(node->text)) {
    *status = vs_key_figures(scene, axis->key, node->text, node->where, part, err);
    if (!*status) *status = read_parts(axis, node, part, err);
  } else
    return false;
  return true;
}

static vs_status read_span(vs_axis *axis, const vs_node *node, const vs_scene *scene, double sigmas,
                           vs_error *err) {
  char text[128], *shape;
  vs_status read;
  vs_span span = {0};
  if (axis->about &&
      (node->kind != VS_NODE_TEXT || !strchr(node->text, '%') || strstr(node->text, " .. ")))
    return vs_fail_at(err, node->where,
                      "%s: it stands under vary, too, so that a tolerance of what that has is "
                      "wanted here, in %%, as '5 %% uniform'",
                      axis->key);
  if (node->kind != VS_NODE_TEXT) return vs_axis_values(axis, node, err);
  if (is_between(axis, node, scene, &read, err)) return read;
  snprintf(text, sizeof text, "%s", node->text);
  if (!take_cut(text, &span.spread.truncate) || !(shape = last_word(text)))
    return misread(axis, node, err);
  if (!strcmp(shape, "normal"))
    span.spread.shape = VS_SHAPE_NORMAL;
  else if (strcmp(shape, "uniform") || span.spread.truncate != 0)
    return misread(axis, node, err);
  if (axis->is_word || axis->field->kind == VS_COUNT)
    return vs_fail_at(err, node->where, "%s: it has no values in between; write [A, B, ...]",
                      axis->key);
  vs_status status = read_width(axis, node, text, &span.spread.width, err);
  if (status) return status;
  double cut = span.spread.truncate != 0 ? span.spread.truncate : sigmas;
  span.reach = span.spread.width * (span.spread.shape == VS_SHAPE_NORMAL ? cut : 1);
  status = check_reach(axis, node, span.reach, err);
  if (status) return status;
  free(axis->own);
  axis->own = vs_alloc(1, sizeof span);
  memcpy(axis->own, &span, sizeof span);
  return VS_OK;
}

static vs_status add_spread(vs_plan *plan, const vs_node *node, const char *by, double sigmas,
                            vs_error *err) {
  vs_axis *axis;
  vs_status status = vs_plan_axis(plan, node, by, &axis, err);
  return status ? status : read_span(axis, node, plan->base, sigmas, err);
}

/* Adds an axis for each device of the kind: its factor NAME_scale, else its value. */
static vs_status add_kind(vs_plan *plan, const vs_node *node, const char *by, double sigmas,
                          vs_error *err) {
  static const char *const FORMS[] = {"circuit.%s_scale", "circuit.%s"};
  const vs_deck *deck = &plan->base->setup.deck;
  vs_status status = VS_OK;
  size_t found = 0;
  for (size_t k = 0; k < deck->n_devices && !status; k++) {
    const vs_device *d = &deck->devices[k];
    if (!d->kind || strcmp(d->kind->name, node->key) != 0) continue;
    for (size_t n = 0; n < 2; n++) {
      char name[VS_KEY_SIZE];
      vs_key key;
      vs_error none = {0};
      snprintf(name, sizeof name, FORMS[n], d->name);
      if (vs_key_find(plan->base, name, node->key_where, &key, &none) || isnan(vs_key_number(&key)))
        continue;
      vs_node one = *node;
      one.key = name;
      status = add_spread(plan, &one, by, sigmas, err);
      found++;
      break;
    }
  }
  if (found || status) return status;
  return vs_fail_at(err, node->key_where,
                    "%s: no device of that kind has a value or a factor that could spread; a key "
                    "is wanted, as circuit.r1 or circuit.varistor_1_scale",
                    node->key);
}

vs_status vs_span_read_map(vs_plan *plan, const vs_node *map, const char *by, double sigmas,
                           vs_error *err) {
  vs_status status = VS_OK;
  for (const vs_node *node = map->child; node && !status; node = node->next) {
    const bool kind = vs_kinds_find(node->key);
    status = vs_error_keep(err, (kind ? add_kind : add_spread)(plan, node, by, sigmas, err));
  }
  return status;
}

static bool is_continuous(const vs_axis *axis) {
  return axis->ranged && axis->field->kind != VS_COUNT;
}

size_t vs_span_levels(const vs_axis *axis) {
  return axis->own || is_continuous(axis) ? 0 : axis->n_values;
}

double vs_span_between(const vs_axis *axis, double u) {
  const vs_span *span = axis->own;
  if (span) return axis->nominal + span->reach * (2 * u - 1);
  if (!is_continuous(axis))
    return axis->value[(size_t)fmin(u * (double)axis->n_values, (double)(axis->n_values - 1))];
  return vs_axis_between(axis, u);
}

double vs_span_at(const vs_axis *axis, double u) {
  const vs_span *span = axis->own;
  return span ? axis->nominal + vs_random_spread_at(&span->spread, u) : vs_span_between(axis, u);
}

double vs_span_nominal(const vs_axis *axis) {
  if (!axis->is_word && !isnan(axis->nominal)) return axis->nominal;
  return axis->n_values ? axis->value[0] : axis->from;
}

double vs_span_period(const vs_plan *plan, const vs_axis *axis) {
  const vs_setup *setup = &plan->base->setup;
  const double hz = setup->timeline.supply.frequency_hz;
  const bool angle = vs_units_same_kind(axis->unit, "deg");
  if (axis->is_word || axis->log || vs_span_levels(axis) ||
      !(angle || vs_units_same_kind(axis->unit, "s")))
    return 0;
  const double length =
      (vs_span_between(axis, 1) - vs_span_between(axis, 0)) * vs_units_factor(axis->unit);
  const double length_s = angle ? length / (2 * M_PI * hz) : length;
  double period_s = setup->timeline.supply.direct ? 0 : 1 / hz;
  if (vs_deck_has_port(&setup->deck, vs_port_is_modulated))
    period_s = 1 / setup->timeline.pwm.carrier_hz;
  if (vs_deck_has_port(&setup->deck, vs_port_is_burst))
    period_s = 1 / setup->timeline.firing.burst_hz;
  return period_s <= length_s / 2 ? period_s / length_s : 0;
}
