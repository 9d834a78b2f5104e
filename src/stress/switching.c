/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "stress/switching.h"

#include <math.h>

#include "drive/events.h"
#include "drive/firing.h"
#include "drive/gate.h"

/* A current up to this is leakage: the device has not begun to conduct. */
static const double QUIET_A = 0.001;
/* A voltage above this counts as forward voltage that is blocked. It is above any on-state voltage.
 */
static const double FORWARD_V = 10;

/* What the voltage did since the last conduction. NONE also: the device has not conducted yet, or
 * its forward voltage was followed by reverse voltage. */
enum { REST_NONE, REST_NO_REVERSE_YET, REST_REVERSED, REST_FORWARD_AGAIN };

/* ---- gate ---- */

void vs_switching_gate_begin(vs_gate_watch *g, const vs_timeline *timeline, const vs_gates *gates) {
  *g = (vs_gate_watch){
      .timeline = timeline, .gates = *gates, .edge_s = -INFINITY, .off_since_s = -INFINITY};
}

void vs_switching_gate_follow(vs_gate_watch *g, const vs_course_step *c) {
  g->begins = g->ended = false;
  if (!g->gates.count) {
    g->on = true;
    return;
  }
  if (c->t1_s < g->edge_s) return;
  bool was = g->on;
  double at_s = vs_gate_of_step(c->t0_s, c->t1_s);
  /* an edge that is not told from this instant counts as one to come, so that the next step asks
   * again */
  double before_s = at_s - 3 * vs_occurrence_rounding(at_s);
  g->on = false;
  /* an event may add a pulse; a pulse that a control has not decided yet is not known */
  g->edge_s = fmin(vs_events_edge(&g->timeline->events, before_s), vs_firing_known_s(g->timeline));
  for (size_t k = 0; k < g->gates.count; k++) {
    g->on = g->on || vs_gate_is_on(g->timeline, g->gates.rad[k], at_s);
    g->edge_s = fmin(g->edge_s, vs_gate_edge(g->timeline, g->gates.rad[k], before_s));
  }
  g->begins = g->on && !was;
  g->ended = was && !g->on;
  if (g->ended) g->off_since_s = c->t0_s;
}

/* True while a gate pulse is known to be there. The device is then meant to conduct. */
static bool is_gated(const vs_switch *s) {
  return s->gate.on && s->gate.gates.count;
}

/* ---- rises of forward voltage ---- */

static void begin_rise(vs_rise *r, double t_s, double v) {
  r->count = 1;
  r->gated = true;
  r->t_s[0] = t_s;
  r->v[0] = v;
}

/* How far point k lies beside the straight line from point `before` to the next one, in time, as a
 * part of the time between these two. */
static double bend(const vs_rise *r, size_t before, size_t k) {
  double dt_s = r->t_s[k + 1] - r->t_s[before], dv = r->v[k + 1] - r->v[before];
  return fabs(r->t_s[k] - r->t_s[before] - (r->v[k] - r->v[before]) / dv * dt_s) / dt_s;
}

/* Leaves out points, no two of them side by side, that lie on a straight line with their neighbours
 * but for `most`. */
static void straighten(vs_rise *r, double most) {
  size_t kept = 1, last = r->count - 1;
  bool dropped = false;
  for (size_t k = 1; k <= last; k++) {
    dropped = k < last && !dropped && bend(r, kept - 1, k) <= most;
    if (dropped) continue;
    r->t_s[kept] = r->t_s[k];
    r->v[kept++] = r->v[k];
  }
  r->count = kept;
}

/* Leaves out a quarter of the points or more, those first that say least: a knee between a slow
 * rise and a steep one remains, however close the points about it are. */
static void thin_out(vs_rise *r) {
  for (double most = 1.0 / 1024; r->count > VS_RISE_POINTS / 4 * 3; most *= 2) straighten(r, most);
}

static double time_of(const vs_rise *r, double v) {
  size_t k = 1;
  while (k < r->count - 1 && r->v[k] < v) k++;
  return r->t_s[k - 1] + (v - r->v[k - 1]) / (r->v[k] - r->v[k - 1]) * (r->t_s[k] - r->t_s[k - 1]);
}

