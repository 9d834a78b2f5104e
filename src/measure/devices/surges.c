/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reductions of what a device bears for a short time: integrals within 10 ms, and pulses and surges
 * held against the tables of the device's part. */
#include "devices/reductions.h"

#include <math.h>
#include <stdio.h>

#include "devices/melting.h"
#include "netlist/devices.h"
#include "netlist/parts.h"

/* ---- within 10 ms ---- */

/* The surge that I_TSM is given for is a half sine of 10 ms. Fuses' figures of I2t are for 10 ms
 * and less, below which no heat leaves the element. */
static const double SURGE_S = 10e-3;

typedef struct window {
  vs_window last; /* 10 ms */
  bool melted;    /* it is of a fuse that has */
} window;

static void begin_window(const vs_watched *w, vs_reduced *r, double t_s) {
  window *in = r->state;
  vs_reducer_window_begin(&in->last, SURGE_S, t_s);
  vs_reducer_begin_at_zero(w, r, t_s);
}

static void follow_within(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  window *in = r->state;
  const double before = in->last.sum;
  vs_reducer_window_add(&in->last, c, c->more[r->measure->of]);
  (void)w;
  vs_reducer_take_largest(r, c, before, in->last.most);
}

/* Up to 10 ms what a junction bears is a constant int i^2 dt; that of a half sine is
 * peak^2 length/2. */
static void follow_surge(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  window *in = r->state;
  const double before = in->last.sum;
  vs_reducer_window_add(&in->last, c, c->more[r->measure->of]);
  (void)w;
  vs_reducer_take_largest(r, c, sqrt(2 * before / SURGE_S), sqrt(2 * in->last.most / SURGE_S));
}

static void follow_whole_fuse(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  const window *in = r->state;
  if (!in->melted) follow_within(w, r, c);
}

static void note_fuse_melts(vs_reduced *r, const vs_melting_news *news) {
  window *in = r->state;
  in->melted = in->melted || !isnan(news->melts_s);
}

/* One fuse of a type melts at an I2t up to this part above or below that of the next. Data sheets
 * give one number, and most say that it is a typical one; the standards' gates are wider. */
static const double MELTS_WITHIN = 0.15;

static void finish_melting(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  (void)w, (void)end;
  if (r->limit) r->scatter = MELTS_WITHIN * r->limit->value;
}

static void finish_let_through(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const window *in = r->state;
  (void)w, (void)end;
  if (in->melted) r->scatter = MELTS_WITHIN * r->value.value;
}

#define WITHIN .state_size = sizeof(window), .begin = begin_window
const vs_reducer vs_surge_within = {WITHIN, .own_course = true, .follow = follow_within},
                 vs_surge_let_through = {WITHIN, .follow = follow_within,
                                         .take_melting = note_fuse_melts,
                                         .finish = finish_let_through},
                 vs_surge_melting = {WITHIN,
                                     .until_opens = true,
                                     .is_busy = vs_reducer_has_limit,
                                     .follow = follow_whole_fuse,
                                     .take_melting = note_fuse_melts,
                                     .finish = finish_melting},
                 vs_surge_peak = {WITHIN, .across = true, .own_course = true, .follow = follow_surge};
#undef WITHIN

/* ---- against tables ---- */

/* Of several values the one that comes nearest to what the part's table allows it. */
typedef struct judged {
  double part;    /* of what is allowed, the most that a value was; 0: there was none */
  vs_limit limit; /* of that value */
} judged;

/* Takes a value of which the part bears `allowed`, if it comes nearer to that than those before. */
static bool take_judged(vs_reduced *r, judged *d, vs_value v, double allowed, unsigned unsure) {
  double part = v.value / allowed;
  if (!(part > d->part)) return false;
  d->part = part;
  d->limit.value = allowed;
  d->limit.unsure = unsure;
  r->value = v;
  r->limit = &d->limit;
  if (part > 1 && isnan(r->failed_s)) r->failed_s = v.at_s;
  return true;
}

