/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/devices.h"

#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "devices/losses.h"
#include "devices/melting.h"
#include "devices/reductions.h"
#include "engine/batch.h"

/* The shots of a device that conducts or blocks. One that goes out in a ring and is fired again by
 * the same gate pulse is at the same shot, as long as the same half cycle of the mains may drive
 * it. */
typedef struct shots {
  vs_gate_watch gate; /* the device's, or the deck's first where that is not known */
  bool fresh;         /* a gate pulse has begun since the device last began to conduct */
  double last_s;      /* when the last shot began; -INFINITY: none did */
} shots;

/* On an orbit the period's beginning comes again behind its end. The steps up to the first firing
 * are kept, so that a conduction, or the rest behind one, is followed on across the period's end.
 */
enum { KEPT = 32768 };
typedef struct opening {
  bool over; /* the device has fired, or there were more steps than that */
  size_t count;
  struct {
    double at_s, v, i; /* at the step's end */
    double i2_s;       /* int i^2 dt over it */
  } step[KEPT];
} opening;

struct vs_device_watch {
  vs_formula_prepared voltage, current, flux; /* flux: of a device that has one */
  shots shots;
  vs_melting melting; /* of a fuse */
  opening *opening;   /* of a device that conducts or blocks, on an orbit; NULL: of any other. Owned
                       */
  vs_reduced **busy;  /* those of the device's measures that every step may change; owned */
  size_t n_busy;
  vs_reduced **now; /* those of them that the present batch may change; behind them */
  size_t n_now;
};

/* ---- beginning ---- */

/* Takes of the limit what the part's lines `derate` leave at the run's ambient temperature. */
static void derate(const vs_watched *w, vs_reduced *r) {
  if (!r->limit) return;
  r->limit = vs_devices_derated(w->deck, r->limit, w->ambient_degc, &r->own);
  if (!r->limit) r->unjudged = "not judged: its lines derate end before that ambient temperature";
}

/* More parts than that are joined. */
enum { MOST_PARTS = 1000 };

/* Divides the stretch that means are over. Its end is known before the run is. */
static void begin_parts(vs_parts *p, const vs_timeline *t, vs_span_s means) {
  const double cycle_s = t->period_s * (t->firing.every > 1 ? t->firing.every : 1);
  p->meant_s = means.from_s;
  const double cycles = floor((means.to_s - means.from_s) / cycle_s * (1 + 1e-9) + 1e-9);
  if (!(cycles >= 1) || isinf(cycles)) return;
  const double each = ceil(cycles / MOST_PARTS);
  p->count = (size_t)(cycles / each);
  p->part_s = each * cycle_s;
  p->from_s = means.to_s - (double)p->count * p->part_s;
  if (p->from_s < means.from_s + 1e-6 * cycle_s) p->from_s = means.from_s; /* but for rounding */
  p->sum = vs_alloc(p->count, sizeof *p->sum);
}

static void begin_measure(vs_watched *w, vs_reduced *r, const vs_device_measure *m) {
  const vs_reducer *by = vs_reductions_all[m->how];
  assert(by);
  *r = (vs_reduced){.measure = m,
                    .by = by,
                    .limit = vs_devices_limit(w->deck, w->device, m),
                    .value = {.known = by->counts && w->device->gates.count, .at_s = NAN},
                    .failed_s = NAN};
  derate(w, r);
  if (by->state_size)
    r->state = vs_alloc(1, by->state_size + (w->again || w->from_work ? by->again_size : 0));
  if (by->prepare) by->prepare(w, r);
}

static void begin_shots(shots *s, const vs_frame *frame, const vs_device *d) {
  *s = (shots){.fresh = true, .last_s = -INFINITY};
  vs_gate_watch_begin(&s->gate, frame->timeline, &d->gates);
}

