/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "method/span.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"
#include "base/units.h"

static vs_status misread(const vs_axis *axis, const vs_node *node, vs_error *err) {
  const char *unit = *axis->unit ? axis->unit : "1";
  return vs_fail_at(err, node->where,
                    "%s: '%s' is no spread; write '5 %% normal', '5 %% normal within 2 sigma', "
                    "'10 %% uniform', '1 %s uniform', {from: A, to: B} or [A, B, ...]",
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
  if (!vs_units_read(text, relative ? "%" : axis->unit, &si, why, sizeof why))
    return vs_fail_at(err, node->where, "%s: %s, or a part of its value in %%", axis->key, why);
  if (isnan(axis->nominal))
    return vs_fail_at(err, node->where,
                      "%s: the scene has no number there to spread about; write "
                      "{from: A, to: B} or [A, B, ...]",
                      axis->key);
  if (relative && axis->nominal == 0)
    return vs_fail_at(err, node->where,
                      "%s: it is 0 in the scene, of which no part is anything; write for example "
                      "'1 %s normal'",
                      axis->key, axis->unit);
  *width = relative ? si * fabs(axis->nominal) : si / vs_units_factor(axis->unit);
  if (*width > 0) return VS_OK;
  return vs_fail_at(err, node->where, "%s: a spread is more than 0", axis->key);
}

vs_status vs_span_read(vs_axis *axis, const vs_node *node, double sigmas, vs_error *err) {
  char text[128], *shape;
  vs_span span = {0};
  if (axis->about && (node->kind != VS_NODE_TEXT || !strchr(node->text, '%')))
    return vs_fail_at(err, node->where,
                      "%s: it stands under vary, too, so that a tolerance of what that has is "
                      "wanted here, in %%, as '5 %% uniform'",
                      axis->key);
  if (node->kind != VS_NODE_TEXT) return vs_axis_values(axis, node, err);
  snprintf(text, sizeof text, "%s", node->text);
  if (!take_cut(text, &span.spread.truncate) || !(shape = last_word(text)))
    return misread(axis, node, err);
  if (!strcmp(shape, "normal"))
    span.spread.shape = VS_SHAPE_NORMAL;
  else if (strcmp(shape, "uniform") || span.spread.truncate != 0)
    return misread(axis, node, err);
  if (axis->is_word || axis->field->kind == VS_COUNT)
    return vs_fail_at(err, node->where, "%s: it is no continuum; write [A, B, ...]", axis->key);
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
  if (u <= 0) return axis->from; /* exact at both ends */
  if (u >= 1) return axis->to;
  return axis->log ? axis->from * pow(axis->to / axis->from, u)
                   : axis->from + u * (axis->to - axis->from);
}

double vs_span_at(const vs_axis *axis, double u) {
  const vs_span *span = axis->own;
  return span ? axis->nominal + vs_random_spread_at(&span->spread, u) : vs_span_between(axis, u);
}

double vs_span_nominal(const vs_axis *axis) {
  if (!axis->is_word && !isnan(axis->nominal)) return axis->nominal;
  return axis->n_values ? axis->value[0] : axis->from;
}