/* The pulses, or conductions, that a run may have and a row of them is told of. */
enum { MOST_PULSES = 512 };

/* ---- against a table of pulses ----
 * The peak current of a pulse, held against what the part's table of pulses (netlist/devices.h)
 * allows for the pulse's width and for its number. A pulse lasts while |i| is 1 mA or more and of
 * one sign; its width is its charge over its peak. Its number is how many pulses of the run have
 * its peak or more, times how often an event repeats the run. On an orbit pulses have no end, and
 * no table has their number. A pulse beyond the table's end leaves the others unjudged, unless they
 * pass the table or its current is none that the table speaks of. Not known where the part has no
 * table. */

/* Below this a varistor has no pulse but its leakage, A; as in measure/devices/pulse.c. */
static const double LEAST_A = 1e-3;

typedef struct pulse_of {
  double peak_a, charge_c, at_s; /* at_s: of its peak */
} pulse_of;
typedef struct pulses {
  pulse_of present;
  size_t count, more;         /* of those kept; of smaller ones besides */
  pulse_of kept[MOST_PULSES]; /* the largest, in order */
  judged worst;
} pulses;

static bool has_table(const vs_watched *w, const vs_reduced *r) {
  (void)r;
  return vs_devices_least_pulse(w->deck, w->device) > 0;
}

/* The smallest pulse goes where there is no place. */
static void end_pulse(pulses *all) {
  if (!(all->present.peak_a > 0)) return;
  const bool full = all->count == MOST_PULSES;
  size_t k = all->count - full;
  all->more += full;
  if (!full || all->present.peak_a > all->kept[k].peak_a) {
    for (; k > 0 && all->kept[k - 1].peak_a < all->present.peak_a; k--)
      all->kept[k] = all->kept[k - 1];
    all->kept[k] = all->present;
  }
  all->count += !full;
  all->present = (pulse_of){0};
}

static void follow_derated(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  pulses *all = r->state;
  double to_a = fabs(c->to[VS_OF_I]);
  (void)w;
  if (to_a < LEAST_A || c->from[VS_OF_I] * c->to[VS_OF_I] < 0) end_pulse(all);
  if (to_a < LEAST_A) return;
  all->present.charge_c += fabs(c->more[VS_OF_I]);
  if (to_a > all->present.peak_a) all->present.peak_a = to_a, all->present.at_s = c->t1_s;
}

/* Holds one pulse against the table. False: it lies beyond the table's end. */
static bool judge_pulse(const vs_watched *w, vs_reduced *r, const pulse_of *p, double number) {
  pulses *all = r->state;
  const double width_s = p->charge_c / p->peak_a;
  unsigned unsure;
  double allowed_a = vs_devices_bears(w->deck, w->device, width_s, number, &unsure);
  if (isnan(allowed_a)) return p->peak_a <= vs_devices_least_pulse(w->deck, w->device);
  if (!take_judged(r, &all->worst, (vs_value){true, p->peak_a, p->at_s}, allowed_a, unsure))
    return true;
  vs_limit *limit = &all->worst.limit;
  snprintf(limit->name, sizeof limit->name, "pulse");
  snprintf(limit->unit, sizeof limit->unit, "A");
  snprintf(limit->text, sizeof limit->text, "%.4g pulses of %.4g us", number, 1e6 * width_s);
  snprintf(limit->written, sizeof limit->written, "%.4g A", allowed_a);
  return true;
}