static void begin_device(vs_watched *w, vs_device_watch *own, const vs_frame *frame,
                         const vs_device *d, vs_span_s means) {
  *w = (vs_watched){.device = d,
                    .deck = frame->deck,
                    .timeline = frame->timeline,
                    .cooling = frame->cooling,
                    .at_work = frame->at_work,
                    .from_work = frame->from_work,
                    .ambient_degc = frame->cooling ? frame->cooling->ambient_degc : 25,
                    .on_orbit = frame->on_orbit,
                    .again = frame->at_work || vs_scene_event_repeated(&frame->timeline->events),
                    .count = d->kind->n_measures};
  own->voltage = vs_formula_prepare(&d->voltage);
  own->current = vs_formula_prepare(&d->current);
  if (d->has_flux) own->flux = vs_formula_prepare(&d->flux);
  if (d->kind->switches) {
    w->states = vs_alloc(1, sizeof *w->states);
    static const vs_gates NONE = {0};
    vs_switching_begin(w->states, frame->timeline, d->kind->gated ? &d->gates : &NONE, frame->deck,
                       d);
    begin_shots(&own->shots, frame, d);
    if (w->at_work) own->opening = vs_alloc(1, sizeof *own->opening);
  }
  w->reduced = vs_alloc(w->count, sizeof *w->reduced);
  own->busy = vs_alloc(2 * w->count, sizeof *own->busy);
  own->now = own->busy + w->count;
  for (size_t k = 0; k < w->count; k++) {
    vs_reduced *r = &w->reduced[k];
    begin_measure(w, r, &d->kind->measures[k]);
    unsigned unsure = 0; /* of what is cooled the mean power is asked for */
    const bool warms = r->measure->how == VS_R_CASE && w->cooling &&
                       isfinite(vs_cooling_to_ambient(w->cooling, w->deck, d, &unsure));
    if (r->by->continuous && (r->limit || warms) && !w->at_work && !w->parts.count)
      begin_parts(&w->parts, frame->timeline, means);
    if (r->by->follow && (!r->by->is_busy || r->by->is_busy(w, r))) own->busy[own->n_busy++] = r;
  }
}

/* A device has at most a misfire, a firing or an end of one, and what is to be said of the firing
 * in a step. */
enum { EACH = 3 };

vs_devices *vs_devices_new(const vs_frame *frame) {
  size_t count = frame->deck ? frame->deck->n_devices : 0;
  if (!count) return NULL;
  vs_devices *d = vs_alloc(1, sizeof *d + count * sizeof *d->item);
  d->frame = frame;
  d->count = count;
  d->watch = vs_alloc(count, sizeof *d->watch);
  d->incidents = vs_alloc(2 * count * EACH * VS_BATCH_STEPS, sizeof *d->incidents);
  d->began_s = NAN;
  d->means = frame->means;
  if (!(d->means.to_s > 0)) d->means = (vs_span_s){0, INFINITY};
  for (size_t k = 0; k < count; k++)
    begin_device(&d->item[k], &d->watch[k], frame, &frame->deck->devices[k], d->means);
  for (size_t k = 0; k < count; k++) d->tells = d->tells || d->item[k].device->kind->both_ways;
  return d;
}

void vs_devices_free(vs_devices *d) {
  for (size_t k = 0; d && k < d->count; k++) {
    vs_watched *w = &d->item[k];
    for (size_t n = 0; n < w->count; n++) free(w->reduced[n].state);
    free(w->reduced);
    free(w->states);
    free(w->losses);
    free(w->parts.sum);
    free(d->watch[k].busy);
    free(d->watch[k].opening);
  }
  if (d) free(d->watch);
  if (d) free(d->incidents);
  free(d);
}

/* ---- courses ---- */

static void complete_courses(double course[VS_COURSES]) {
  course[VS_OF_POWER] = course[VS_OF_V] * course[VS_OF_I];
  course[VS_OF_I2] = course[VS_OF_I] * course[VS_OF_I];
  course[VS_OF_V2] = course[VS_OF_V] * course[VS_OF_V];
}

/* Integrates a course over each step of a batch by Simpson's rule. */
static void integrate_course(const vs_batch *b, const vs_pair *y, double last, double *more) {
  for (size_t n = 0; n < b->count; n++) {
    more[n] = (b->t1_s[n] - b->t0_s[n]) * (last + 4 * y[n][0] + y[n][1]) / 6;
    last = y[n][1];
  }
}

