/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stress/reductions.h"

#include <math.h>
#include <string.h>

#include "stress/pulse.h"

/* ---- what reductions share ---- */

/* Notes when the limit was passed by a value that was `before` at the step's beginning and is
 * `after` at its end. */
static void watch_limit(vs_reduced *r, const vs_course_step *c, double before, double after) {
  if (!r->limit || !isnan(r->failed_s) || !(after > r->limit->value)) return;
  double part = (r->limit->value - before) / (after - before);
  r->failed_s = c->t0_s + fmin(fmax(part, 0), 1) * c->h_s;
}

/* The same, and keeps `after` where it is the largest so far. */
static void take_largest(vs_reduced *r, const vs_course_step *c, double before, double after) {
  if (after > r->value.value) r->value = (vs_value){true, after, c->t1_s};
  watch_limit(r, c, before, after);
}

/* A value of something that happens now and then: keeps the largest of all, or the least. */
static void offer(vs_reduced *r, vs_value v, bool least) {
  if (!v.known) return;
  if (!r->value.known || (least ? v.value < r->value.value : v.value > r->value.value))
    r->value = v;
  if (!r->limit || !isnan(r->failed_s)) return;
  if (r->measure->held == VS_AT_LEAST ? v.value < r->limit->value : v.value > r->limit->value)
    r->failed_s = v.at_s;
}

static bool is_held_from_below(const vs_reduced *r) {
  return r->measure->held == VS_AT_LEAST;
}

static void count(vs_reduced *r, bool once, double at_s) {
  if (once && r->value.value++ == 0) r->value.at_s = at_s;
}

static void begin_at_zero(const vs_watched *w, vs_reduced *r, double t_s) {
  (void)w, (void)t_s;
  r->value = (vs_value){true, 0, NAN};
}

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
  if (r->limit) watch_limit(r, c, in_sense(c->from[m->of], m->sense), to);
}

static const vs_reducer peak = {.is_busy = has_course, .begin = begin_peak, .follow = follow_peak};

/* ---- means ---- */

/* A continuous rating says nothing of a shorter run: one pulse that the part's i2t allows would be
 * above it over 0.7 s (i2t/i_t_rms^2 of the parts that ship is 0.46 to 0.68 s). */
static const double CONTINUOUS_S = 1;

/* True: only one firing falls into the time meant, which says nothing of the power or current in
 * operation. The scene fires once; or the device began to conduct there once at most, and did not
 * conduct all of the time. */
static bool is_one_shot(const vs_watched *w) {
  if (!isnan(w->device->gate_rad) && !w->timeline->firing.every) return true;
  return w->starts < 2 && w->rests;
}

/* The limit of a mean or an rms current holds for ever, as does the current on an orbit. A value
 * above it counts as passing the limit at the end of the time meant. */
static void judge_mean(const vs_watched *w, vs_reduced *r, double span_s, double end_s) {
  if (!r->limit) return;
  if (!w->at_work && span_s < CONTINUOUS_S * (1 - 1e-9))
    r->unjudged = "not judged: over less than 1 s";
  else if (!w->at_work && is_one_shot(w))
    r->unjudged = "not judged: one shot";
  if (r->unjudged)
    r->limit = NULL;
  else if (r->value.value > r->limit->value)
    r->failed_s = end_s;
}

static void finish_mean(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  double span_s = end->to_s - end->from_s;
  if (!(span_s > 0)) return;
  r->value = (vs_value){true, w->sum_meant[r->measure->of] / span_s, NAN};
  judge_mean(w, r, span_s, end->to_s);
}

static void finish_rms(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  double span_s = end->to_s - end->from_s;
  if (!(span_s > 0)) return;
  r->value = (vs_value){true, sqrt(w->sum_meant[r->measure->of] / span_s), NAN};
  judge_mean(w, r, span_s, end->to_s);
}

static const vs_reducer mean = {.finish = finish_mean}, rms = {.finish = finish_rms};

/* ---- integrals ---- */

static bool has_limit(const vs_watched *w, const vs_reduced *r) {
  (void)w;
  return r->limit;
}

static void follow_integral(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  int of = r->measure->of;
  watch_limit(r, c, w->sum[of] - c->more[of], w->sum[of]);
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
  take_largest(r, c, before, *present);
}

