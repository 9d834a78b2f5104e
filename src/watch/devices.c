/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "watch/devices.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/text.h"

/* Of the surge that I_TSM is given for; and what the windows over it are made of. */
static const double SURGE_S = 10e-3, PART_S = 10e-3 / VS_WINDOW_PARTS;

/* A continuous rating says nothing of a shorter run: one pulse that the part's i2t allows would be
 * above it over 0.7 s (i2t/i_t_rms^2 of the parts that ship: 0.46 to 0.68 s). */
static const double CONTINUOUS_S = 1;

/* ---- beginning ---- */

static vs_quick quick(const vs_formula *formula) {
  vs_quick q = {.formula = formula};
  q.is_term = vs_formula_is_term(formula, &q.term, &q.factor);
  return q;
}

/* Is there something to be done for the measure in every step, other than of a peak? */
static bool is_busy(const vs_watched *w, const vs_reduced *r) {
  switch (r->measure->how) {
  case VS_R_PULSE:
  case VS_R_HEAT:
  case VS_R_WITHIN:
  case VS_R_SURGE:
  case VS_R_STEEPEST:
  case VS_R_GATE_LEAST:
    return true;
  case VS_R_JUNCTION:
    return w->n_zth;
  case VS_R_INTEGRAL:
    return r->limit;
  default:
    return false;
  }
}

static void begin_measures(vs_watched *w, const vs_deck *deck) {
  const vs_device *d = w->device;
  bool gate_known = !isnan(d->gate_rad);
  w->count = d->kind->n_measures;
  for (size_t k = 0; k < w->count; k++) {
    const vs_device_measure *m = &d->kind->measures[k];
    vs_reduced *r = &w->reduced[k];
    *r = (vs_reduced){m, vs_device_limit(deck, d, m), {.at_s = NAN}, .failed_s = NAN};
    if (m->how >= VS_R_MISFIRE && m->how <= VS_R_COMMUTATION_FAILURE) r->value.known = gate_known;
    if (m->how == VS_R_PEAK && (m->of != VS_OF_FLUX || d->has_flux)) w->each_step[w->n_peaks++] = r;
  }
  w->n_each_step = w->n_peaks;
  for (size_t k = 0; k < w->count; k++)
    if (is_busy(w, &w->reduced[k])) w->each_step[w->n_each_step++] = &w->reduced[k];
}

/* Of the deck's first gate; NaN: it has none. */
static double any_gate_rad(const vs_deck *deck) {
  for (size_t k = 0; k < deck->n_ports; k++)
    if (deck->ports[k].signal.drive == VS_DRIVE_GATE ||
        deck->ports[k].signal.drive == VS_DRIVE_BURST)
      return deck->ports[k].signal.shift_rad;
  return NAN;
}

static void begin_device(vs_watched *w, const vs_frame *frame, const vs_device *d) {
  const vs_deck *deck = frame->deck;
  *w = (vs_watched){
      .device = d,
      .voltage = quick(&d->voltage),
      .current = quick(&d->current),
      .gate = {.timeline = frame->timeline, .delay_rad = d->gate_rad, .edge_s = -INFINITY},
      .fresh = true,
      .shot_s = -INFINITY,
      .pulse = {.rest_s = frame->timeline->period_s / 4}};
  w->train = w->gate;
  if (isnan(d->gate_rad)) w->train.delay_rad = any_gate_rad(deck);
  if (d->has_flux) w->flux = quick(&d->flux);
  const char *file = d->part < 0 ? "" : deck->parts[d->part].file;
  for (size_t k = 0; k < deck->n_zth; k++)
    if (!strcmp(deck->zth[k].where.file, file)) w->zth[w->n_zth++] = &deck->zth[k];
  begin_measures(w, deck);
  if (!d->kind->switches) return;
  w->states = vs_alloc(1, sizeof *w->states);
  double t_q_s = INFINITY;
  for (size_t k = 0; k < w->count; k++)
    if (w->reduced[k].measure->how == VS_R_OFFERED && w->reduced[k].limit)
      t_q_s = w->reduced[k].limit->value;
  vs_switch_begin(w->states, frame->timeline, d->gate_rad, t_q_s);
}

vs_devices *vs_devices_new(const vs_frame *frame) {
  size_t count = frame->deck ? frame->deck->n_devices : 0;
  if (!count) return NULL;
  vs_devices *d = vs_alloc(1, sizeof *d + count * sizeof *d->item);
  d->frame = frame;
  d->count = count;
  d->began_s = NAN;
  d->means = frame->means;
  if (!(d->means.to_s > 0)) d->means = (vs_span_s){0, INFINITY};
  for (size_t k = 0; k < count; k++) begin_device(&d->item[k], frame, &frame->deck->devices[k]);
  return d;
}