static void evaluate_course(const vs_watched *w, const vs_device_watch *own, const vs_batch *b,
                            vs_courses *c) {
  vs_pair *v = c->of[VS_OF_V], *i = c->of[VS_OF_I];
  c->count = b->count;
  vs_batch_evaluate(&own->voltage, b, v);
  vs_batch_evaluate(&own->current, b, i);
  for (size_t n = 0; n < b->count; n++) c->of[VS_OF_POWER][n] = v[n] * i[n];
  for (size_t n = 0; n < b->count; n++) c->of[VS_OF_I2][n] = i[n] * i[n];
  for (size_t n = 0; n < b->count; n++) c->of[VS_OF_V2][n] = v[n] * v[n];
  if (own->flux.formula) vs_batch_evaluate(&own->flux, b, c->of[VS_OF_FLUX]);
  for (int of = VS_OF_V; of < VS_COURSES; of++)
    integrate_course(b, c->of[of], w->last[of], c->more[of]);
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
    complete_courses(y[k]);
  }
  for (int of = VS_OF_V; of < VS_COURSES; of++)
    sum[of] += (to - from) * c->h_s * (y[0][of] + 4 * y[1][of] + y[2][of]) / 6;
}

static void follow_shots(const vs_devices *d, vs_watched *w, shots *s, const vs_course_step *c) {
  vs_gate_watch_follow(&s->gate, c->t0_s, c->t1_s);
  s->fresh = s->fresh || s->gate.begins;
  if (!c->on || c->was_on) return;
  bool gated = s->gate.on && s->gate.gates.count;
  bool again = gated && !s->fresh && c->t0_s - s->last_s < d->frame->timeline->period_s / 2;
  s->fresh = false;
  w->sequence.edge = w->sequence.edge || again;
  if (again) return;
  s->last_s = c->t0_s;
  w->starts += c->t1_s > d->means.from_s && c->t0_s < d->means.to_s;
}

/* The part into which an instant falls; below 0, or the count and more: none. */
static double number_of_part_at(const vs_parts *p, double t_s) {
  return floor((t_s - p->from_s) / p->part_s);
}

/* Adds to the integrals over the parts of that stretch into which the step reaches. */
static void follow_parts(vs_parts *p, const vs_course_step *c) {
  const double first = number_of_part_at(p, c->t0_s), last = number_of_part_at(p, c->t1_s),
               count = (double)p->count;
  for (double k = fmax(first, 0); k <= last && k < count; k++) {
    double *sum = p->sum[(size_t)k];
    if (first == last) {
      for (int of = VS_OF_V; of < VS_COURSES; of++) sum[of] += c->more[of];
      return;
    }
    const double from = (p->from_s + k * p->part_s - c->t0_s) / c->h_s,
                 to = (p->from_s + (k + 1) * p->part_s - c->t0_s) / c->h_s;
    integrate_part(c, fmax(from, 0), fmin(to, 1), sum);
  }
}

/* Adds to the integrals over the stretch that means are over. */
static void follow_means(const vs_devices *d, vs_watched *w, const vs_course_step *c) {
  if (w->parts.count) follow_parts(&w->parts, c);
  if (c->t0_s >= d->means.from_s && c->t1_s <= d->means.to_s) {
    w->rests = w->rests || !c->on;
    for (int of = VS_OF_V; of < VS_COURSES; of++) w->sum_meant[of] += c->more[of];
    return;
  }
  double from_s = fmax(c->t0_s, d->means.from_s), to_s = fmin(c->t1_s, d->means.to_s);
  if (!(to_s > from_s)) return;
  w->rests = w->rests || !c->on;
  integrate_part(c, (from_s - c->t0_s) / c->h_s, (to_s - c->t0_s) / c->h_s, w->sum_meant);
}

/* ---- step by step ---- */

static void add_incident(vs_devices *d, double at_s, const vs_watched *w, const char *what) {
  const vs_incident one = {d->step, (size_t)(w - d->item), at_s, w->device->name, what};
  size_t n = d->n_incidents++;
  for (; n; n--) { /* devices are followed one by one */
    const vs_incident *before = &d->incidents[n - 1];
    if (before->step < one.step || (before->step == one.step && before->which <= one.which)) break;
    d->incidents[n] = *before;
  }
  d->incidents[n] = one;
}