/* The mean rate from 10 to 90 % of the rise, with the instant of the 10 %. Not known: the rise is
 * lower than 10 V. */
static vs_value end_rise(const vs_rise *r) {
  double height = r->count > 1 ? r->v[r->count - 1] - r->v[0] : 0;
  if (height < FORWARD_V) return (vs_value){0};
  double begin = time_of(r, r->v[0] + 0.1 * height), end = time_of(r, r->v[0] + 0.9 * height);
  return (vs_value){true, 0.8 * height / (end - begin), begin};
}

/* Follows the present rise and returns its rate where it ends. gated: its gate pulse is there. A
 * rise ends at its top, once the voltage has come down by a tenth of it. It is followed while the
 * device conducts too, so that the voltage of a device that goes out is known from its own foot on:
 * where in that rise the current counts as gone is known less well than the voltage. */
static vs_value follow_rise(vs_rise *r, const vs_course_step *c, bool gated) {
  double v0 = c->from[VS_OF_V], v1 = c->to[VS_OF_V], now = fmax(v1, 0);
  if (!r->count) begin_rise(r, c->t0_s, fmax(v0, 0));
  double foot = r->v[0], top = r->v[r->count - 1];
  if (v0 < 0 && v1 > 0) {
    begin_rise(r, c->t0_s - v0 / (v1 - v0) * c->h_s, 0);
    foot = top = 0;
  }
  if (now > top) {
    if (r->count == VS_RISE_POINTS) thin_out(r);
    r->t_s[r->count] = c->t1_s;
    r->v[r->count++] = now;
    r->gated = r->gated && gated;
  } else if (r->count == 1 || top - now > 0.1 * (top - foot)) {
    vs_value rate = end_rise(r);
    begin_rise(r, c->t1_s, now);
    return rate;
  }
  return (vs_value){0};
}

/* ---- conduction ---- */

/* A current that is back so soon after its end goes on with the conduction before: at its latching
 * current, or by the solver's errors, it may touch the end for nanoseconds. */
static const double AT_ONCE_S = 1e-6;

/* Notes the forward voltage at which the current began, which may be many steps back. Of a current
 * that is back at once it is what the conduction before began at. */
static void follow_fired_v(vs_switch *s, const vs_course_step *c, double began_s) {
  if (began_s < c->t0_s) return;
  double v = fmax(c->from[VS_OF_V], c->to[VS_OF_V]);
  bool goes_on = isfinite(s->fired_s) && began_s - s->zero_s < AT_ONCE_S;
  s->fired_v = goes_on ? fmax(s->fired_v, v) : v;
}

/* What a device has stored when its gate pulse ends, or its unintended firing begins, decays within
 * some t_q of the part if it did not latch: by a factor of e in less than one, and an end is told
 * at some e^-8 of the current. A conduction that outlasts ten of them holds itself. Where t_q is
 * not known it counts as 150 us, which is long for a thyristor of this size. */
static const double DECAYS = 10, SLOW_T_Q_S = 150e-6;
static bool has_latched(const vs_switch *s) {
  bool by_pulse = s->by_gate && s->gate.gates.count;
  double from_s = by_pulse ? s->gate.off_since_s : s->fired_s;
  if (!(from_s >= s->fired_s)) return false; /* its pulse is still there */
  return s->zero_s - from_s > DECAYS * (isfinite(s->t_q_s) ? s->t_q_s : SLOW_T_Q_S);
}

/* Of a device that conducts both ways: notes since when its current is below a tenth of its peak.
 */
static void follow_fall(vs_switch *s, const vs_course_step *c) {
  double i0 = c->from[VS_OF_I], i1 = c->to[VS_OF_I], tenth_a = s->conduction.peak_a / 10;
  if (i1 > tenth_a)
    s->tenth_s = NAN;
  else if (isnan(s->tenth_s))
    s->tenth_s = i0 > tenth_a ? c->t0_s + (i0 - tenth_a) / (i0 - i1) * c->h_s : c->t0_s;
}

