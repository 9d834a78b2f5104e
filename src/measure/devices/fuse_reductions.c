/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reductions of a fuse: how often it melts and arcs again, its current against its time-current
 * curve, the voltage of its arc and the one that returns behind its clearing
 * (measure/devices/melting.h). */
#include "devices/reductions.h"

#include <math.h>
#include <stdio.h>

#include "devices/melting.h"
#include "netlist/devices.h"

/* ---- how often it melts, and arcs again ---- */

static void prepare_fuse(vs_watched *w, vs_reduced *r) {
  (void)w;
  r->value = (vs_value){true, 0, NAN};
}

static void take_opening(vs_reduced *r, const vs_melting_news *news) {
  if (isnan(news->melts_s)) return;
  vs_reducer_count(r, news->melts_s);
  char *cause = vs_reducer_happens(r, news->melts_s);
  if (cause)
    snprintf(cause, VS_CAUSE_SIZE, "melted after int i^2 dt of %.3g A2.s, at %.3g A", news->i2_s,
             news->i_a);
}

static void take_arc(vs_reduced *r, const vs_melting_news *news) {
  if (isnan(news->again_s)) return;
  vs_reducer_count(r, news->again_s);
  char *cause = vs_reducer_happens(r, news->again_s);
  if (cause) snprintf(cause, VS_CAUSE_SIZE, "a current of %.3g A once it had cleared", news->i_a);
}

#define HAPPENS .hangs_on_sequence = true, .state_size = sizeof(vs_happening)
const vs_reducer vs_fuse_reduction_opens = {HAPPENS, .prepare = prepare_fuse,
                                            .take_melting = take_opening},
                 vs_fuse_reduction_arcs = {HAPPENS, .prepare = prepare_fuse,
                                           .take_melting = take_arc};
#undef HAPPENS

/* ---- a fuse against its time-current curve ----
 * A fuse that carries I melts in the time t that its curve tells. So over no stretch as long as t
 * may the rms value of its current be I or more: that heat would melt it, however the current runs
 * within the stretch. Stretches of MOST_SPANS lengths are looked at, from the curve's shortest time
 * to its longest, each 2^(1/4) times as long as the one before where the curve is no longer than 19
 * octaves. Between two lengths a current of just one stretch is taken for 2 % less at the most.
 * On an orbit the current goes on for ever: lengths beyond the period have its rms value. What an
 * ambient temperature leaves of the rated current it leaves of the curve's currents. */

enum { MOST_SPANS = 80, IN_OCTAVE = 4 };
/* The integral over the last VS_WINDOW_PARTS parts of a stretch, by the run's integral at each of
 * their ends. */
typedef struct span {
  double width_s, part_s, next_s, allowed_a;
  double sum[VS_WINDOW_PARTS]; /* a ring; sum[at] is the oldest */
  size_t at;
  unsigned unsure;
} span;
typedef struct curve {
  size_t count;
  double nearest; /* the most that a stretch had, as a part of what is allowed */
  span of[MOST_SPANS];
} curve;

static bool has_curve(const vs_watched *w, const vs_reduced *r) {
  const curve *of = r->state;
  (void)w;
  return of->count;
}

static void prepare_curve(vs_watched *w, vs_reduced *r) {
  curve *of = r->state;
  double ends_s[2];
  const vs_limit *rated = vs_devices_own_limit(w->deck, w->device, "i_rated");
  if (!vs_devices_curve(w->deck, w->device, ends_s)) {
    if (rated && isfinite(rated->value)) r->unjudged = "not judged: no time_current stated";
    return;
  }
  vs_limit own;
  const vs_limit *left = rated ? vs_devices_derated(w->deck, rated, w->ambient_degc, &own) : rated;
  if (rated && !left) {
    r->unjudged = "not judged: its lines derate end before that ambient temperature";
    return;
  }
  const double warm = rated && isfinite(rated->value) ? left->value / rated->value : 1;
  double octaves = log2(ends_s[1] / ends_s[0]);
  of->count = 1 + (size_t)fmin(ceil(IN_OCTAVE * octaves), MOST_SPANS - 1);
  for (size_t k = 0; k < of->count; k++) {
    span *s = &of->of[k];
    s->width_s = k + 1 < of->count ? ends_s[0] * exp2(octaves * (double)k / (double)(of->count - 1))
                                   : ends_s[1];
    s->part_s = s->width_s / VS_WINDOW_PARTS;
    s->allowed_a = warm * vs_devices_melts_at(w->deck, w->device, s->width_s, &s->unsure);
  }
}