static void tell_firing(vs_devices *d, const vs_watched *w, const vs_switch_news *news) {
  static const char *const FIRES[] = {"fires (negative half cycle)", "fires",
                                      "fires (positive half cycle)"},
                           *const EXTINCT[] = {"extinct (negative half cycle)", "extinct",
                                               "extinct (positive half cycle)"};
  int half = w->device->kind->both_ways ? (news->way < 0 ? 0 : 2) : 1;
  if (news->extinct.known) add_incident(d, news->extinct.at_s, w, EXTINCT[half]);
  if (news->fires.known) add_incident(d, news->fires.at_s, w, FIRES[half]);
}

static void tell_switch_news(vs_devices *d, const vs_watched *w, const vs_switch_news *news) {
  if (news->misfire.known) add_incident(d, news->misfire.at_s, w, "misfires");
  if (d->tells && w->device->kind->gated) tell_firing(d, w, news);
  if (news->unintended.known)
    add_incident(d, news->unintended.at_s, w,
                 news->commutation_failure ? "fires without a gate pulse (commutation failure)"
                                           : "fires without a gate pulse (unintended firing)");
}

static void note_fuse_deed(vs_watched *w, vs_deed deed, double at_s) {
  vs_reducer_add_deed(&w->sequence, deed, at_s);
  w->sequence.edge = true;
}

/* True for a fuse that did not melt by what it carried: an event opened its circuit before. */
static bool is_opened(const vs_watched *w, const vs_melting *m) {
  const size_t event = w->device->opened_by;
  return event && m->melted && m->melted_s >= w->timeline->events.item[event - 1].start_s;
}

static void follow_fuse(vs_devices *d, vs_watched *w, vs_melting *m, const vs_course_step *c) {
  vs_melting_news news = vs_melting_follow(m, c);
  if (is_opened(w, m)) return;
  if (!isnan(news.melts_s)) note_fuse_deed(w, VS_DEED_MELTS, news.melts_s);
  if (!isnan(news.cleared_s)) note_fuse_deed(w, VS_DEED_CLEARS, news.cleared_s);
  if (!isnan(news.again_s)) note_fuse_deed(w, VS_DEED_ARCS_AGAIN, news.again_s);
  if (!isnan(news.melts_s)) add_incident(d, news.melts_s, w, "melts");
  if (!isnan(news.cleared_s)) add_incident(d, news.cleared_s, w, "has cleared");
  if (!isnan(news.again_s)) add_incident(d, news.again_s, w, "arcs again");
  for (size_t k = 0; k < w->count; k++)
    if (w->reduced[k].by->take_melting) w->reduced[k].by->take_melting(&w->reduced[k], &news);
}

/* Of the order of a latching current. A device that recovers and whose gate made it conduct no more
 * than this may or may not have latched. */
static const double BARELY_A = 0.1;

/* A circuit that offers no more than so many t_q may have the device fire again. */
static const double OFFERS = 2;

/* True: what a small error may undo has happened, or nearly. */
static bool is_on_edge(const vs_switch *s, const vs_switch_news *news) {
  if (news->misfire.known || news->unintended.known) return true;
  if (news->extinct.known && s->conduction.recovers && s->conduction.peak_a < BARELY_A) return true;
  return news->offered.known && isfinite(s->t_q_s) && news->offered.value < OFFERS * s->t_q_s;
}

static void note_deeds(vs_watched *w, const vs_switch_news *news) {
  vs_sequence *q = &w->sequence;
  q->bursts = w->states->gate.bursts;
  if (news->extinct.known) vs_reducer_add_deed(q, VS_DEED_GOES_OUT, news->extinct.at_s);
  if (news->fires.known) vs_reducer_add_deed(q, VS_DEED_FIRES, news->fires.at_s);
  if (news->misfire.known) vs_reducer_add_deed(q, VS_DEED_MISFIRES, news->misfire.at_s);
  if (news->unintended.known) vs_reducer_add_deed(q, VS_DEED_UNINTENDED, news->unintended.at_s);
  if (news->commutation_failure) vs_reducer_add_deed(q, VS_DEED_FAILS, news->unintended.at_s);
  q->edge = q->edge || (w->device->kind->gated && is_on_edge(w->states, news));
}

/* True where a fuse of the deck melted in the conduction that the device has ended. The fuse then
 * keeps its voltage away from the device: the little that is left of it can drive no current. */
