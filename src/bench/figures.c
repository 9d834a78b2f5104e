/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "figures.h"

#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/parts.h"

void vs_figures_free(vs_figures *f) {
  for (size_t k = 0; k < f->n_curves; k++) free(f->curve[k].x);
  *f = (vs_figures){0};
}

/* ---- what is asked ---- */

/* The line of the part's file that declares this parameter; no file where none does. */
static vs_where line_of_param(const vs_stand *s, const char *name) {
  FILE *f = s->file ? fopen(s->file, "r") : NULL;
  char *line = NULL, found[VS_DECK_NAME];
  size_t size = 0;
  vs_where where = {0};
  for (int n = 1; f && !where.file && vs_alloc_line(&line, &size, f) >= 0; n++)
    if (sscanf(line, " *$ param %63[^ \t=]", found) == 1 && !strcasecmp(found, name))
      where = (vs_where){s->name, n, 1};
  free(line);
  if (f) fclose(f);
  return where;
}

vs_figures_asked vs_figures_param(const vs_stand *s, const char *name) {
  for (size_t k = 1; k < s->deck.section.count; k++) {
    const vs_field *field = &s->deck.section.fields[k];
    if (field->kind != VS_REAL || strcmp(field->key, name)) continue;
    double value = *(const double *)(const void *)((const char *)&s->values + field->offset);
    return (vs_figures_asked){value, line_of_param(s, name)};
  }
  return (vs_figures_asked){NAN, {0}};
}

vs_figures_asked vs_figures_own(const vs_stand *s, const char *word) {
  char name[2 * VS_DECK_NAME];
  snprintf(name, sizeof name, "%s_%s", s->subcircuit, word);
  return vs_figures_param(s, name);
}

vs_figures_asked vs_figures_any(const vs_stand *s, const char *name) {
  const vs_part_file *file = vs_parts_file(&s->deck, s->file);
  vs_figures_asked asked = vs_figures_param(s, name);
  char kind_name[2 * VS_DECK_NAME];
  if (isnan(asked.value)) asked = vs_figures_own(s, name);
  snprintf(kind_name, sizeof kind_name, "%s_%s", file ? file->kind : "", name);
  return isnan(asked.value) ? vs_figures_param(s, kind_name) : asked;
}

vs_figures_asked vs_figures_limit(const vs_stand *s, const char *name) {
  const vs_limit *limit = vs_parts_find_limit(&s->deck, s->file, name);
  if (!limit || !isfinite(limit->value)) return (vs_figures_asked){NAN, {0}};
  return (vs_figures_asked){limit->value, {s->name, limit->where.line, limit->where.column}};
}

double vs_figures_first(const vs_stand *s, const char *const *names, double otherwise) {
  for (; *names; names++) {
    const double value[] = {vs_figures_limit(s, *names).value, vs_figures_any(s, *names).value};
    for (int k = 0; k < 2; k++)
      if (isfinite(value[k])) return value[k];
  }
  return otherwise;
}

double vs_figures_condition(const vs_stand *s, bool own, const char *const limit_param[2],
                            double otherwise) {
  return vs_figures_first(s, (const char *[]){limit_param[own], limit_param[!own], NULL},
                          otherwise);
}

/* ---- rows ---- */

vs_figure *vs_figures_add(vs_figures *f, const char *name, const char *unit, vs_figures_asked asked,
                          double tolerance, vs_held held) {
  assert(f->count < VS_MOST_FIGURES);
  vs_figure *row = &f->row[f->count++];
  *row = (vs_figure){.name = name,
                     .unit = unit,
                     .held = isfinite(asked.value) ? held : VS_HELD_NOT,
                     .asked = asked.value,
                     .sheet = NAN,
                     .got = NAN,
                     .tolerance = tolerance * fabs(asked.value),
                     .where = asked.where};
  return row;
}

void vs_figures_is(vs_figure *row, const vs_stand *s, const char *name) {
  const double limit = vs_figures_limit(s, name).value;
  row->of = name;
  row->sheet = isfinite(limit) ? limit : row->asked;
}

double vs_figures_deviation(const vs_figures *f, const char *name) {
  double furthest = NAN;
  for (size_t k = 0; k < f->count; k++) {
    const vs_figure *row = &f->row[k];
    if (!row->of || strcmp(row->of, name)) continue;
    double own = row->got / row->sheet - 1;
    if (isfinite(own) && !(fabs(own) <= fabs(furthest))) furthest = own;
  }
  return furthest;
}

vs_figures_curve *vs_figures_add_curve(vs_figures *f, size_t points) {
  if (f->n_curves >= VS_MOST_CURVES || points < 2) return NULL;
  vs_figures_curve *c = &f->curve[f->n_curves++];
  *c = (vs_figures_curve){.points = points, .x = vs_alloc(2 * points, sizeof(double))};
  c->y = c->x + points;
  return c;
}

const char *vs_figures_word(const vs_figure *row) {
  if (isnan(row->got)) return "failed";
  double over = row->got - row->asked;
  switch (row->held) {
  case VS_HELD_NEAR:
    return fabs(over) <= row->tolerance ? "held" : "off";
  case VS_HELD_AT_MOST:
    return over <= row->tolerance ? "held" : "off";
  case VS_HELD_AT_LEAST:
    return -over <= row->tolerance ? "held" : "off";
  default:
    return "seen";
  }
}

/* ---- a figure that divides ---- */

void vs_figures_find(const vs_stand *stand, vs_figures_test test, const void *ctx, double guess,
                     vs_figure *row) {
  static const int MOST = 10;
  static const double FINE = 1.02;
  vs_error err = {0};
  bool yes = false, upwards = false;
  double low = guess / 1.2, high = guess * 1.2;
  vs_status status = test(stand, ctx, high, &yes, &err);
  upwards = !yes;
  for (int n = 0; !status && upwards && !yes && n < MOST; n++) {
    low = high;
    high *= 2;
    status = test(stand, ctx, high, &yes, &err);
  }
  if (!status && !yes) {
    snprintf(row->why, sizeof row->why, "not reached up to %.3g times what is asked", high / guess);
    return;
  }
  for (int n = 0; !status && !upwards && yes && n <= MOST; n++) {
    status = test(stand, ctx, low, &yes, &err);
    if (!yes) break;
    high = low;
    low /= 2;
  }
  if (!status && !upwards && yes) {
    snprintf(row->why, sizeof row->why, "below %.3g of what is asked", high / guess);
    return;
  }
  while (!status && high > FINE * low) {
    double middle = sqrt(low * high);
    status = test(stand, ctx, middle, &yes, &err);
    if (yes)
      high = middle;
    else
      low = middle;
  }
  if (status)
    snprintf(row->why, sizeof row->why, "%.190s", err.text);
  else
    row->got = sqrt(low * high);
}