void vs_devices_free(vs_devices *d) {
  for (size_t k = 0; d && k < d->count; k++) free(d->item[k].states);
  free(d);
}

/* ---- courses ---- */

static void evaluate(const vs_quick *q, const double *mid, const double *to, double *at_mid,
                     double *at_to) {
  if (q->is_term) {
    *at_mid = q->factor * mid[q->term];
    *at_to = q->factor * to[q->term];
    return;
  }
  double pair[2];
  vs_formula_pair(q->formula, mid, to, pair);
  *at_mid = pair[0];
  *at_to = pair[1];
}

static void complete(double course[VS_COURSES]) {
  course[VS_OF_POWER] = course[VS_OF_V] * course[VS_OF_I];
  course[VS_OF_I2] = course[VS_OF_I] * course[VS_OF_I];
}

/* ---- means ---- */

/* Adds the integrals over a part of the step, from and to as parts of its length: of the parabola
 * through its three values of v and i, which is a straight line where the formulas are such, by
 * Simpson's rule. */
static void integrate_part(const vs_course_step *c, double from, double to,
                           double sum[VS_COURSES]) {
  double y[3][VS_COURSES] = {{0}};
  for (int k = 0; k < 3; k++) {
    double s = from + (to - from) * k / 2, mid = 4 * s * (1 - s), end = s * (2 * s - 1);
    for (int of = VS_OF_V; of <= VS_OF_I; of++)
      y[k][of] = (1 - mid - end) * c->from[of] + mid * c->mid[of] + end * c->to[of];
    complete(y[k]);
  }
  for (int of = VS_OF_I; of < VS_COURSES; of++)
    sum[of] += (to - from) * c->h_s * (y[0][of] + 4 * y[1][of] + y[2][of]) / 6;
}

/* A device that goes out in a ring and is fired again by the same gate pulse is at the same shot,
 * as long as the same half cycle of the mains may drive it. */
static void follow_starts(const vs_devices *d, vs_watched *w, const vs_course_step *c) {
  vs_gate_follow(&w->train, c);
  w->fresh = w->fresh || w->train.begins;
  if (!c->on || c->was_on) return;
  bool gated = w->train.on && !isnan(w->train.delay_rad);
  bool again = gated && !w->fresh && c->t0_s - w->shot_s < d->frame->timeline->period_s / 2;
  w->fresh = false;
  if (again) return;
  w->shot_s = c->t0_s;
  w->starts += c->t1_s > d->means.from_s && c->t0_s < d->means.to_s;
}

/* more: the integrals over the whole step */
static void follow_means(const vs_devices *d, vs_watched *w, const vs_course_step *c,
                         const double more[VS_COURSES]) {
  double from_s = fmax(c->t0_s, d->means.from_s), to_s = fmin(c->t1_s, d->means.to_s);
  if (!(to_s > from_s)) return;
  w->rests = w->rests || !c->on;
  if (from_s > c->t0_s || to_s < c->t1_s)
    integrate_part(c, (from_s - c->t0_s) / c->h_s, (to_s - c->t0_s) / c->h_s, w->sum_meant);
  else
    for (int of = VS_OF_I; of < VS_COURSES; of++) w->sum_meant[of] += more[of];
}

/* ---- reductions ---- */

/* What was `before` at the step's beginning is `after` at its end: when was the limit passed? */
static void watch_limit(vs_reduced *r, const vs_course_step *c, double before, double after) {
  if (!r->limit || !isnan(r->failed_s) || !(after > r->limit->value)) return;
  double part = (r->limit->value - before) / (after - before);
  r->failed_s = c->t0_s + fmin(fmax(part, 0), 1) * c->h_s;
}

static double in_sense(double value, int sense) {
  return (sense ? sense * value : fabs(value)) + 0.0; /* no -0 */
}

static void follow_peak(vs_reduced *r, const vs_course_step *c) {
  const vs_device_measure *m = r->measure;
  double to = in_sense(c->to[m->of], m->sense);
  if (to > r->value.value) r->value = (vs_value){true, to, c->t1_s};
  if (r->limit) watch_limit(r, c, in_sense(c->from[m->of], m->sense), to);
}