static void begin_curve(const vs_watched *w, vs_reduced *r, double t_s) {
  curve *of = r->state;
  vs_reducer_begin_at_zero(w, r, t_s);
  for (size_t k = 0; k < of->count; k++) of->of[k].next_s = t_s + of->of[k].part_s;
}

/* Takes the mean square of the current over a stretch that ends at at_s. */
static void take_span(vs_reduced *r, const span *s, double mean_a2, double at_s) {
  curve *of = r->state;
  double rms_a = sqrt(fmax(mean_a2, 0)), part = rms_a / s->allowed_a;
  if (!(part > of->nearest)) return;
  of->nearest = part;
  r->own =
      (vs_limit){.name = "time_current", .unit = "A", .value = s->allowed_a, .unsure = s->unsure};
  snprintf(r->own.text, sizeof r->own.text, "over %.4g s", s->width_s);
  snprintf(r->own.written, sizeof r->own.written, "%.4g A", s->allowed_a);
  r->value = (vs_value){true, rms_a, at_s};
  r->limit = &r->own;
  if (part > 1 && isnan(r->failed_s)) r->failed_s = at_s;
}

static void follow_curve(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  curve *of = r->state;
  const double more = c->more[VS_OF_I2], before = w->sum[VS_OF_I2] - more;
  for (size_t k = 0; k < of->count; k++) {
    span *s = &of->of[k];
    for (; s->next_s <= c->t1_s; s->next_s += s->part_s) {
      double now = before + more * fmin(fmax((s->next_s - c->t0_s) / c->h_s, 0), 1);
      take_span(r, s, (now - s->sum[s->at]) / s->width_s, s->next_s);
      s->sum[s->at] = now;
      s->at = (s->at + 1) % VS_WINDOW_PARTS;
    }
  }
}

/* What is left at the end: the last part of each stretch is not over. */
static void finish_curve(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  curve *of = r->state;
  const double span_s = end->to_s - end->from_s;
  for (size_t k = 0; k < of->count; k++) {
    const span *s = &of->of[k];
    take_span(r, s, (w->sum[VS_OF_I2] - s->sum[s->at]) / s->width_s, end->now_s);
    if (w->at_work && span_s > 0 && s->width_s > span_s)
      take_span(r, s, w->sum_meant[VS_OF_I2] / span_s, end->now_s);
  }
}

/* ---- a fuse that opens ---- */

/* The voltage that returns behind its clearing, by its rms value over half a mains cycle, which for
 * a sine is that of the whole cycle, and for a direct voltage is that. While the arc burns its
 * voltage counts in the same way, and is forgotten once the fuse has cleared. A valve in series may
 * take a part of each half wave. The fuse has to clear at the crest all the same: so the rms value
 * of the sine counts, too, that has the crest that is left. A crest is a mean over 1 ms, in which
 * what rings behind an opening goes out. A valve that blocks may take all of it, and beyond its
 * arc's voltage the model of a fuse conducts. So what it has to clear is never less than the mains
 * that drive it. Where these are not known, and less than NEARLY of the scene's mains was there, it
 * is not judged. */
static const double CREST_S = 1e-3;
/* What lines and loads leave of the mains: IEC 60038 lets them fall by a tenth. */
static const double NEARLY = 0.9;
typedef struct returning {
  bool melted, cleared;
  double v2_s, lasts_s; /* since the present half cycle began */
  vs_window crest;      /* of the voltage */
} returning;

static void begin_open(const vs_watched *w, vs_reduced *r, double t_s) {
  returning *s = r->state;
  (void)w;
  vs_reducer_window_begin(&s->crest, CREST_S, t_s);
}

static void take_open(vs_reduced *r, const vs_melting_news *news) {
  returning *s = r->state;
  s->melted = s->melted || !isnan(news->melts_s);
  if (isnan(news->cleared_s) || s->cleared) return;
  s->cleared = true;
  s->v2_s = s->lasts_s = 0;
  r->value.known = false;
  r->failed_s = NAN;
}