static void follow_conduction(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  const vs_conduction_step step = {c->t0_s,        c->t1_s,          c->from[VS_OF_I],
                                   c->to[VS_OF_I], c->from[VS_OF_V], c->to[VS_OF_V]};
  double event_s = NAN;
  s->conduction.gated = is_gated(s);
  switch (vs_conduction_follow(&s->conduction, &step, &event_s)) {
  case VS_EV_FIRES:
    s->fired_s = event_s;
    follow_fired_v(s, c, s->fired_s);
    s->tenth_s = NAN;
    s->commutates = false;
    news->fires = (vs_value){true, 1, event_s};
    break;
  case VS_EV_EXTINCT:
    s->zero_s = event_s;
    s->rest = c->to[VS_OF_V] < 0 && !s->both_ways ? REST_REVERSED : REST_NO_REVERSE_YET;
    if (event_s > s->tenth_s)
      news->fall = (vs_value){true, s->conduction.peak_a / 10 / (event_s - s->tenth_s), event_s};
    s->commutates = s->both_ways;
    news->extinct = (vs_value){true, 1, event_s};
    s->latched = has_latched(s);
    s->rose_s = NAN;
    break;
  default:
    /* while it rests after a conduction the voltage at which that began is still asked for */
    if (!s->conduction.conducts && (s->rest == REST_NONE || s->rest == REST_FORWARD_AGAIN))
      follow_fired_v(s, c, s->conduction.foot_s);
  }
}

/* The device is back at forward voltage without having been reversed: it did not latch. As long as
 * its gate pulse lasts it may be fired again, by the next of the sub-pulses, and the end of the
 * pulse will tell. Otherwise this is a misfire. */
static void fall_back(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  bool gate_known = s->gate.gates.count;
  s->rest = REST_NONE;
  if (s->gate.on)
    s->conducted = false;
  else if (s->by_gate && gate_known)
    news->misfire = (vs_value){true, 1, c->t1_s};
}

/* Forward voltage has returned. */
static void turn_off(vs_switch *s, double returned_s) {
  s->rest = REST_FORWARD_AGAIN;
  s->offers = true;
  s->offered_s = fmax(returned_s - s->zero_s, 0);
  s->offer = (vs_switch_news){.doubt_s = s->conduction.tail_s,
                              .spread_s = s->conduction.peak_a / s->conduction.tail_a_s};
  if (!is_gated(s)) /* else it is meant to conduct */
    s->offer.offered = (vs_value){true, s->offered_s, returned_s};
}

/* The forward voltage that has returned is one, or the device has fired from it. */
static void tell_offered(vs_switch *s, vs_switch_news *news) {
  if (!s->offers) return;
  s->offers = false;
  news->offered = s->offer.offered;
  news->doubt_s = s->offer.doubt_s;
  news->spread_s = s->offer.spread_s;
}

/* Follows the voltage of a device that blocks after a conduction: reverse, then forward again. One
 * that had latched, and went out by its holding current, may have forward voltage at once. Up to
 * half of what it fired from that is told from what it still drops as its charge decays by nothing,
 * and does not count. A voltage that turns back before it has come to 10 V was no return: behind
 * mains that are gone it is noise about zero. */
static void follow_rest(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  double v0 = c->from[VS_OF_V], v1 = c->to[VS_OF_V];
  switch (s->rest) {
  case REST_NO_REVERSE_YET:
    if (v1 < 0) s->rest = REST_REVERSED;
    if (isnan(s->rose_s) && v1 > FORWARD_V)
      s->rose_s = v0 < FORWARD_V ? c->t0_s + (FORWARD_V - v0) / (v1 - v0) * c->h_s : s->zero_s;
    if (s->fired_v < FORWARD_V || v1 < s->fired_v / 2) break;
    if (s->latched) {
      turn_off(s, isnan(s->rose_s) ? c->t1_s : s->rose_s);
      tell_offered(s, news);
    } else
      fall_back(s, c, news);
    break;
  case REST_REVERSED:
    if (v1 > 0) turn_off(s, v0 < 0 ? c->t0_s - v0 / (v1 - v0) * c->h_s : c->t0_s);
    if (v1 > FORWARD_V) tell_offered(s, news);
    break;
  case REST_FORWARD_AGAIN:
    if (v1 > FORWARD_V) tell_offered(s, news);
    if (v1 < 0) s->rest = s->offers ? REST_REVERSED : REST_NONE;
    if (s->both_ways && isnan(s->rose_s) && v1 > FORWARD_V) s->rose_s = c->t1_s;
    break;
  }
}