static const vs_reducer pulse = {
    .state_size = sizeof(double), .across = true, .begin = begin_at_zero, .follow = follow_pulse};

/* ---- heat of one pulse ---- */

static void prepare_heat(vs_watched *w, vs_reduced *r) {
  vs_pulse *p = r->state;
  p->rest_s = w->timeline->period_s / 4;
}

static void follow_heat(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  vs_pulse *p = r->state;
  double before = p->heat_j, heat = vs_pulse_follow(p, c);
  (void)w;
  take_largest(r, c, fmin(before, heat), heat);
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
                                .begin = begin_at_zero,
                                .follow = follow_heat,
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
  begin_at_zero(w, r, t_s);
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
  take_largest(r, c, before, after);
}

/* Up to 10 ms what a junction bears is a constant int i^2 dt; that of a half sine is
 * peak^2 length/2. */
static void follow_surge(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  window *in = r->state;
  double before = in->sum, after = add_to_window(in, c, c->more[r->measure->of]);
  (void)w;
  take_largest(r, c, sqrt(2 * before / SURGE_S), sqrt(2 * after / SURGE_S));
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
  offer(r, (vs_value){rate >= 0, rate, c->t1_s}, is_held_from_below(r));
}

static const vs_reducer steepest = {
    .state_size = sizeof(vs_slope), .is_rate = true, .follow = follow_slope};

/* ---- the junction's temperature ---- */

/* On an orbit the rise at the period's beginning is that at its end. So the power over the period
 * is kept: each step's mean and its end. Where there are more steps than that, each two neighbours
 * become one. */
enum { KEPT = 32768 };
typedef struct heating {
  double end_s, power_w;
} heating;

/* The Foster network of the device's part, and the rise of each of its terms. */
typedef struct network {
  const vs_zth *zth[VS_PART_ZTH];
  double rise_k[VS_PART_ZTH];
  size_t count;
  double begun_s;
  size_t n_kept;
  heating kept[]; /* [KEPT] on an orbit, else [0] */
} network;

static void prepare_junction(vs_watched *w, vs_reduced *r) {
  network *n = r->state;
  const vs_deck *deck = w->deck;
  const char *file = w->device->part < 0 ? "" : deck->parts[w->device->part].file;
  for (size_t k = 0; k < deck->n_zth; k++)
    if (!strcmp(deck->zth[k].where.file, file)) n->zth[n->count++] = &deck->zth[k];
}

static bool has_network(const vs_watched *w, const vs_reduced *r) {
  const network *n = r->state;
  (void)w;
  return n->count;
}

static void begin_junction(const vs_watched *w, vs_reduced *r, double t_s) {
  network *n = r->state;
  n->begun_s = t_s;
  begin_at_zero(w, r, t_s);
}

static double rise_of(const network *n) {
  double rise_k = 0;
  for (size_t k = 0; k < n->count; k++) rise_k += n->rise_k[k];
  return rise_k;
}

/* Each term moves on its own, under a power that is constant for h_s. Returns the rise of all. */
static double heat_up(network *n, double power_w, double h_s) {
  for (size_t k = 0; k < n->count; k++) {
    double less = -expm1(-h_s / n->zth[k]->tau_s);
    n->rise_k[k] += less * (n->zth[k]->k_per_w * power_w - n->rise_k[k]);
  }
  return rise_of(n);
}

static void halve(network *n) {
  double from_s = n->begun_s;
  for (size_t k = 0; k < KEPT / 2; k++) {
    const heating *a = &n->kept[2 * k], *b = a + 1;
    double joule = a->power_w * (a->end_s - from_s) + b->power_w * (b->end_s - a->end_s);
    const heating both = {b->end_s, joule / (b->end_s - from_s)};
    from_s = b->end_s;
    n->kept[k] = both;
  }
  n->n_kept = KEPT / 2;
}

static void follow_junction(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  network *n = r->state;
  double before = rise_of(n), power_w = c->more[r->measure->of] / c->h_s;
  double after = heat_up(n, power_w, c->h_s);
  if (!w->at_work) {
    take_largest(r, c, before, after);
    return;
  }
  if (n->n_kept == KEPT) halve(n);
  n->kept[n->n_kept++] = (heating){c->t1_s, power_w};
}