static void finish_derated(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  pulses *all = r->state;
  const vs_scene_event *e = vs_scene_event_repeated(&w->timeline->events);
  const pulse_of *beyond = NULL;
  (void)end;
  if (!has_table(w, r)) {
    const vs_reduced *heat = vs_reducer_of(w, VS_R_HEAT);
    if (e && heat && heat->limit)
      r->unjudged = "not judged: repeated pulses, and the part has no table of them";
    return;
  }
  end_pulse(all);
  for (size_t k = 0; k < all->count; k++) {
    const double of_run = (double)(k + 1 + (k + 1 == all->count ? all->more : 0));
    const double number = w->at_work ? INFINITY : e ? of_run * e->v.times : of_run;
    if (!judge_pulse(w, r, &all->kept[k], number) && !beyond) beyond = &all->kept[k];
  }
  if (!beyond || all->worst.part > 1) return;
  r->value = (vs_value){true, beyond->peak_a, beyond->at_s};
  r->limit = NULL;
  r->unjudged = "not judged: the part's table of pulses ends before this width or number";
}

const vs_reducer vs_surge_pulses = {.state_size = sizeof(pulses),
                                    .finds_limit = true,
                                    .is_busy = has_table,
                                    .follow = follow_derated,
                                    .finish = finish_derated};

/* ---- surges against a table ----
 * Each conduction, or half cycle of a triac, counts by its int i^2 dt. */

/* The half sines of consecutive cycles; of a triac the whole sines. */
typedef struct row_of {
  double i2_s[MOST_PULSES], end_s[MOST_PULSES]; /* of the last conductions, in a ring */
  size_t count;                                 /* of all so far */
  double present_i2_s;
  judged worst;
} row_of;

static bool has_surges(const vs_watched *w, const vs_reduced *r) {
  (void)r;
  return vs_devices_most_surges(w->deck, w->device) > 0;
}

/* What one sine of that peak has over a cycle, as a part of its peak squared, s: half sines of 10
 * ms, two of them where the device conducts both ways. */
static double of_cycle(const vs_watched *w) {
  return w->device->kind->both_ways ? SURGE_S : SURGE_S / 2;
}

/* How many cycles conductions span of which the last ends so long behind the first. A device that
 * conducts both ways has one in each half cycle. */
static double spans(const vs_watched *w, double behind_s) {
  const double halves = round(2 * behind_s / w->timeline->period_s);
  return w->device->kind->both_ways ? fmax(1, (halves + 1) / 2) : round(halves / 2) + 1;
}

/* Holds a row of consecutive cycles against what the part bears, with the row's int i^2 dt. */
static void judge_row(const vs_watched *w, vs_reduced *r, double i2_s, double cycles,
                      double end_s) {
  row_of *row = r->state;
  unsigned unsure;
  double allowed_a = vs_devices_bears_surge(w->deck, w->device, cycles, &unsure);
  const vs_value v = {true, sqrt(i2_s / (cycles * of_cycle(w))), end_s};
  if (!take_judged(r, &row->worst, v, allowed_a, unsure)) return;
  vs_limit *limit = &row->worst.limit;
  snprintf(limit->name, sizeof limit->name, "surge");
  snprintf(limit->unit, sizeof limit->unit, "A");
  snprintf(limit->text, sizeof limit->text, "%g cycles", cycles);
  snprintf(limit->written, sizeof limit->written, "%.4g A", allowed_a);
}

/* The row of the last conductions that come nearest to what the part bears: with each conduction
 * further back the row spans so many cycles, in which the mean square counts. */
static void end_conduction(const vs_watched *w, vs_reduced *r, double end_s) {
  row_of *row = r->state;
  const double most = vs_devices_most_surges(w->deck, w->device);
  const size_t now = row->count++ % MOST_PULSES;
  double sum = 0;
  row->i2_s[now] = row->present_i2_s;
  row->end_s[now] = end_s;
  row->present_i2_s = 0;
  for (size_t k = 0; k < row->count && k < MOST_PULSES; k++) {
    const size_t n = (now + MOST_PULSES - k) % MOST_PULSES;
    const double cycles = spans(w, end_s - row->end_s[n]);
    if (cycles > most) break;
    sum += row->i2_s[n];
    judge_row(w, r, sum, cycles, end_s);
  }
}

