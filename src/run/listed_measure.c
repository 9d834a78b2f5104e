/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/listed_measure.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"

static void set_text(vs_listed_measure *m, const char *format, const char *word) {
  snprintf(m->text, sizeof m->text, format, word);
}

/* The k-th of all devices' measures, in the unit of its kind. False: there are no more. */
static bool device_measure_at(const vs_devices *devices, size_t k, vs_listed_measure *m) {
  for (size_t d = 0; devices && d < devices->count; k -= devices->item[d++].count) {
    const vs_watched *w = &devices->item[d];
    if (k >= w->count) continue;
    const vs_reduced *r = &w->reduced[k];
    snprintf(m->name, sizeof m->name, "%s.%s", w->device->name, r->measure->name);
    snprintf(m->of, sizeof m->of, "%s", w->device->name);
    m->unit = r->measure->unit;
    m->value = r->value;
    m->value.value /= vs_units_factor(m->unit);
    if (r->limit) m->limit = r->limit->value / vs_units_factor(m->unit);
    m->at_least = r->measure->held == VS_AT_LEAST;
    m->unjudged = r->unjudged;
    m->over_v = r->over_v;
    m->group = VS_SHOWN_DEVICES;
    m->doubled = r->measure->how == VS_R_RISE_ERROR; /* it stands with dv_dt */
    set_text(m, "%s", r->measure->text);
    return true;
  }
  return false;
}

/* The k-th measure of the quality of currents. False: there are no more. */
static bool shown_quality_at(const vs_result *r, int k, vs_listed_measure *m) {
  vs_quality_measure of;
  for (int q = 0; q < r->n_quality; q++)
    for (int n = 0; vs_quality_at(&r->quality[q], n, false, &of); n++)
      if (k-- == 0) {
        snprintf(m->name, sizeof m->name, "%s", of.name);
        m->unit = of.unit;
        m->value = of.value;
        m->group = VS_SHOWN_QUALITY;
        set_text(m, "%s", of.text);
        return true;
      }
  return false;
}

/* How many measures the devices have. */
static int of_devices(const vs_devices *devices) {
  int n = 0;
  for (size_t d = 0; devices && d < devices->count; d++) n += (int)devices->item[d].count;
  return n;
}

/* By slot of the standard measures; the coordinates' are motion. */
static const vs_listed_measure_group GROUPS[VS_STANDARD_MEASURES] = {
    [VS_M_I_PEAK] = VS_SHOWN_ELECTRICAL,       [VS_M_T_FIRE] = VS_SHOWN_ELECTRICAL,
    [VS_M_T_EXTINCTION] = VS_SHOWN_ELECTRICAL, [VS_M_CONDUCTION] = VS_SHOWN_ELECTRICAL,
    [VS_M_ENERGY_IN] = VS_SHOWN_ENERGY,        [VS_M_ENERGY_COPPER] = VS_SHOWN_ENERGY,
    [VS_M_WORK_FORCE] = VS_SHOWN_ENERGY,       [VS_M_ENERGY_RESIDUAL] = VS_SHOWN_ENERGY};

/* True for a measure of the gap that also has the name of the one coordinate which opens it. */
static bool is_doubled(const vs_model *model, const vs_measure *m) {
  static const int OF_GAP[] = {VS_M_GAP_FIRST, VS_M_GAP_SECOND, VS_M_GAP_MIN, VS_M_GAP_MAX,
                               VS_M_TAU_GAP};
  bool of_gap = false;
  for (size_t k = 0; k < sizeof OF_GAP / sizeof *OF_GAP; k++)
    of_gap = of_gap || (m->slot == OF_GAP[k] && strstr(m->name, "gap"));
  return of_gap && vs_measure_has_alias(model);
}

static double rating_of(const vs_deck *deck, int probe, int sense) {
  for (size_t k = 0; k < deck->n_ratings; k++)
    if (deck->ratings[k].probe == probe)
      return sense < 0 ? deck->ratings[k].min : deck->ratings[k].max;
  return NAN;
}