/* more: the step's own integral */
static void follow_pulse(vs_reduced *r, const vs_course_step *c, double more) {
  double before = c->was_on ? r->pulse : 0;
  r->pulse = before + more;
  if (r->pulse > r->value.value) r->value = (vs_value){true, r->pulse, c->t1_s};
  watch_limit(r, c, before, r->pulse);
}

static void follow_heat(vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  double before = w->pulse.heat_j, heat = vs_pulse_follow(&w->pulse, c);
  if (heat > r->value.value) r->value = (vs_value){true, heat, c->t1_s};
  watch_limit(r, c, fmin(before, heat), heat);
}

/* What its current brings as the run ends counts whole; no pulse has more heat than the run, which
 * may be less by the rounding of integrals. */
static void end_heat(const vs_watched *w, vs_reduced *r, double now_s) {
  double heat = vs_pulse_unfinished(&w->pulse, now_s);
  if (heat > r->value.value) r->value = (vs_value){true, heat, now_s};
  r->value.value = fmin(r->value.value, fmax(w->sum[VS_OF_POWER], 0));
  if (r->limit && isnan(r->failed_s) && r->value.value > r->limit->value) r->failed_s = now_s;
}

static void window_next(vs_window *w) {
  w->now = (w->now + 1) % (VS_WINDOW_PARTS + 1);
  w->part[w->now] = w->whole = 0;
  for (size_t k = 2; k <= VS_WINDOW_PARTS; k++)
    w->whole += w->part[(w->now + k) % (VS_WINDOW_PARTS + 1)];
  w->starts_s += PART_S;
}

/* The integral after a step that adds `more`, evenly. */
static double window_add(vs_window *w, const vs_course_step *c, double more) {
  double from_s = c->t0_s;
  double skipped = floor((c->t1_s - w->starts_s) / PART_S) - VS_WINDOW_PARTS - 1;
  if (skipped > 0) w->starts_s += skipped * PART_S; /* a step longer than all of it */
  from_s = fmax(from_s, w->starts_s);
  while (c->t1_s > w->starts_s + PART_S) {
    double end_s = fmax(w->starts_s + PART_S, from_s);
    w->part[w->now] += more * (end_s - from_s) / c->h_s;
    from_s = end_s;
    window_next(w);
  }
  w->part[w->now] += more * (c->t1_s - from_s) / c->h_s;
  double oldest = w->part[(w->now + 1) % (VS_WINDOW_PARTS + 1)];
  double still_in = fmax(1 - (c->t1_s - w->starts_s) / PART_S, 0);
  return w->sum = w->whole + w->part[w->now] + still_in * oldest;
}

/* Up to 10 ms what a junction bears is a constant int i^2 dt; a half sine's is peak^2 length/2. */
static void follow_window(vs_watched *w, vs_reduced *r, const vs_course_step *c, double more) {
  bool surge = r->measure->how == VS_R_SURGE;
  double before = w->window.sum, after = window_add(&w->window, c, more);
  if (surge) before = sqrt(2 * before / SURGE_S), after = sqrt(2 * after / SURGE_S);
  if (after > r->value.value) r->value = (vs_value){true, after, c->t1_s};
  watch_limit(r, c, before, after);
}

/* The part's Foster network: each term on its own, under the step's mean power. */
static void follow_junction(vs_watched *w, vs_reduced *r, const vs_course_step *c, double power) {
  double before = 0, after = 0;
  for (size_t k = 0; k < w->n_zth; k++) {
    double less = -expm1(-c->h_s / w->zth[k]->tau_s);
    before += w->heat_k[k];
    w->heat_k[k] += less * (w->zth[k]->k_per_w * power - w->heat_k[k]);
    after += w->heat_k[k];
  }
  if (after > r->value.value) r->value = (vs_value){true, after, c->t1_s};
  watch_limit(r, c, before, after);
}

/* One more value of something that comes now and then: the most, or the least, of all is kept. */
static void offer(vs_reduced *r, vs_value v) {
  if (!v.known) return;
  bool least = r->measure->held == VS_AT_LEAST || r->measure->how == VS_R_GATE_LEAST;
  if (!r->value.known || (least ? v.value < r->value.value : v.value > r->value.value))
    r->value = v;
  if (!r->limit || !isnan(r->failed_s)) return;
  if (r->measure->held == VS_AT_LEAST ? v.value < r->limit->value : v.value > r->limit->value)
    r->failed_s = v.at_s;
}