static void follow_surges(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  row_of *row = r->state;
  if (!c->was_on && !c->on) return;
  row->present_i2_s += c->more[VS_OF_I2];
  if (!c->on) end_conduction(w, r, c->t1_s);
}

static void finish_surges(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  row_of *row = r->state;
  if (!has_surges(w, r)) return;
  if (row->present_i2_s > 0) end_conduction(w, r, end->now_s);
  const double most = vs_devices_most_surges(w->deck, w->device);
  if (w->at_work && row->count) { /* an orbit goes on beyond the table's end */
    const double cycles = (end->to_s - end->from_s) / w->timeline->period_s;
    judge_row(w, r, w->sum[VS_OF_I2] * most / cycles, most, end->now_s);
  } else if (row->count > MOST_PULSES) {
    const size_t last = (row->count - 1) % MOST_PULSES, first = row->count % MOST_PULSES;
    if (most > spans(w, row->end_s[last] - row->end_s[first]))
      r->unjudged = w->timeline->supply.direct
                        ? "not judged: its table goes on beyond 512 conductions in a row"
                        : "not judged: its table goes on beyond 512 conductions in a row; "
                          "vibrospice steady SCENE judges them";
  }
}

/* One conduction below 10 ms, by its int i^2 dt and its peak. The half sine of the same two lasts
 * 2 int i^2 dt / peak^2. What the part bears is i2sqrt_t times the root of that. */
typedef struct short_of {
  double i2_s, peak_a;
  judged worst;
} short_of;

static const vs_limit *root_limit(const vs_watched *w) {
  const char *file = w->device->part < 0 ? NULL : w->deck->parts[w->device->part].file;
  const vs_limit *limit = file ? vs_parts_find_limit(w->deck, file, "i2sqrt_t") : NULL;
  return limit && isfinite(limit->value) ? limit : NULL;
}

static bool has_root(const vs_watched *w, const vs_reduced *r) {
  (void)r;
  return root_limit(w);
}

static void end_short(const vs_watched *w, vs_reduced *r, double end_s) {
  short_of *s = r->state;
  const vs_limit *root = root_limit(w);
  const double length_s = 2 * s->i2_s / (s->peak_a * s->peak_a);
  const vs_value v = {true, s->i2_s, end_s};
  s->i2_s = s->peak_a = 0;
  if (!(length_s > 0) || length_s >= SURGE_S) return;
  double allowed = root->value * sqrt(length_s);
  if (!take_judged(r, &s->worst, v, allowed, root->unsure)) return;
  vs_limit *limit = &s->worst.limit;
  snprintf(limit->name, sizeof limit->name, "i2sqrt_t");
  snprintf(limit->unit, sizeof limit->unit, "A2.s");
  snprintf(limit->text, sizeof limit->text, "half sine of %.4g ms", 1e3 * length_s);
  snprintf(limit->written, sizeof limit->written, "%.4g A2.s", allowed);
}

static void follow_short(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  short_of *s = r->state;
  if (!c->was_on && !c->on) return;
  s->i2_s += c->more[VS_OF_I2];
  s->peak_a = fmax(s->peak_a, fmax(fabs(c->from[VS_OF_I]), fabs(c->to[VS_OF_I])));
  if (!c->on) end_short(w, r, c->t1_s);
}

static void finish_short(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  const short_of *s = r->state;
  if (s->i2_s > 0) end_short(w, r, end->now_s);
}

const vs_reducer vs_surge_rows = {.state_size = sizeof(row_of),
                                  .hangs_on_sequence = true,
                                  .finds_limit = true,
                                  .is_busy = has_surges,
                                  .follow = follow_surges,
                                  .finish = finish_surges},
                 vs_surge_short = {.state_size = sizeof(short_of),
                                   .hangs_on_sequence = true,
                                   .finds_limit = true,
                                   .is_busy = has_root,
                                   .follow = follow_short,
                                   .finish = finish_short};
