/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stress/reductions.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "deck/devices.h"
#include "stress/junction.h"
#include "stress/pulse.h"
#include "stress/told.h"

/* ---- peaks ---- */

static double in_sense(double value, int sense) {
  return (sense ? sense * value : fabs(value)) + 0.0; /* no -0 */
}

static bool has_course(const vs_watched *w, const vs_reduced *r) {
  return r->measure->of != VS_OF_FLUX || w->device->has_flux;
}

static void begin_peak(const vs_watched *w, vs_reduced *r, double t_s) {
  const vs_device_measure *m = r->measure;
  r->value = (vs_value){true, in_sense(w->last[m->of], m->sense), t_s};
}

static void follow_peak(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  const vs_device_measure *m = r->measure;
  double to = in_sense(c->to[m->of], m->sense);
  (void)w;
  if (to > r->value.value) r->value = (vs_value){true, to, c->t1_s};
  if (r->limit) vs_reducer_watch(r, c, in_sense(c->from[m->of], m->sense), to);
}

/* No step ends above the peak so far, nor above a limit that was not passed yet. */
static bool peak_rests(const vs_watched *w, const vs_reduced *r, const vs_courses *c) {
  const vs_device_measure *m = r->measure;
  const vs_pair *y = c->of[m->of];
  double most = -INFINITY;
  bool watched = r->limit && isnan(r->failed_s);
  (void)w;
  for (size_t n = 0; n < c->count; n++) {
    double to = in_sense(y[n][1], m->sense);
    if (to > most) most = to;
  }
  return most <= r->value.value && !(watched && !(most <= r->limit->value));
}

static const vs_reducer peak = {
    .is_busy = has_course, .begin = begin_peak, .follow = follow_peak, .rests = peak_rests};

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
    const vs_occurrence *e = &t->events.item[k];
    const double at_s[] = {e->on_line_s > 0 ? e->on_line_s : -INFINITY, e->start_s, e->end_s};
    for (size_t n = 0; n < sizeof at_s / sizeof *at_s; n++)
      if (at_s[n] < to_s) last_s = fmax(last_s, at_s[n]);
  }
  return last_s;
}