static bool is_ended_by_fuse(const vs_devices *d, const vs_switch *s) {
  for (size_t k = 0; k < d->count; k++) {
    const vs_melting *m = &d->watch[k].melting;
    if (m->melted && m->melted_s > s->fired_s && m->melted_s <= s->zero_s) return true;
  }
  return false;
}

static void follow_states(vs_devices *d, vs_watched *w, vs_course_step *c) {
  vs_switch_news news;
  c->was_on = w->states->conduction.conducts;
  vs_switching_follow(w->states, c, &news);
  c->on = w->states->conduction.conducts;
  if (news.offered.known && is_ended_by_fuse(d, w->states)) news.offered.known = false;
  if (!news.any) return;
  note_deeds(w, &news);
  for (size_t k = 0; k < w->count; k++)
    if (w->reduced[k].by->take_news) w->reduced[k].by->take_news(w, &w->reduced[k], &news);
  tell_switch_news(d, w, &news);
}

static void keep_opening_step(opening *o, const vs_course_step *c) {
  o->over = o->over || (c->on && !c->was_on) || o->count == KEPT;
  if (o->over) return;
  o->step[o->count].at_s = c->t1_s;
  o->step[o->count].v = c->to[VS_OF_V];
  o->step[o->count].i = c->to[VS_OF_I];
  o->step[o->count++].i2_s = c->more[VS_OF_I2];
}

/* Takes one step of the k-th device, whose courses and their integrals c holds. */
static void follow_step_of_device(vs_devices *d, size_t k, vs_course_step *c) {
  vs_watched *w = &d->item[k];
  vs_device_watch *own = &d->watch[k];

  /* The integrals over the run; and what speaks for a wrong sign in the device's line. */
  for (int of = VS_OF_V; of < VS_COURSES; of++) w->sum[of] += c->more[of];
  if (c->more[VS_OF_POWER] < 0) w->given_j -= c->more[VS_OF_POWER];
  if (c->more[VS_OF_I] < 0) w->back_c -= c->more[VS_OF_I];

  /* What the device did: conducted, blocked, melted. */
  c->was_on = c->on = true; /* a device that does not switch conducts all the time */
  if (w->states) follow_states(d, w, c);
  if (w->states) follow_shots(d, w, &own->shots, c);
  if (own->opening) keep_opening_step(own->opening, c);
  if (w->device->kind->melts) follow_fuse(d, w, &own->melting, c);
  if (w->losses) vs_losses_follow(w->losses, c);

  /* The means, and the measures that any step may change. */
  follow_means(d, w, c);
  for (size_t n = 0; n < own->n_now; n++) own->now[n]->by->follow(w, own->now[n], c);
}

/* The courses at the first step's beginning, where peaks and pulses begin. */
void vs_devices_begin(vs_devices *d, const vs_step *step) {
  const double *terms = step->from->terms;
  if (!d) return;
  d->began_s = step->from->t_s;
  for (size_t k = 0; k < d->count; k++) {
    vs_watched *w = &d->item[k];
    const vs_device_watch *own = &d->watch[k];
    w->last[VS_OF_V] = vs_formula_value(own->voltage.formula, terms);
    w->last[VS_OF_I] = vs_formula_value(own->current.formula, terms);
    if (own->flux.formula) w->last[VS_OF_FLUX] = vs_formula_value(own->flux.formula, terms);
    complete_courses(w->last);
    if (w->losses) vs_losses_resume(w->losses, w->last[VS_OF_V], w->last[VS_OF_I]);
    if (w->states) vs_switching_resume(w->states, w->last[VS_OF_I], w->last[VS_OF_V]);
    if (w->states && w->states->conduction.conducts)
      vs_reducer_add_deed(&w->sequence, VS_DEED_FIRES, d->began_s);
    for (size_t n = 0; n < own->n_busy; n++)
      if (own->busy[n]->by->begin) own->busy[n]->by->begin(w, own->busy[n], d->began_s);
  }
}

/* Lists the measures that these steps may change. */
static void find_restless(const vs_watched *w, vs_device_watch *own, const vs_courses *c) {
  own->n_now = 0;
  for (size_t n = 0; n < own->n_busy; n++) {
    vs_reduced *r = own->busy[n];
    if (!r->by->rests || !r->by->rests(w, r, c)) own->now[own->n_now++] = r;
  }
}

/* Takes the measures that ask for their own course alone through the steps, one by one, and leaves
 * the others in the list. */