bool vs_listed_measure_at(const vs_frame *frame, const vs_result *r, int k, vs_listed_measure *m) {
  m->limit = NAN;
  m->limit_unit = NULL;
  m->at_least = false;
  m->over_v = 0;
  m->unjudged = NULL;
  m->channel = -1;
  m->doubled = false;
  *m->of = '\0';
  vs_measure of_machine;
  if (vs_measure_at(frame->model, k, &of_machine)) {
    snprintf(m->name, sizeof m->name, "%s", of_machine.name);
    const int of = (of_machine.slot - VS_STANDARD_MEASURES) / VS_OF_COORDINATE;
    if (of_machine.slot >= VS_STANDARD_MEASURES)
      snprintf(m->of, sizeof m->of, "%s", frame->model->machine->coordinates[of].name);
    set_text(m, "%s", of_machine.text);
    m->unit = of_machine.unit;
    m->value = r->values[of_machine.slot];
    m->value.value *= of_machine.factor;
    m->group = of_machine.slot < VS_STANDARD_MEASURES ? GROUPS[of_machine.slot] : VS_SHOWN_MOTION;
    m->doubled = is_doubled(frame->model, &of_machine);
    return true;
  }
  const vs_measures *measures = r->watchers.measures;
  k += measures->of_probes - vs_measures_count(frame->model); /* the others are shown already */
  if (k >= measures->n_extremes)
    return device_measure_at(r->watchers.devices, (size_t)(k - measures->n_extremes), m) ||
           shown_quality_at(r, k - measures->n_extremes - of_devices(r->watchers.devices), m);
  const vs_extreme *e = &measures->extremes[k];
  vs_channel channel = vs_channel_at(frame, e->channel);
  snprintf(m->name, sizeof m->name, "%s_%s", channel.name, e->sense < 0 ? "min" : "max");
  snprintf(m->of, sizeof m->of, "%s", channel.name);
  m->unit = channel.unit;
  m->value = e->best;
  m->group = VS_SHOWN_ELECTRICAL;
  m->channel = e->channel;
  m->at_least = e->sense < 0;
  if (frame->deck)
    m->limit = rating_of(frame->deck, e->channel - vs_channel_deck(frame->model), e->sense) /
               vs_units_factor(m->unit);
  set_text(m, e->sense < 0 ? "least %s" : "largest %s", channel.text);
  return true;
}

/* ---- the verdict's lines ---- */

/* A line that a scene may have: its name, whose it is, its limit where it has one alone, and the
 * unit of that. */
typedef struct line {
  char name[VS_JUDGED_NAME - 8]; /* "margin." goes before it */
  const char *of, *unit;
  double limit; /* in unit; NaN: two ends, or the part does not state it */
  bool at_least;
} line;

static bool is_first_of_probe(const vs_deck *deck, size_t k) {
  size_t first = 0;
  while (deck->ratings[first].probe != deck->ratings[k].probe) first++;
  return first == k;
}

static void name_line(line *l, const char *of, const char *measure) {
  snprintf(l->name, sizeof l->name, "%s%s%s", of, *measure ? "." : "", measure);
  l->of = of;
}

/* A rating of one end has this limit. */
static void take_ends(line *l, const vs_rating *r) {
  l->unit = r->unit;
  if (isinf(r->min) == isinf(r->max)) return;
  l->at_least = isinf(r->max);
  l->limit = (l->at_least ? r->min : r->max) / vs_units_factor(r->unit);
}

/* The n-th line of the deck's ratings, less those it has. False: *n is what is left of it. */
static bool deck_line_at(const vs_deck *deck, int *n, line *l) {
  for (size_t k = 0; deck && k < deck->n_ratings; k++)
    if (is_first_of_probe(deck, k) && (*n)-- == 0) {
      name_line(l, deck->probes[deck->ratings[k].probe].name, "");
      take_ends(l, &deck->ratings[k]);
      return true;
    }
  return false;
}