static void follow_open(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  returning *s = r->state;
  if (!s->melted) return;
  double crest_v = fabs(vs_reducer_window_add(&s->crest, c, c->more[VS_OF_V])) / CREST_S;
  if (s->cleared) vs_reducer_offer(r, (vs_value){true, crest_v / sqrt(2), c->t1_s}, false);
  s->v2_s += c->more[VS_OF_V2];
  s->lasts_s += c->h_s;
  if (s->lasts_s < w->timeline->period_s / 2) return;
  vs_reducer_offer(r, (vs_value){true, sqrt(s->v2_s / s->lasts_s), c->t1_s}, false);
  s->v2_s = s->lasts_s = 0;
}

/* Takes the mains for what it has to clear, where less has returned. False: they are not known, and
 * another part may have taken what is lacking. */
static bool takes_mains(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const double mains_v = w->device->mains_v, limit = r->limit->value;
  const bool short_of_it = r->value.value < NEARLY * w->timeline->supply.voltage_v;
  if (isnan(mains_v)) return !r->value.known || r->value.value > limit || !short_of_it;
  /* a run that ends before the voltage is back tells no more than that it is too much */
  if (!r->value.known && mains_v <= limit) return true;
  if (!r->value.known) r->value = (vs_value){true, 0, end->now_s};
  if (mains_v <= r->value.value) return true;
  r->value.value = mains_v;
  if (mains_v > limit && isnan(r->failed_s)) r->failed_s = r->value.at_s;
  return true;
}

static void finish_open(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const returning *s = r->state;
  if (!r->limit) return;
  if (s->melted && !takes_mains(w, r, end)) {
    r->limit = NULL;
    r->unjudged = "not judged: less than the mains was there, and what drives it is not known";
    return;
  }
  if (r->value.known) return;
  r->limit = NULL;
  r->unjudged = s->melted ? "not judged: the run ends within half a mains cycle of its opening"
                : w->device->opened_by ? "not judged: an event opens it"
                                       : "not judged: it did not open";
}

static void prepare_arc(vs_watched *w, vs_reduced *r) {
  const vs_limit *own = vs_devices_own_limit(w->deck, w->device, "v_arc");
  r->unsure = own ? own->unsure : 0;
  r->idle = true; /* until it melts */
}

static void take_burning(vs_reduced *r, const vs_melting_news *news) {
  returning *s = r->state;
  s->melted = s->melted || !isnan(news->melts_s);
  s->cleared = (s->cleared || !isnan(news->cleared_s)) && isnan(news->again_s);
  r->idle = !s->melted || !r->limit;
}

static void follow_arc(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  const returning *s = r->state;
  (void)w;
  if (s->melted && !s->cleared)
    vs_reducer_offer(r, (vs_value){true, fabs(c->to[VS_OF_V]), c->t1_s}, false);
}

/* What the maker says that it lets through is so whatever the run. */
static void prepare_clears(vs_watched *w, vs_reduced *r) {
  const vs_limit *own = vs_devices_own_limit(w->deck, w->device, "i2t_clear");
  if (own && isfinite(own->value)) {
    r->value = (vs_value){true, own->value, NAN};
    r->unsure = own->unsure;
    return;
  }
  r->idle = own || !r->limit;
  r->limit = NULL;
  if (!r->idle) r->unjudged = "not judged: no i2t_clear stated";
}

const vs_reducer vs_fuse_reduction_curve = {.state_size = sizeof(curve),
                                            .until_opens = true,
                                            .prepare = prepare_curve,
                                            .finds_limit = true,
                                            .is_busy = has_curve,
                                            .begin = begin_curve,
                                            .follow = follow_curve,
                                            .finish = finish_curve},
                 vs_fuse_reduction_open = {.state_size = sizeof(returning),
                                           .hangs_on_sequence = true,
                                           .is_busy = vs_reducer_has_limit,
                                           .begin = begin_open,
                                           .take_melting = take_open,
                                           .follow = follow_open,
                                           .finish = finish_open},
                 vs_fuse_reduction_arc = {.state_size = sizeof(returning),
                                          .hangs_on_sequence = true,
                                          .prepare = prepare_arc,
                                          .take_melting = take_burning,
                                          .follow = follow_arc},
                 vs_fuse_reduction_clears = {.prepare = prepare_clears};