/* The blocking device's voltage has changed its sign: the other half cycle begins. Behind a
 * conduction this is the return of forward voltage. A rest is over with the half cycle behind it,
 * which the voltage must have gone to 10 V in: up to there it is noise about zero. */
static void turn_over(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  double v0 = c->from[VS_OF_V], v1 = c->to[VS_OF_V];
  double zero_s = v0 * v1 < 0 ? c->t0_s + v0 / (v0 - v1) * c->h_s : c->t0_s;
  s->way = -s->way;
  vs_conduction_turn(&s->conduction, zero_s);
  if (s->rest == REST_NO_REVERSE_YET) {
    turn_off(s, zero_s);
    tell_offered(s, news);
    s->rose_s = NAN;
  } else if (!isnan(s->rose_s))
    s->rest = REST_NONE;
}

/* The step as the present half cycle sees it. */
static vs_course_step in_half_cycle(const vs_switch *s, const vs_course_step *c) {
  vs_course_step f = *c;
  for (int of = VS_OF_V; of <= VS_OF_I; of++) {
    f.from[of] *= s->way;
    f.to[of] *= s->way;
  }
  return f;
}

/* A current has begun. Without a gate pulse at that time this is an unintended firing. */
static void judge_firing(vs_switch *s, vs_switch_news *news) {
  s->by_gate = s->gate.on || s->fired_s < s->gate.off_since_s;
  if (s->rest == REST_FORWARD_AGAIN) tell_offered(s, news);
  if (!s->by_gate) {
    news->unintended = (vs_value){true, 1, s->fired_s};
    news->commutation_failure = s->rest == REST_FORWARD_AGAIN && !(s->offered_s >= s->t_q_s);
  }
  s->rest = REST_NONE;
}

/* Follows whether the device answers its gate pulses. A pulse that found forward voltage and has
 * ended is unanswered; as long as a small current flows, though, it may still have been answered.
 */
static void follow_pulse(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  if (s->gate.begins) s->forward = s->conducted = false;
  if (s->gate.on) {
    s->conducted = s->conducted || s->conduction.conducts;
    s->forward = s->forward || fmax(c->from[VS_OF_V], c->to[VS_OF_V]) > FORWARD_V;
  }
  if (s->gate.ended && s->forward && !s->conducted) s->unanswered_s = c->t0_s;
  if (isnan(s->unanswered_s)) return;
  bool blocks = c->to[VS_OF_V] > FORWARD_V || c->to[VS_OF_I] <= QUIET_A;
  if (!s->conduction.conducts && !blocks) return;
  if (!s->conduction.conducts) news->misfire = (vs_value){true, 1, s->unanswered_s};
  s->unanswered_s = NAN;
}

void vs_switching_begin(vs_switch *s, const vs_timeline *timeline, const vs_gates *gates,
                        const vs_deck *deck, const vs_device *device) {
  *s = (vs_switch){.both_ways = device->kind->both_ways,
                   .way = 1,
                   .t_q_s = INFINITY,
                   .fired_s = NAN,
                   .rose_s = NAN,
                   .tenth_s = NAN,
                   .unanswered_s = NAN};
  vs_switching_gate_begin(&s->gate, timeline, gates);
  vs_conduction_begin(&s->conduction);
  s->conduction.recovers = vs_conduction_recovers(deck, device);
}