/* The value of a course over some of the parts. */
static double value_over(const vs_watched *w, const vs_reduced *r, size_t from, size_t to) {
  double sum = 0;
  for (size_t k = from; k < to; k++) sum += w->parts.sum[k][r->measure->of];
  const double mean = sum / ((double)(to - from) * w->parts.part_s);
  return r->measure->how == VS_R_RMS ? sqrt(fmax(mean, 0)) : mean;
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
static void judge_mean(const vs_watched *w, vs_reduced *r, double end_s) {
  const vs_firing_values *firing = &w->timeline->firing;
  if (!r->limit) return;
  if (!w->at_work) {
    r->unjudged = judge_settled(w, r, end_s);
    if (r->unjudged != TOO_SHORT && is_one_shot(w)) r->unjudged = ONE_SHOT;
  }
  const double value = r->judged.known ? r->judged.value : r->value.value;
  if (!r->unjudged && value > r->limit->value)
    r->failed_s = end_s;
  else if (!r->unjudged && !w->at_work && !firing->every && !firing->no_valve)
    r->unjudged = ONE_SHOT;
  if (r->unjudged) r->limit = NULL;
}

static void finish_mean(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  double span_s = end->to_s - end->from_s;
  if (!(span_s > 0)) return;
  r->value = (vs_value){true, w->sum_meant[r->measure->of] / span_s, NAN};
  judge_mean(w, r, end->to_s);
}

static void finish_rms(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  double span_s = end->to_s - end->from_s;
  if (!(span_s > 0)) return;
  r->value = (vs_value){true, sqrt(w->sum_meant[r->measure->of] / span_s), NAN};
  judge_mean(w, r, end->to_s);
}

static const vs_reducer mean = {.continuous = true, .finish = finish_mean},
                        rms = {.continuous = true, .finish = finish_rms};

/* ---- integrals ---- */

static bool has_limit(const vs_watched *w, const vs_reduced *r) {
  (void)w;
  return r->limit;
}

static void follow_integral(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  int of = r->measure->of;
  vs_reducer_watch(r, c, w->sum[of] - c->more[of], w->sum[of]);
}

static void finish_integral(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  (void)end;
  r->value = (vs_value){true, w->sum[r->measure->of], NAN};
}

static const vs_reducer integral = {
    .is_busy = has_limit, .follow = follow_integral, .finish = finish_integral};

/* The state is the integral over the present conduction. */
static void follow_pulse(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  double *present = r->state;
  (void)w;
  if (!c->was_on && !c->on) return;
  double before = c->was_on ? *present : 0;
  *present = before + c->more[r->measure->of];
  vs_reducer_take_largest(r, c, before, *present);
}

static const vs_reducer pulse = {.state_size = sizeof(double),
                                 .across = true,
                                 .hangs_on_sequence = true,
                                 .begin = vs_reducer_begin_at_zero,
                                 .follow = follow_pulse};

/* ---- heat of one pulse ---- */

static void prepare_heat(vs_watched *w, vs_reduced *r) {
  vs_pulse *p = r->state;
  p->rest_s = w->timeline->period_s / 4;
}

static void follow_heat(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  vs_pulse *p = r->state;
  double before = p->heat_j, heat = vs_pulse_follow(p, c);
  (void)w;
  vs_reducer_take_largest(r, c, fmin(before, heat), heat);
}

static bool heat_rests(const vs_watched *w, const vs_reduced *r, const vs_courses *c) {
  const vs_pulse *p = r->state;
  bool rests = vs_pulse_rests(p, w->last[VS_OF_I]);
  for (size_t n = 0; n < c->count && rests; n++) rests = vs_pulse_rests(p, c->of[VS_OF_I][n][1]);
  return rests;
}

/* What the present current has brought as the run ends counts whole. No pulse has more heat than
 * the run, whose integral may be less by the rounding of sums. */
static void finish_heat(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  double heat_j = vs_pulse_unfinished(r->state, end->now_s);
  if (heat_j > r->value.value) r->value = (vs_value){true, heat_j, end->now_s};
  r->value.value = fmin(r->value.value, fmax(w->sum[VS_OF_POWER], 0));
  if (r->limit && isnan(r->failed_s) && r->value.value > r->limit->value) r->failed_s = end->now_s;
}

static const vs_reducer heat = {.state_size = sizeof(vs_pulse),
                                .prepare = prepare_heat,
                                .begin = vs_reducer_begin_at_zero,
                                .follow = follow_heat,
                                .rests = heat_rests,
                                .finish = finish_heat};

/* ---- within 10 ms ---- */

enum { WINDOW_PARTS = 40 };
/* The surge that I_TSM is given for is a half sine of 10 ms; the window over it is made of parts of
 * a quarter of a millisecond. */
static const double SURGE_S = 10e-3, PART_S = 10e-3 / WINDOW_PARTS;

/* The integral over the last 10 ms. Each part holds its share of the steps that reach into it; of
 * the oldest part the share counts that is not yet out of the window. */
typedef struct window {
  double part[WINDOW_PARTS + 1];
  double whole;    /* sum of all parts but the present and the oldest one */
  size_t now;      /* index of the present part */
  double starts_s; /* when the present part began */
  double sum;      /* the window's integral at the end of the last step */
} window;

static void begin_window(const vs_watched *w, vs_reduced *r, double t_s) {
  window *in = r->state;
  in->starts_s = t_s;
  vs_reducer_begin_at_zero(w, r, t_s);
}

static void next_part(window *w) {
  w->now = (w->now + 1) % (WINDOW_PARTS + 1);
  w->part[w->now] = w->whole = 0;
  for (size_t k = 2; k <= WINDOW_PARTS; k++) w->whole += w->part[(w->now + k) % (WINDOW_PARTS + 1)];
  w->starts_s += PART_S;
}

/* Returns the window's integral after a step that adds `more`, evenly over its length. */
static double add_to_window(window *w, const vs_course_step *c, double more) {
  double from_s = c->t0_s;
  double skipped = floor((c->t1_s - w->starts_s) / PART_S) - WINDOW_PARTS - 1;
  if (skipped > 0) w->starts_s += skipped * PART_S; /* a step longer than all of it */
  from_s = fmax(from_s, w->starts_s);
  while (c->t1_s > w->starts_s + PART_S) {
    double end_s = fmax(w->starts_s + PART_S, from_s);
    w->part[w->now] += more * (end_s - from_s) / c->h_s;
    from_s = end_s;
    next_part(w);
  }
  w->part[w->now] += more * (c->t1_s - from_s) / c->h_s;
  double oldest = w->part[(w->now + 1) % (WINDOW_PARTS + 1)];
  double still_in = fmax(1 - (c->t1_s - w->starts_s) / PART_S, 0);
  return w->sum = w->whole + w->part[w->now] + still_in * oldest;
}

static void follow_within(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  window *in = r->state;
  double before = in->sum, after = add_to_window(in, c, c->more[r->measure->of]);
  (void)w;
  vs_reducer_take_largest(r, c, before, after);
}

/* Up to 10 ms what a junction bears is a constant int i^2 dt; that of a half sine is
 * peak^2 length/2. */
static void follow_surge(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  window *in = r->state;
  double before = in->sum, after = add_to_window(in, c, c->more[r->measure->of]);
  (void)w;
  vs_reducer_take_largest(r, c, sqrt(2 * before / SURGE_S), sqrt(2 * after / SURGE_S));
}

static const vs_reducer within = {.state_size = sizeof(window),
                                  .begin = begin_window,
                                  .follow = follow_within},
                        surge = {.state_size = sizeof(window),
                                 .across = true,
                                 .begin = begin_window,
                                 .follow = follow_surge};

/* ---- rates ---- */

static void follow_slope(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  int of = r->measure->of;
  (void)w;
  double rate =
      vs_slope_follow(r->state, c->t0_s, c->from[of], c->t1_s, c->to[of], r->measure->sense);
  vs_reducer_offer(r, (vs_value){rate >= 0, rate, c->t1_s}, vs_reducer_is_held_from_below(r));
}

static const vs_reducer steepest = {
    .state_size = sizeof(vs_slope), .is_rate = true, .follow = follow_slope};

/* ---- against a table of pulses ----
 * The peak current of one pulse, held against what the part's table of pulses (deck/devices.h)
 * allows for the pulse's width and for the number of pulses. A pulse lasts while |i| is 1 mA or
 * more; its width is its charge over its peak. Of several pulses it is the one that comes nearest
 * to what is allowed, or exceeds it most. Not known where the part has no table. */

/* Below this a varistor has no pulse but its leakage, A; as in stress/pulse.c. */
static const double LEAST_A = 1e-3;

typedef struct judged {
  double peak_a, charge_c, at_s; /* of the present pulse */
  double part;    /* of what is allowed, the most that a pulse was; 0: there was none */
  vs_limit limit; /* of that pulse */
} judged;

static bool has_table(const vs_watched *w, const vs_reduced *r) {
  (void)r;
  return vs_devices_has_pulses(w->deck, w->device);
}

static void begin_derated(const vs_watched *w, vs_reduced *r, double t_s) {
  judged *d = r->state;
  *d = (judged){.at_s = t_s};
  (void)w;
}

/* What the table says of the present pulse becomes the limit, if it comes nearer to that than the
 * pulses before. */
static void end_pulse(const vs_watched *w, vs_reduced *r) {
  judged *d = r->state;
  const vs_occurrence *e = vs_occurrence_repeated(&w->timeline->events);
  double number = e ? e->v.times : 1, width_s = d->charge_c / d->peak_a;
  bool assumed;
  double allowed_a = vs_devices_bears(w->deck, w->device, width_s, number, &assumed);
  double part = d->peak_a / allowed_a;
  if (isnan(allowed_a) && d->peak_a > r->value.value && !r->limit) {
    r->value = (vs_value){true, d->peak_a, d->at_s};
    r->unjudged = "not judged: the part's table of pulses ends before this width or number";
  }
  if (!(part > d->part)) return;
  d->part = part;
  d->limit = (vs_limit){.name = "pulse", .unit = "A", .value = allowed_a, .assumed = assumed};
  snprintf(d->limit.text, sizeof d->limit.text, "%.4g pulses of %.4g us", number, 1e6 * width_s);
  snprintf(d->limit.written, sizeof d->limit.written, "%.4g A", allowed_a);
  r->value = (vs_value){true, d->peak_a, d->at_s};
  r->limit = &d->limit;
  r->unjudged = NULL;
  if (part > 1 && isnan(r->failed_s)) r->failed_s = d->at_s;
}

static void follow_derated(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  judged *d = r->state;
  double to_a = fabs(c->to[VS_OF_I]);
  if (to_a < LEAST_A) {
    if (d->peak_a > 0) end_pulse(w, r);
    d->peak_a = d->charge_c = 0;
    return;
  }
  d->charge_c += fabs(c->more[VS_OF_I]);
  if (to_a > d->peak_a) d->peak_a = to_a, d->at_s = c->t1_s;
}

static void finish_derated(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const judged *d = r->state;
  (void)end;
  if (has_table(w, r) && d->peak_a > 0) end_pulse(w, r);
}

/* ---- means of what is repeated ----
 * The integral over the run, divided by the time from one pulse to the next. Not known where no
 * event repeats the run. */

static void finish_repeated(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const vs_occurrence *e = vs_occurrence_repeated(&w->timeline->events);
  (void)end;
  if (e) r->value = (vs_value){true, w->sum[r->measure->of] / e->v.every_s, NAN};
}

static const vs_reducer derated = {.state_size = sizeof(judged),
                                   .is_busy = has_table,
                                   .begin = begin_derated,
                                   .follow = follow_derated,
                                   .finish = finish_derated},
                        repeated = {.finish = finish_repeated};

/* ---- the table ---- */

const vs_reducer *const vs_reductions_all[VS_REDUCTIONS] = {
#define VS_REDUCTION_ROW(id, plug) [id] = &plug,
    VS_REDUCTION_LIST(VS_REDUCTION_ROW)
#undef VS_REDUCTION_ROW
};
