/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "watch/verdict.h"

#include <math.h>
#include <stdio.h>

/* What `room` to a limit is as a part of the limit; infinite where there is none. A limit of 0 says
 * which sign the probe may have: to keep it is no margin, however near to 0 the probe comes. Beyond
 * it by more than the slack, what it is beyond is a part of the range; of the probe's largest
 * magnitude where the other end is none, or 0 as well. */
static double part_of(double room, double limit, const vs_measures *m, const vs_judgement *j) {
  double range = j->rating->max - j->rating->min;
  if (isinf(limit)) return INFINITY;
  if (limit != 0) return room / fabs(limit);
  if (room >= -vs_measures_slack(m, j->rating)) return INFINITY;
  bool scaled = isfinite(range) && range > 0;
  return room / (scaled ? range : fmax(fabs(j->least.value), fabs(j->largest.value)));
}

static vs_judgement judge_rating(const vs_measures *m, size_t k) {
  const vs_deck *deck = m->frame->deck;
  const vs_rating *r = &deck->ratings[k];
  const vs_extreme *pair = &m->extremes[VS_STANDARD_EXTREMES + 2 * r->probe];
  vs_judgement j = {.rating = r,
                    .probe = &deck->probes[r->probe],
                    .least = pair[0].best,
                    .largest = pair[1].best,
                    .stress = pair[0].best};
  double below = part_of(j.least.value - r->min, r->min, m, &j);
  double above = part_of(r->max - j.largest.value, r->max, m, &j);
  j.margin = fmin(below, above);
  if (above < below) j.stress = j.largest;
  j.failed_s = j.margin < 0 ? m->passed_s[k] : NAN;
  if (j.margin < 0 && isnan(j.failed_s)) j.failed_s = j.stress.at_s; /* between two knots only */
  return j;
}

static vs_judgement judge_device(const vs_deck *deck, const vs_device *d, const vs_reduced *r) {
  double limit = r->limit->value, stress = r->value.value;
  return (vs_judgement){
      .device = d,
      .measure = r->measure,
      .limit = r->limit,
      .ward = r->measure->held == VS_WARD_AT_MOST ? &deck->devices[d->protects] : NULL,
      .margin = (r->measure->held == VS_AT_LEAST ? stress - limit : limit - stress) / limit,
      .stress = r->value,
      .failed_s = r->failed_s};
}

void vs_verdict_reach(const vs_measures *m, const vs_devices *devices, vs_verdict *v) {
  *v = (vs_verdict){0};
  for (size_t k = 0; m->frame->deck && k < m->frame->deck->n_ratings; k++)
    v->item[v->count++] = judge_rating(m, k);
  for (size_t k = 0; devices && k < devices->count; k++)
    for (size_t n = 0; n < devices->item[k].count; n++) {
      const vs_reduced *r = &devices->item[k].reduced[n];
      if (r->limit && r->value.known)
        v->item[v->count++] = judge_device(devices->frame->deck, devices->item[k].device, r);
    }
  for (size_t k = 0; k < v->count; k++) {
    const vs_judgement *j = &v->item[k];
    if (isfinite(j->margin) && (!v->weakest || j->margin <= v->weakest->margin)) v->weakest = j;
    if (j->margin < 0 && !j->ward &&
        (!v->first_to_fail || j->failed_s <= v->first_to_fail->failed_s))
      v->first_to_fail = j;
  }
}

const char *vs_judgement_name(const vs_judgement *j, char name[VS_JUDGED_NAME]) {
  snprintf(name, VS_JUDGED_NAME, "%s%s%s", j->device ? j->device->name : j->probe->name,
           j->device ? "." : "", j->device ? j->measure->name : "");
  return name;
}

const char *vs_judgement_unit(const vs_judgement *j) {
  return j->device ? j->limit->unit : j->rating->unit;
}