static void follow_slope(vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  int of = r->measure->of;
  double rate =
      vs_slope_follow(&w->slope, c->t0_s, c->from[of], c->t1_s, c->to[of], r->measure->sense);
  offer(r, (vs_value){rate >= 0, rate, c->t1_s});
}

static void follow_gate(vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  vs_gate_follow(&w->gate, c);
  if (w->gate.ended) offer(r, (vs_value){true, w->gate_peak_a, c->t0_s});
  if (w->gate.begins) w->gate_peak_a = 0;
  w->gate_peak_a = fmax(w->gate_peak_a, c->to[VS_OF_I]);
}

/* more: what the step adds to the integral of its course */
static void follow_measure(vs_watched *w, vs_reduced *r, const vs_course_step *c, double more) {
  switch (r->measure->how) {
  case VS_R_PULSE:
    if (c->was_on || c->on) follow_pulse(r, c, more);
    break;
  case VS_R_HEAT:
    follow_heat(w, r, c);
    break;
  case VS_R_WITHIN:
  case VS_R_SURGE:
    follow_window(w, r, c, more);
    break;
  case VS_R_INTEGRAL:
    watch_limit(r, c, w->sum[r->measure->of] - more, w->sum[r->measure->of]);
    break;
  case VS_R_STEEPEST:
    follow_slope(w, r, c);
    break;
  case VS_R_JUNCTION:
    follow_junction(w, r, c, more / c->h_s);
    break;
  case VS_R_GATE_LEAST:
    follow_gate(w, r, c);
    break;
  default:
    break;
  }
}

static void count(vs_reduced *r, bool once, double at_s) {
  if (once && !r->value.value++) r->value.at_s = at_s;
}

static void take_news(vs_reduced *r, const vs_switch_news *news) {
  switch (r->measure->how) {
  case VS_R_RISE:
    offer(r, news->rise);
    break;
  case VS_R_OFF_RATE:
    offer(r, news->off_rate);
    break;
  case VS_R_ON_RATE:
    offer(r, news->on_rate);
    break;
  case VS_R_OFFERED:
    offer(r, news->offered);
    if (news->offered.known && r->value.at_s == news->offered.at_s) r->spread = news->spread_s;
    break;
  case VS_R_MISFIRE:
    count(r, news->misfire.known, news->misfire.at_s);
    break;
  case VS_R_UNINTENDED:
    count(r, news->unintended.known, news->unintended.at_s);
    break;
  case VS_R_COMMUTATION_FAILURE:
    count(r, news->commutation_failure, news->unintended.at_s);
    break;
  default:
    break;
  }
}

/* ---- step by step ---- */

static void tell(vs_devices *d, const vs_watched *w, const vs_switch_news *news) {
  const char *name = w->device->name;
  if (news->misfire.known)
    d->incidents[d->n_incidents++] = (vs_incident){news->misfire.at_s, name, "misfires"};
  if (news->unintended.known)
    d->incidents[d->n_incidents++] =
        (vs_incident){news->unintended.at_s, name,
                      news->commutation_failure ? "fires without a gate pulse (commutation failure)"
                                                : "fires without a gate pulse (unintended firing)"};
}

static void follow_states(vs_devices *d, vs_watched *w, vs_course_step *c) {
  vs_switch_news news;
  c->was_on = w->states->conduction.conducts;
  vs_switch_follow(w->states, c, &news);
  c->on = w->states->conduction.conducts;
  if (!news.any) return;
  for (size_t k = 0; k < w->count; k++) take_news(&w->reduced[k], &news);
  tell(d, w, &news);
}

static void follow(vs_devices *d, vs_watched *w, vs_course_step *c, const double *mid,
                   const double *to) {
  double more[VS_COURSES] = {0};
  memcpy(c->from, w->last, sizeof c->from);
  evaluate(&w->voltage, mid, to, &c->mid[VS_OF_V], &c->to[VS_OF_V]);
  evaluate(&w->current, mid, to, &c->mid[VS_OF_I], &c->to[VS_OF_I]);
  if (w->flux.formula) evaluate(&w->flux, mid, to, &c->mid[VS_OF_FLUX], &c->to[VS_OF_FLUX]);
  complete(c->mid);
  complete(c->to);
  memcpy(w->last, c->to, sizeof c->to);
  for (int of = VS_OF_I; of < VS_COURSES; of++) {
    more[of] = c->h_s * (c->from[of] + 4 * c->mid[of] + c->to[of]) / 6;
    w->sum[of] += more[of];
  }
  if (w->states) follow_states(d, w, c);
  if (w->states) follow_starts(d, w, c);
  follow_means(d, w, c, more);
  for (size_t k = 0; k < w->n_peaks; k++) follow_peak(w->each_step[k], c);
  for (size_t k = w->n_peaks; k < w->n_each_step; k++)
    follow_measure(w, w->each_step[k], c, more[w->each_step[k]->measure->of]);
}

