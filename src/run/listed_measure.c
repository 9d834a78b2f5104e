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
    [VS_M_WORK_FORCE] = VS_SHOWN_ENERGY,       [VS_M_ENERGY_RESIDUAL] = VS_SHOWN_ENERGY,
    [VS_M_COIL_T] = VS_SHOWN_ELECTRICAL};

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
  *m = (vs_listed_measure){.limit = NAN, .channel = -1};
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
    if (of_machine.slot == VS_M_PULL_IN && *r->no_pull_in)
      m->absent = r->no_pull_in + strlen("pull_in ");
    if (of_machine.slot == VS_M_RELEASE && !m->value.known && *r->lets_go) m->absent = r->lets_go;
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