void vs_switching_resume(vs_switch *s, double i_a, double v_v) {
  if (s->both_ways) s->way = i_a < 0 ? -1 : 1;
  vs_conduction_resume(&s->conduction, s->way * i_a, s->way * v_v);
  if (!s->conduction.conducts) return;
  s->by_gate = true;
  s->fired_s = -INFINITY;
}

static void follow_current(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  bool was_on = s->conduction.conducts;
  if (!was_on) follow_rest(s, c, news);
  if (was_on && s->both_ways) follow_fall(s, c);
  follow_conduction(s, c, news);
  if (was_on || !s->conduction.conducts) return;
  judge_firing(s, news);
  s->turning_on = true;
}

/* The rate of the current up to its first maximum, and for AT_ONCE_S at the least: what a
 * junction's charge draws may make a maximum of milliamperes before the current of the circuit
 * comes. Not known behind that. */
static vs_value follow_turn_on(vs_switch *s, const vs_course_step *c, double rate) {
  bool early = c->t1_s - s->fired_s < AT_ONCE_S;
  s->turning_on = early || c->to[VS_OF_I] >= c->from[VS_OF_I];
  return (vs_value){s->turning_on && rate > 0, rate, c->t1_s};
}

static void follow_blocking(vs_switch *s, const vs_course_step *c, double rate,
                            vs_switch_news *news) {
  news->rise = follow_rise(&s->rise, c, is_gated(s));
  if (rate > s->off_rate) {
    s->off_rate = rate;
    news->off_rate = (vs_value){true, rate, c->t1_s};
  }
}

/* The largest rate of forward voltage, which counts as 0 while the voltage is reversed. */
static double forward_rate(vs_slope *slope, const vs_course_step *c) {
  double v0 = c->from[VS_OF_V], v1 = c->to[VS_OF_V], largest = -INFINITY, zero_s = c->t0_s;
  if ((v0 < 0) != (v1 < 0)) {
    zero_s = c->t0_s + v0 / (v0 - v1) * c->h_s;
    largest = vs_slope_follow(slope, c->t0_s, fmax(v0, 0), zero_s, 0, 1);
    v0 = 0;
  }
  return fmax(largest, vs_slope_follow(slope, zero_s, fmax(v0, 0), c->t1_s, fmax(v1, 0), 1));
}

/* The first rise behind a conduction is (dv/dt)c, too. */
static void tell_return(vs_switch *s, vs_switch_news *news) {
  if (!s->commutates || !news->rise.known) return;
  news->return_rise = news->rise;
  s->commutates = false;
}

static void follow(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  bool was_on = s->conduction.conducts, commutates = s->commutates;
  double off_rate = forward_rate(&s->off, c);
  double on_rate = vs_slope_follow(&s->on, c->t0_s, c->from[VS_OF_I], c->t1_s, c->to[VS_OF_I], 1);
  vs_switching_gate_follow(&s->gate, c);
  follow_current(s, c, news);
  follow_pulse(s, c, news);
  if (!was_on && !s->conduction.conducts) {
    follow_blocking(s, c, off_rate, news);
  } else {
    if (was_on) {
      follow_rise(&s->rise, c, is_gated(s));
    } else {
      if (s->rise.count && !s->rise.gated) news->rise = end_rise(&s->rise);
      s->rise.count = 0;
    }
    if (s->turning_on) news->on_rate = follow_turn_on(s, c, on_rate);
  }
  s->commutates = s->commutates || (commutates && news->rise.known);
  tell_return(s, news);
}

void vs_switching_follow(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  *news = (vs_switch_news){0};
  if (!s->both_ways)
    follow(s, c, news);
  else {
    if (!s->conduction.conducts && s->way * c->to[VS_OF_V] < 0) turn_over(s, c, news);
    vs_course_step half = in_half_cycle(s, c);
    follow(s, &half, news);
  }
  news->way = s->way;
  news->any = news->rise.known || news->off_rate.known || news->on_rate.known ||
              news->offered.known || news->misfire.known || news->unintended.known ||
              news->fires.known || news->extinct.known || news->fall.known ||
              news->return_rise.known;
}
