/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "devices/means.h"

#include <math.h>

/* ---- means ----
 * The limit of a mean or rms value holds for ever. On an orbit so does the value. In another run
 * the value is that of operation only behind settling and behind events: it is then judged over the
 * longest stretch of whole firing cycles that is settled, up to the end of the time meant. What a
 * single shot or a surge brings is never the mean of operation. */

/* A continuous rating says nothing of a shorter run: one pulse that the part's i2t allows would be
 * above it over 0.7 s (i2t/i_t_rms^2 of the parts that ship is 0.46 to 0.68 s). */
static const double CONTINUOUS_S = 1;

/* A stretch is settled where its two halves differ by no more than this part of the value, or than
 * this part of the limit. What they differ by counts as the value's error besides. */
static const double SETTLED = 0.05, NOT_MUCH = 0.01;

#define STEADY_JUDGES "; vibrospice steady SCENE judges it"
static const char TOO_SHORT[] = "not judged: over less than 1 s" STEADY_JUDGES,
                  ONE_SHOT[] = "not judged: one shot",
                  AN_EVENT[] =
                      "not judged: less than 1 s behind an event; vibrospice steady SCENE judges "
                      "it, where the scene has no events",
                  UNSETTLED[] = "not judged: not settled" STEADY_JUDGES;

/* Direct voltage has no orbit that `steady` could find. */
static const char *advise(const vs_watched *w, const char *why) {
  if (!w->timeline->supply.direct || !why) return why;
  return why == TOO_SHORT   ? "not judged: over less than 1 s; a run beyond 1 s judges it"
         : why == AN_EVENT  ? "not judged: less than 1 s behind an event; a longer run judges it"
         : why == UNSETTLED ? "not judged: not settled; a longer run judges it, or measure.from "
                              "behind the settling"
                            : why;
}

/* True where the scene's firing drives a gate of the deck, and fires it once. Without a gate
 * nothing but the mains makes a current, and they come again by themselves. */
static bool fires_once(const vs_watched *w) {
  const vs_firing_values *firing = &w->timeline->firing;
  return !firing->every && !firing->no_valve && vs_deck_has_port(w->deck, vs_port_is_gated);
}

/* True: only one firing falls into the time meant, which says nothing of the power or current in
 * operation. The scene fires once; or the device began to conduct there once at most, and did not
 * conduct all of the time. */
static bool is_one_shot(const vs_watched *w) {
  if (w->device->gates.count && !w->timeline->firing.every) return true;
  return w->starts < 2 && w->rests;
}

/* The last instant below to_s at which an event begins or ends; -INFINITY: there is none. */
static double last_event_s(const vs_timeline *t, double to_s) {
  double last_s = -INFINITY;
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_scene_event *e = &t->events.item[k];
    const double at_s[] = {e->on_line_s > 0 ? e->on_line_s : -INFINITY, e->start_s, e->end_s};
    for (size_t n = 0; n < sizeof at_s / sizeof *at_s; n++)
      if (at_s[n] < to_s) last_s = fmax(last_s, at_s[n]);
  }
  return last_s;
}

/* The value of a course over some of the parts: the root of a square's mean, else the mean, without
 * its sign where the measure has none. */
static double value_over(const vs_watched *w, const vs_reduced *r, size_t from, size_t to) {
  double sum = 0;
  const int of = r->measure->of;
  for (size_t k = from; k < to; k++) sum += w->parts.sum[k][of];
  const double mean = sum / ((double)(to - from) * w->parts.part_s);
  if (of == VS_OF_I2 || of == VS_OF_V2) return sqrt(fmax(mean, 0));
  return r->measure->sense ? mean : fabs(mean);
}

/* By how much the halves of the parts from `from` on differ. An odd part counts to the first. On an
 * orbit a single part is settled. */
static double unrest(const vs_watched *w, const vs_reduced *r, size_t from) {
  const size_t count = w->parts.count, half = (count - from) / 2;
  if (!half) return w->on_orbit ? 0 : INFINITY;
  return fabs(value_over(w, r, count - half, count) - value_over(w, r, from, count - half));
}

/* Finds the longest stretch that is settled, and judges over it. Returns why it does not. */
static const char *judge_settled(const vs_watched *w, vs_reduced *r, double end_s) {
  const vs_parts *p = &w->parts;
  const double event_s = last_event_s(w->timeline, end_s);
  const bool begins_on_orbit = w->on_orbit && !(event_s > -INFINITY);
  const double least_s = begins_on_orbit ? 0 : CONTINUOUS_S * (1 - 1e-9);
  const bool long_enough = end_s - p->meant_s >= least_s;
  bool behind = !(event_s > p->meant_s);
  for (size_t k = 0; k < p->count; k++) {
    const double from_s = p->from_s + (double)k * p->part_s;
    if (end_s - from_s < least_s) break;
    if (from_s < event_s) continue;
    behind = true;
    const double value = value_over(w, r, k, p->count), by = unrest(w, r, k);
    if (by > fmax(SETTLED * value, NOT_MUCH * r->limit->value)) continue;
    r->doubt = by;
    if (from_s > p->meant_s) {
      r->judged = (vs_value){true, value, NAN};
      r->judged_from_s = from_s;
    }
    return NULL;
  }
  return !long_enough ? TOO_SHORT : behind ? UNSETTLED : AN_EVENT;
}

/* A value above its limit counts as passing it at the end of the time meant. Where the scene fires
 * once, what follows the shot is not operation either; but what passes its limit there is passed.
 */
void vs_means_judge(const vs_watched *w, vs_reduced *r, double end_s) {
  if (!r->limit) return;
  if (!w->at_work) {
    r->unjudged = judge_settled(w, r, end_s);
    if (r->unjudged != TOO_SHORT && is_one_shot(w)) r->unjudged = ONE_SHOT;
  }
  const double value = r->judged.known ? r->judged.value : r->value.value;
  if (!r->unjudged && value > r->limit->value)
    r->failed_s = end_s;
  else if (!r->unjudged && !w->at_work && fires_once(w))
    r->unjudged = ONE_SHOT;
  r->unjudged = advise(w, r->unjudged);
  if (r->unjudged) r->limit = NULL;
}

double vs_means_from_s(const vs_watched *w, const vs_reduced *r, const vs_run_end *end) {
  const vs_limit any = {.value = 0};
  vs_reduced other = {.measure = r->measure, .limit = r->limit ? r->limit : &any};
  if (!w->at_work) judge_settled(w, &other, end->to_s);
  return other.judged.known ? other.judged_from_s : end->from_s;
}

const char *vs_means_of(const vs_watched *w, int of, const vs_run_end *end, double *level) {
  const vs_device_measure measure = {.how = VS_R_MEAN, .of = of, .sense = 1};
  const vs_limit any = {.value = 0}; /* against which it is asked whether a mean is known */
  vs_reduced r = {.measure = &measure, .limit = &any, .value = {true, 0, NAN}, .failed_s = NAN};
  r.value.value = w->sum_meant[of] / (end->to_s - end->from_s);
  vs_means_judge(w, &r, end->to_s);
  *level = r.value.value;
  if (r.judged.known) *level = of == VS_OF_I2 ? r.judged.value * r.judged.value : r.judged.value;
  return r.unjudged;
}

bool vs_means_is_over(const vs_watched *w) {
  if (!fires_once(w)) return false;
  return w->device->gates.count || (w->starts < 2 && w->rests);
}