/* From 0 a term comes to b in the period T, and from s to s e^(-T/tau) + b. On an orbit that is s
 * again: s = b/(1 - e^(-T/tau)). From there the period is gone through once more. */
static void finish_junction(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  network *n = r->state;
  vs_course_step c = {.t1_s = n->begun_s};
  if (!w->at_work || !n->count) return;
  for (size_t k = 0; k < n->count; k++)
    n->rise_k[k] /= -expm1((n->begun_s - end->now_s) / n->zth[k]->tau_s);
  r->value = (vs_value){true, rise_of(n), n->begun_s};
  for (size_t k = 0; k < n->n_kept; k++) {
    double before = rise_of(n);
    c.t0_s = c.t1_s;
    c.t1_s = n->kept[k].end_s;
    c.h_s = c.t1_s - c.t0_s;
    take_largest(r, &c, before, heat_up(n, n->kept[k].power_w, c.h_s));
  }
}

static const vs_reducer junction = {.state_size = sizeof(network),
                                    .at_work_size = KEPT * sizeof(heating),
                                    .prepare = prepare_junction,
                                    .is_busy = has_network,
                                    .begin = begin_junction,
                                    .follow = follow_junction,
                                    .finish = finish_junction};

/* ---- news of a device that conducts or blocks ---- */

static void take_rise(vs_reduced *r, const vs_switch_news *news) {
  offer(r, news->rise, is_held_from_below(r));
}

static void take_off_rate(vs_reduced *r, const vs_switch_news *news) {
  offer(r, news->off_rate, is_held_from_below(r));
}

static void take_on_rate(vs_reduced *r, const vs_switch_news *news) {
  offer(r, news->on_rate, is_held_from_below(r));
}

/* The limit of the time offered is the part's t_q, by which a commutation failure is told. */
static void prepare_offered(vs_watched *w, vs_reduced *r) {
  if (w->states && r->limit) w->states->t_q_s = r->limit->value;
}

static void take_offered(vs_reduced *r, const vs_switch_news *news) {
  offer(r, news->offered, is_held_from_below(r));
  if (!news->offered.known || r->value.at_s != news->offered.at_s) return;
  r->doubt = news->doubt_s;
  r->spread = news->spread_s;
}

static void take_misfire(vs_reduced *r, const vs_switch_news *news) {
  count(r, news->misfire.known, news->misfire.at_s);
}

static void take_unintended(vs_reduced *r, const vs_switch_news *news) {
  count(r, news->unintended.known, news->unintended.at_s);
}

static void take_commutation_failure(vs_reduced *r, const vs_switch_news *news) {
  count(r, news->commutation_failure, news->unintended.at_s);
}

static const vs_reducer rise = {.is_rate = true, .take_news = take_rise},
                        off_rate = {.is_rate = true, .take_news = take_off_rate},
                        on_rate = {.is_rate = true, .take_news = take_on_rate},
                        offered = {.prepare = prepare_offered, .take_news = take_offered},
                        misfire = {.counts = true, .take_news = take_misfire},
                        unintended = {.counts = true, .take_news = take_unintended},
                        commutation_failure = {.counts = true,
                                               .take_news = take_commutation_failure};

/* ---- gate pulses ---- */

typedef struct gate_pulses {
  vs_gate_watch gate;
  double peak_a; /* in the present pulse */
} gate_pulses;

static void prepare_gate(vs_watched *w, vs_reduced *r) {
  gate_pulses *g = r->state;
  vs_switching_gate_begin(&g->gate, w->timeline, w->device->gate_rad);
}

static void follow_gate(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  gate_pulses *g = r->state;
  (void)w;
  vs_switching_gate_follow(&g->gate, c);
  if (g->gate.ended) offer(r, (vs_value){true, g->peak_a, c->t0_s}, true);
  if (g->gate.begins) g->peak_a = 0;
  g->peak_a = fmax(g->peak_a, c->to[VS_OF_I]);
}

static const vs_reducer gate_least = {
    .state_size = sizeof(gate_pulses), .prepare = prepare_gate, .follow = follow_gate};

/* ---- the table ---- */

const vs_reducer *const vs_reductions_all[VS_REDUCTIONS] = {
#define VS_REDUCTION_ROW(id, plug) [id] = &plug,
    VS_REDUCTION_LIST(VS_REDUCTION_ROW)
#undef VS_REDUCTION_ROW
};
