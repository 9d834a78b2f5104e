/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/loads.h"

#include <math.h>
#include <stdlib.h>

#include "base/text.h"
#include "plant/build.h"

/* ---- the events ---- */

/* The event that changes the load next behind `before`, NULL: behind the beginning; or NULL: there
 * is none. */
static const vs_occurrence *next_change(const vs_events *events, const vs_occurrence *before) {
  const vs_occurrence *next = NULL;
  for (size_t k = 0; k < events->count; k++) {
    const vs_occurrence *e = &events->item[k];
    bool later = !before || e->start_s > before->start_s;
    if (e->kind->load && later && (!next || e->start_s < next->start_s)) next = e;
  }
  return next;
}

static vs_status check(const vs_events *events, const vs_machine *machine, vs_error *err) {
  for (size_t k = 0; k < events->count; k++) {
    const vs_occurrence *e = &events->item[k];
    double fraction = NAN, volume_m3 = NAN;
    if (!e->kind->load) continue;
    if (machine->load.adds < 0)
      return vs_fail_at(err, e->where,
                        "events.%s: machine %s has no load (its file has no key load) that could "
                        "change; leave the event out",
                        e->name, machine->path);
    e->kind->load(e, &fraction, &volume_m3);
    if (isnan(fraction) && isnan(volume_m3))
      return vs_fail_at(err, e->where,
                        "events.%s: 'fraction' or 'volume' is wanted: what the load becomes",
                        e->name);
    for (size_t n = 0; n < k; n++)
      if (events->item[n].kind->load && events->item[n].start_s == e->start_s)
        return vs_fail_at(err, e->where, "events.%s: it clashes with events.%s: at the same time",
                          e->name, events->item[n].name);
  }
  return VS_OK;
}

/* ---- the machines ---- */

vs_status vs_loads_make(const vs_events *events, vs_machine *machine, vs_model *model,
                        vs_loads *loads, vs_error *err) {
  size_t count = 0;
  vs_loads_free(loads);
  for (size_t k = 0; k < events->count; k++) count += events->item[k].kind->load != NULL;
  model->reloaded = count > 0;
  vs_status s = count ? check(events, machine, err) : VS_OK;
  if (s || !count) return s;
  loads->item = vs_alloc(count, sizeof *loads->item);
  const vs_model *from = model;
  for (const vs_occurrence *e = NULL; (e = next_change(events, e)) && !s; loads->count++) {
    vs_loaded *to = &loads->item[loads->count];
    vs_load_values load = from->load;
    double fraction = NAN;
    e->kind->load(e, &fraction, &load.volume_m3);
    if (!isnan(fraction)) load.fraction = fraction;
    to->at_s = e->start_s;
    s = vs_build_loaded(machine, from, &load, isnan(fraction) ? from->riding : fraction, &to->model,
                        err);
    from = &to->model;
  }
  return s;
}

void vs_loads_free(vs_loads *loads) {
  free(loads->item);
  *loads = (vs_loads){0};
}

const vs_occurrence *vs_loads_event(const vs_events *events, double at_s) {
  for (size_t k = 0; k < events->count; k++)
    if (events->item[k].kind->load && events->item[k].start_s == at_s) return &events->item[k];
  return NULL;
}

double vs_loads_at(const vs_loads *loads, size_t k) {
  return k < loads->count ? loads->item[k].at_s : INFINITY;
}