static void follow_own_courses(const vs_watched *w, vs_device_watch *own, const vs_batch *b,
                               const vs_courses *all) {
  size_t others = 0;
  for (size_t k = 0; k < own->n_now; k++) {
    vs_reduced *r = own->now[k];
    const int of = r->measure->of;
    vs_course_step c = {.h_s = 0};
    if (!r->by->own_course) {
      own->now[others++] = r;
      continue;
    }
    c.to[of] = w->last[of];
    for (size_t n = 0; n < b->count; n++) {
      c.from[of] = c.to[of];
      c.t0_s = b->t0_s[n];
      c.t1_s = b->t1_s[n];
      c.h_s = c.t1_s - c.t0_s;
      if (!(c.h_s > 0)) continue;
      c.to[of] = all->of[of][n][1];
      if (of != VS_OF_FLUX) c.more[of] = all->more[of][n];
      r->by->follow(w, r, &c);
    }
  }
  own->n_now = others;
}

/* True if all that these steps bring is a share of each integral: the device does not switch, melt
 * or tell what its loss is made of, all of the steps count in its means, and its measures rest. */
static bool only_adds_up(const vs_devices *d, size_t k, const vs_batch *b) {
  const vs_watched *w = &d->item[k];
  bool meant = b->t0_s[0] >= d->means.from_s && b->t1_s[b->count - 1] <= d->means.to_s;
  if (w->parts.count)
    meant = meant && number_of_part_at(&w->parts, b->t0_s[0]) >= 0 &&
            number_of_part_at(&w->parts, b->t0_s[0]) ==
                number_of_part_at(&w->parts, b->t1_s[b->count - 1]) &&
            number_of_part_at(&w->parts, b->t0_s[0]) < (double)w->parts.count;
  return meant && !w->states && !w->losses && !w->device->kind->melts && !d->watch[k].n_now;
}

/* Takes such steps at once, as follow_step_of_device would one by one. Such a device counts as
 * conducting all the time. */
static void add_up(vs_watched *w, double t_s, const vs_courses *c) {
  double *part = w->parts.count ? w->parts.sum[(size_t)number_of_part_at(&w->parts, t_s)] : NULL;
  for (int of = VS_OF_V; of < VS_COURSES; of++)
    for (size_t n = 0; n < c->count; n++) {
      w->sum[of] += c->more[of][n];
      w->sum_meant[of] += c->more[of][n];
      if (part) part[of] += c->more[of][n];
    }
  for (size_t n = 0; n < c->count; n++) {
    if (c->more[VS_OF_POWER][n] < 0) w->given_j -= c->more[VS_OF_POWER][n];
    if (c->more[VS_OF_I][n] < 0) w->back_c -= c->more[VS_OF_I][n];
  }
}

/* Goes through the steps one by one. */
static void follow_steps(vs_devices *d, size_t k, const vs_batch *b, const vs_courses *all) {
  vs_watched *w = &d->item[k];
  const bool flux = d->watch[k].flux.formula;
  vs_course_step c = {.h_s = 0};
  memcpy(c.to, w->last, sizeof c.to);
  for (size_t n = 0; n < b->count; n++) {
    memcpy(c.from, c.to, sizeof c.from);
    c.t0_s = b->t0_s[n];
    c.t1_s = b->t1_s[n];
    c.h_s = c.t1_s - c.t0_s;
    if (!(c.h_s > 0)) continue;
    for (int of = flux ? VS_OF_FLUX : VS_OF_V; of < VS_COURSES; of++) {
      c.mid[of] = all->of[of][n][0];
      c.to[of] = all->of[of][n][1];
    }
    for (int of = VS_OF_V; of < VS_COURSES; of++) c.more[of] = all->more[of][n];
    d->step = d->followed + n;
    follow_step_of_device(d, k, &c);
  }
}

static void follow_device(vs_devices *d, size_t k, const vs_batch *b) {
  vs_watched *w = &d->item[k];
  vs_courses c;
  size_t last = b->count - 1;
  evaluate_course(w, &d->watch[k], b, &c);
  find_restless(w, &d->watch[k], &c);
  follow_own_courses(w, &d->watch[k], b, &c);
  if (only_adds_up(d, k, b))
    add_up(w, b->t0_s[0], &c);
  else
    follow_steps(d, k, b, &c);
  for (int of = 0; of < VS_COURSES; of++)
    if (of != VS_OF_FLUX || d->watch[k].flux.formula) w->last[of] = c.of[of][last][1];
}