/* The courses at the beginning of the first step; the peaks and pulses begin there. */
static void begin(vs_devices *d, const vs_step *step) {
  const double *terms = step->from->terms;
  d->began_s = step->from->t_s;
  for (size_t k = 0; k < d->count; k++) {
    vs_watched *w = &d->item[k];
    w->last[VS_OF_V] = vs_formula_value(w->voltage.formula, terms);
    w->last[VS_OF_I] = vs_formula_value(w->current.formula, terms);
    if (w->flux.formula) w->last[VS_OF_FLUX] = vs_formula_value(w->flux.formula, terms);
    complete(w->last);
    w->window.starts_s = d->began_s;
    for (size_t n = 0; n < w->n_each_step; n++) {
      vs_reduced *r = w->each_step[n];
      const vs_device_measure *m = r->measure;
      if (m->how == VS_R_PEAK)
        r->value = (vs_value){true, in_sense(w->last[m->of], m->sense), d->began_s};
      if ((m->how >= VS_R_PULSE && m->how <= VS_R_SURGE) || m->how == VS_R_JUNCTION)
        r->value = (vs_value){true, 0, NAN};
    }
  }
}

void vs_devices_accept(vs_devices *d, const vs_step *step) {
  if (!d) return;
  d->n_incidents = 0;
  vs_course_step c = {.t0_s = step->from->t_s, .t1_s = step->to->t_s};
  c.h_s = c.t1_s - c.t0_s;
  if (!(c.h_s > 0)) return;
  if (isnan(d->began_s)) begin(d, step);
  const double *from = step->from->terms, *to = step->to->terms;
  double mid[VS_DECK_MOST];
  for (size_t t = 0; t < d->frame->deck->n_terms; t++) mid[t] = (from[t] + to[t]) / 2;
  for (size_t k = 0; k < d->count; k++) follow(d, &d->item[k], &c, mid, to);
  d->now_s = c.t1_s;
}

/* A firing that nothing follows says nothing of the power or current in operation: a scene that
 * fires once, or a device that began to conduct once in the time meant, or never, and did not
 * conduct all of it. */
static bool is_one_shot(const vs_devices *d, const vs_watched *w) {
  if (!isnan(w->device->gate_rad) && !d->frame->timeline->firing.every) return true;
  return w->starts < 2 && w->rests;
}

/* Its limit is for ever; what passes it does so at the end of the time meant. */
static void judge_rms(const vs_devices *d, const vs_watched *w, vs_reduced *r, double span_s,
                      double end_s) {
  if (!r->limit) return;
  if (span_s < CONTINUOUS_S * (1 - 1e-9))
    r->unjudged = "not judged: over less than 1 s";
  else if (is_one_shot(d, w))
    r->unjudged = "not judged: one shot";
  if (r->unjudged)
    r->limit = NULL;
  else if (r->value.value > r->limit->value)
    r->failed_s = end_s;
}

static void finish_device(const vs_devices *d, vs_watched *w) {
  double from_s = fmax(d->began_s, d->means.from_s), to_s = fmin(d->now_s, d->means.to_s);
  double span_s = to_s - from_s;
  for (size_t n = 0; n < w->count; n++) {
    vs_reduced *r = &w->reduced[n];
    int of = r->measure->of;
    if (r->measure->how == VS_R_INTEGRAL) r->value = (vs_value){true, w->sum[of], NAN};
    if (r->measure->how == VS_R_HEAT) end_heat(w, r, d->now_s);
    if ((r->measure->how != VS_R_MEAN && r->measure->how != VS_R_RMS) || !(span_s > 0)) continue;
    double mean = w->sum_meant[of] / span_s;
    bool rms = r->measure->how == VS_R_RMS;
    r->value = (vs_value){true, rms ? sqrt(mean) : mean, NAN};
    if (rms) judge_rms(d, w, r, span_s, to_s);
  }
}

void vs_devices_finish(vs_devices *d) {
  if (!d || isnan(d->began_s)) return;
  for (size_t k = 0; k < d->count; k++) finish_device(d, &d->item[k]);
}