static bool own_line_at(const vs_ratings *ratings, int *n, line *l) {
  if (*n >= ratings->count) {
    *n -= ratings->count;
    return false;
  }
  name_line(l, ratings->item[*n].name, "");
  take_ends(l, &ratings->item[*n].rating);
  return true;
}

static bool device_line_at(const vs_devices *devices, int *n, line *l) {
  for (size_t d = 0; devices && d < devices->count; d++) {
    const vs_watched *w = &devices->item[d];
    for (size_t k = 0; k < w->count; k++) {
      const vs_reduced *r = &w->reduced[k];
      if (!r->limit && !vs_devices_lacks(w->deck, w->device, r->measure)) continue;
      if ((*n)-- > 0) continue;
      name_line(l, w->device->name, r->measure->name);
      l->unit = r->limit ? r->limit->unit : r->measure->unit;
      l->at_least = r->measure->held == VS_AT_LEAST;
      if (r->limit) l->limit = r->limit->value / vs_units_factor(l->unit);
      return true;
    }
  }
  return false;
}

static bool line_at(const vs_frame *frame, const vs_result *r, int n, line *l) {
  *l = (line){.limit = NAN};
  return deck_line_at(frame->deck, &n, l) || own_line_at(&r->scene->ratings, &n, l) ||
         device_line_at(r->watchers.devices, &n, l);
}

static const struct {
  const char *name, *text, *unit;
} NUMBERS[VS_LINE_NUMBERS] = {{"margin", "margin of %s, a part of its limit", ""},
                              {"error", "numerical error of the margin of %s", ""},
                              {"at", "instant of the stress that the margin of %s is of", "s"}};

bool vs_listed_line_is(const char *name) {
  for (int k = 0; k < VS_LINE_NUMBERS; k++) {
    const size_t n = strlen(NUMBERS[k].name);
    if (!strncmp(name, NUMBERS[k].name, n) && name[n] == '.') return true;
  }
  return false;
}

bool vs_listed_line_is_of(const char *number, const vs_judgement *j) {
  const char *name = strchr(number, '.') + 1;
  if (vs_verdict_is_happening(j)) return false;
  if (!j->device) return !strcmp(name, j->name ? j->name : j->probe->name);
  const size_t n = strlen(j->device->name);
  return !strncmp(name, j->device->name, n) && name[n] == '.' &&
         !strcmp(name + n + 1, j->measure->name);
}

const vs_judgement *vs_listed_line_find(const vs_verdict *v, const char *number) {
  const vs_judgement *found = NULL;
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    if (!vs_listed_line_is_of(number, j)) continue;
    if (!found || j->margin < found->margin) found = j;
  }
  return found;
}

vs_value vs_listed_line_value(const vs_judgement *j, const char *number) {
  const bool is_margin = *number == *NUMBERS[0].name;
  if (!j) return (vs_value){false, NAN, NAN};
  const double value = is_margin                     ? j->margin
                       : *number == *NUMBERS[1].name ? j->margin_error
                                                     : j->stress.at_s;
  return (vs_value){is_margin || !isnan(value), value, NAN};
}

bool vs_listed_line_at(const vs_frame *frame, const vs_result *r, int k, vs_listed_measure *m) {
  const int which = k % VS_LINE_NUMBERS;
  line l;
  if (!line_at(frame, r, k / VS_LINE_NUMBERS, &l)) return false;
  *m = (vs_listed_measure){.unit = NUMBERS[which].unit,
                           .limit = which ? NAN : l.limit,
                           .limit_unit = which ? NULL : l.unit,
                           .at_least = l.at_least,
                           .group = VS_SHOWN_DEVICES,
                           .channel = -1};
  snprintf(m->name, sizeof m->name, "%s.%s", NUMBERS[which].name, l.name);
  snprintf(m->of, sizeof m->of, "%s", l.of);
  set_text(m, NUMBERS[which].text, l.name);
  m->value = vs_listed_line_value(vs_listed_line_find(&r->verdict, m->name), m->name);
  return true;
}