void vs_devices_tell_anew(vs_devices *d) {
  if (d) d->n_incidents = d->followed = d->here = 0;
}

void vs_devices_follow(vs_devices *d, const vs_batch *b) {
  if (!d) return;
  for (int others = 0; others < 2; others++) /* what ends by a fuse asks when that melted */
    for (size_t k = 0; k < d->count; k++)
      if (d->item[k].device->kind->melts != others) follow_device(d, k, b);
  d->here = d->followed + b->last;
  d->followed += b->count;
  d->now_s = b->t1_s[b->count - 1];
}

/* Takes in a step of the opening. What the device does against its gate there was told already. */
static void follow_again(const vs_watched *w, vs_course_step *c) {
  vs_switch_news news;
  c->was_on = w->states->conduction.conducts;
  vs_switching_follow(w->states, c, &news);
  c->on = w->states->conduction.conducts;
  news.misfire.known = news.unintended.known = news.commutation_failure = false;
  for (size_t m = 0; m < w->count; m++) {
    const vs_reducer *by = w->reduced[m].by;
    if (news.any && by->take_news) by->take_news(w, &w->reduced[m], &news);
    if (by->across) by->follow(w, &w->reduced[m], c);
  }
}

/* Follows the device from the period's end on, through its opening. What is found there is told
 * with its instant within the period. */
static void follow_across_period(const vs_devices *d, const vs_watched *w, const opening *o) {
  const double period_s = d->now_s - d->began_s;
  vs_course_step c = {.t1_s = d->now_s};
  memcpy(c.to, w->last, sizeof c.to);
  for (size_t n = 0; n < o->count; n++) {
    c.t0_s = c.t1_s;
    memcpy(c.from, c.to, sizeof c.from);
    c.t1_s = o->step[n].at_s + period_s;
    c.h_s = c.t1_s - c.t0_s;
    c.to[VS_OF_V] = o->step[n].v;
    c.to[VS_OF_I] = o->step[n].i;
    c.more[VS_OF_I2] = o->step[n].i2_s;
    complete_courses(c.to);
    if (c.h_s > 0) follow_again(w, &c);
  }
  for (size_t m = 0; m < w->count; m++) {
    vs_reduced *r = &w->reduced[m];
    if (r->value.at_s > d->now_s) r->value.at_s -= period_s;
    if (r->failed_s > d->now_s) r->failed_s -= period_s;
  }
}

/* The sizes of what a circuit's equations are summed from: the largest current and voltage of any
 * of its devices, and for how long. */
typedef struct sizes {
  double a, v, s;
} sizes;

static sizes find_sizes(const vs_devices *d) {
  sizes z = {0, 0, d->now_s - d->began_s};
  for (size_t k = 0; k < d->count; k++)
    for (size_t n = 0; n < d->item[k].count; n++) {
      const vs_reduced *r = &d->item[k].reduced[n];
      const double size = fabs(r->value.value);
      if (!r->value.known || !isfinite(size)) continue;
      if (!strcmp(r->measure->unit, "A")) z.a = fmax(z.a, size);
      if (!strcmp(r->measure->unit, "V")) z.v = fmax(z.v, size);
    }
  return z;
}

/* The current of a device is what the other currents of its node leave over, and its voltage is a
 * difference of two nodes' voltages. So neither is known better than to the rounding of the largest
 * in the circuit, and power and energy not better than to that part of the product of both. A sum
 * of sixteen such terms, more than a node has, is off by their number times the rounding of one. */
enum { TERMS = 16 };

static double size_of_unit(const char *unit, const sizes *z) {
  if (!strcmp(unit, "A")) return z->a;
  if (!strcmp(unit, "V")) return z->v;
  if (!strcmp(unit, "W")) return z->a * z->v;
  return !strcmp(unit, "J") ? z->a * z->v * z->s : 0;
}

static void round_off_reduced(const vs_watched *w, vs_reduced *r, const sizes *z) {
  const char *unit = r->measure->unit;
  const double whole = !strcmp(unit, "J") ? fabs(w->sum[VS_OF_POWER]) : 0; /* it is a part of */
  r->value.value = vs_extreme_told(r->value.value, fmax(TERMS * size_of_unit(unit, z), whole));
}

void vs_devices_finish(vs_devices *d) {
  if (!d || isnan(d->began_s)) return;
  for (size_t k = 0; k < d->count; k++)
    if (d->watch[k].opening) follow_across_period(d, &d->item[k], d->watch[k].opening);
  const vs_run_end end = {d->now_s, fmax(d->began_s, d->means.from_s),
                          fmin(d->now_s, d->means.to_s)};
  for (size_t k = 0; k < d->count; k++)
    for (size_t n = 0; n < d->item[k].count; n++) {
      vs_reduced *r = &d->item[k].reduced[n];
      if (r->by->finish) r->by->finish(&d->item[k], r, &end);
    }
  for (size_t k = 0; k < d->count; k++)
    for (size_t n = 0; n < d->item[k].count; n++) {
      vs_reduced *r = &d->item[k].reduced[n];
      if (r->by->settle) r->by->settle(&d->item[k], r);
    }
  const sizes z = find_sizes(d);
  for (size_t k = 0; k < d->count; k++)
    for (size_t n = 0; n < d->item[k].count; n++)
      round_off_reduced(&d->item[k], &d->item[k].reduced[n], &z);
}

bool vs_devices_fails_to_clear(const vs_devices *d, size_t which, char *text, size_t size) {
  const vs_watched *w = &d->item[which];
  const vs_melting *m = &d->watch[which].melting;
  const bool direct = w->timeline->supply.direct, goes_on = m->melted && (!m->cleared || m->again);
  const double drives_v = w->device->mains_v * (direct ? 1 : M_SQRT2);
  if (!w->device->kind->melts || !goes_on || !(m->arc_v > 0 && m->arc_v < drives_v)) return false;
  snprintf(text, size,
           "%s has melted and does not clear: the voltage of its arc, %.3g V, is below %s, %.4g V, "
           "which drives its current on; a fuse whose arc has more is wanted",
           w->device->name, m->arc_v, direct ? "the direct voltage" : "the crest of the mains",
           drives_v);
  return true;
}

/* ---- a wrong sign in a line of the deck ---- */

/* The wrong way must be this many times the right one: what a capacitance inside gives back is
 * about what it took before. */
static const double TIMES = 3;
/* Below this share of the run's energy a device's own says nothing: a capacitance inside that was
 * charged as the run began gives what it had. */
static const double LEAST_SHARE = 1e-4;
/* No diode and no thyristor drops as much while it conducts, V. What leaks backwards does so at
 * more. */
static const double ON_V = 10;

bool vs_devices_sign_is_wrong(const vs_watched *w, double whole_j, char *text, size_t size) {
  const vs_kind *kind = w->device->kind;
  double net_j = w->sum[VS_OF_POWER], least_j = LEAST_SHARE * whole_j;
  double taken_j = net_j + w->given_j, forth_c = w->sum[VS_OF_I] + w->back_c;
  const char *name = w->device->name;
  if (kind->stores) return false;
  if (w->given_j > least_j && w->given_j > TIMES * taken_j) {
    snprintf(text, size,
             "device %s gives %.3g J, which no %s does: the sign of its voltage or of its current "
             "is wrong in its line, and so are its measures",
             name, -net_j, kind->name);
    return true;
  }
  const bool zener = kind->clamps && kind->pins[0].text; /* its pins are not alike */
  bool one_way = (kind->switches && !kind->both_ways) || zener;
  bool conducts = net_j > least_j && net_j < ON_V * w->back_c;
  if (!one_way || !conducts || !(w->back_c > TIMES * forth_c)) return false;
  if (zener)
    snprintf(text, size,
             "device %s conducts as a forward diode alone and never clamps: its part is the wrong "
             "way round; a %s has its cathode first",
             name, kind->name);
  else
    snprintf(
        text, size,
        "device %s conducts backwards, which no %s does: its part is the wrong way round (a %s "
        "has its %s first), or its voltage and its current have the wrong sign in its line, "
        "and so have its measures",
        name, kind->name, kind->name, kind->pins[0].text);
  return true;
}
