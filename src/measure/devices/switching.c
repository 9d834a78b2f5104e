/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/switching.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <string.h>

#include "engine/events.h"
#include "engine/firing.h"
#include "engine/gate.h"
#include "netlist/parts.h"

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
  double before_s = at_s - 3 * vs_scene_event_rounding(at_s);
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
static bool is_rise_gated(const vs_switch *s) {
  return s->gate.on && s->gate.gates.count;
}

/* True while its gate is driven: within a pulse, and there within a sub-pulse. */
static bool is_driven(const vs_switch *s, const vs_course_step *c) {
  if (!is_rise_gated(s) || !s->gate.bursts) return is_rise_gated(s);
  double at_s = vs_gate_of_step(c->t0_s, c->t1_s);
  for (size_t k = 0; k < s->gate.gates.count; k++)
    if (vs_gate_burst(s->gate.timeline, s->gate.gates.rad[k], at_s)) return true;
  return false;
}

/* ---- rises of forward voltage ---- */

static void begin_rise(vs_rise *r, double t_s, double v) {
  r->begun = r->gated = true;
  r->foot = (vs_instant){t_s, 0};
  r->foot_v = r->top_v = v;
  r->s_per_v = INFINITY;
  r->best = (vs_rise_stretch){.took_s = INFINITY};
  r->told_s = INFINITY;
}

/* Notes that it rose by over_v from one instant to another. */
static void take_stretch_of_rise(vs_rise *r, vs_instant from, vs_instant to) {
  if (to.t_s - from.t_s < r->best.took_s)
    r->best = (vs_rise_stretch){from.t_s, to.t_s - from.t_s, r->over_v, from.bent_s + to.bent_s};
}

/* Above this the numbers of levels are no longer exact. No voltage of a circuit is as high. */
static const double MOST_LEVELS = 1e15;
/* A step that goes through more levels than this is followed straight, for the time that each
 * takes.
 */
static const double MOST_BENT = 64 * VS_RISE_LEVELS;
/* A voltage that is on a level but for rounding is on it. In levels. */
static const double SAME_LEVEL = 1e-9;

/* The slope at the knot between two steps, V/s: that of the parabola through their three knots. NaN
 * where the two say different things, as at a jump: both must rise, neither more than three times
 * as fast as the other, which keeps the cubic between two knots from turning back (de Boor and
 * Swartz), and neither may be more than eight times as long, as the noise of a very short step is
 * no slope. */
static const double MOST_STEEPER = 3, MOST_LONGER = 8;
static double slope_between(double rate, double h_s, double next_rate, double next_h_s) {
  bool alike = rate > 0 && next_rate > 0 && rate <= MOST_STEEPER * next_rate &&
               next_rate <= MOST_STEEPER * rate && h_s > 0 && h_s <= MOST_LONGER * next_h_s &&
               next_h_s <= MOST_LONGER * h_s;
  return alike ? (rate * next_h_s + next_rate * h_s) / (h_s + next_h_s) : NAN;
}

/* Slopes that differ by less, in parts of themselves, are the same but for rounding. */
static const double SAME_SLOPE = 1e-9;
/* A slope that is off by 1 at one end of a cubic moves it by no more than this within the step. */
static const double BOW = 4.0 / 27;
static vs_climbed climbed_of(const vs_rising *c, double slope_v_s) {
  vs_climbed of = {.zero_s = c->t0_s,
                   .low_v = fmax(c->v0, 0),
                   .t0_s = c->t0_s,
                   .h_s = c->t1_s - c->t0_s,
                   .v0 = c->v0,
                   .v1 = c->v1};
  if (c->v0 < 0) of.zero_s -= c->v0 / (c->v1 - c->v0) * of.h_s;
  of.s_per_v = (c->t1_s - of.zero_s) / (c->v1 - of.low_v);
  const double rise_v = c->v1 - c->v0;
  of.k0 = isnan(c->slope_v_s) ? rise_v : c->slope_v_s * of.h_s;
  of.k1 = isnan(slope_v_s) ? rise_v : slope_v_s * of.h_s;
  const double off_v = fabs(of.k0 - rise_v) + fabs(of.k1 - rise_v);
  of.bow_s = off_v > SAME_SLOPE * rise_v ? BOW * off_v * of.s_per_v : 0;
  return of;
}

/* Part of the step, 0 to 1, at which the cubic is at v, by Newton's method within a bracket. It
 * ends where what is left is rounding, of v where the step rises little: a correction of less would
 * leave the bracket. */
static double part_of_cubic_at(const vs_climbed *c, double v, double part) {
  const double rise = c->v1 - c->v0, b = 3 * rise - 2 * c->k0 - c->k1, a = c->k0 + c->k1 - 2 * rise;
  const double rounding_v = 4 * DBL_EPSILON * c->v1;
  double low = 0, high = 1;
  for (int n = 0; n < 60; n++) {
    const double off = ((a * part + b) * part + c->k0) * part + c->v0 - v,
                 slope = (3 * a * part + 2 * b) * part + c->k0;
    if (fabs(off) <= fmax(rounding_v, 1e-14 * slope)) break;
    *(off < 0 ? &low : &high) = part;
    const double next = slope > 0 ? part - off / slope : -1;
    part = next > low && next < high ? next : (low + high) / 2;
  }
  return part;
}

/* When the straight line is at v. */
static double straight_at(const vs_climbed *c, double v) {
  return c->zero_s + (v - c->low_v) * c->s_per_v;
}

/* When the course is at v. */
static vs_instant instant_at(const vs_climbed *c, double v) {
  const double straight_s = straight_at(c, v);
  if (!(c->bow_s > 0)) return (vs_instant){straight_s, 0};
  const double part = (straight_s - c->t0_s) / c->h_s,
               t_s = c->t0_s + part_of_cubic_at(c, v, fmin(fmax(part, 0), 1)) * c->h_s;
  return (vs_instant){t_s, c->bow_s};
}

/* Takes a stretch that began at a kept point, where it ends in this step. */
static void pass_end(vs_rise *r, vs_instant from, double from_v, const vs_climbed *c) {
  double end_v = from_v + r->over_v;
  if (c->low_v <= end_v && end_v <= c->v1) take_stretch_of_rise(r, from, instant_at(c, end_v));
}

static double each_level_v(const vs_rise *r) {
  return r->over_v / VS_RISE_PARTS;
}

/* Rounding moves the instants of a course that is as flat as this somewhere, in parts of its
 * voltage by its step. */
static const double FLAT = 1e-5;

/* A stretch: where it begins and ends. */
typedef struct stretch {
  vs_instant from, to;
} stretch;

/* What stretches are looked for among. */
typedef struct stretches {
  vs_rise *r;
  const vs_climbed *from, *to; /* they begin in one step, and end in another, or in the same */
  double rounding_s;
} stretches;

static stretch stretch_at(const stretches *of, double level) {
  const double each_v = each_level_v(of->r);
  return (stretch){instant_at(of->from, level * each_v),
                   instant_at(of->to, (level + VS_RISE_PARTS) * each_v)};
}

static double took_s(const stretch *s) {
  return s->to.t_s - s->from.t_s;
}

/* The range of a course's slope between two instants, V/s. */
static void slopes_between(const vs_climbed *c, double from_s, double to_s, double range[2]) {
  const double rise = c->v1 - c->v0, a = 3 * (c->k0 + c->k1 - 2 * rise),
               b = 2 * (3 * rise - 2 * c->k0 - c->k1), straight = 1 / c->s_per_v;
  const double p = (from_s - c->t0_s) / c->h_s, q = (to_s - c->t0_s) / c->h_s;
  const double top = fmin(fmax(a != 0 ? -b / (2 * a) : p, p), q), at[3] = {p, top, q};
  range[0] = range[1] = straight;
  for (int k = 0; k < 3 && c->bow_s > 0; k++) {
    const double slope = ((a * at[k] + b) * at[k] + c->k0) / c->h_s;
    range[0] = k ? fmin(range[0], slope) : slope;
    range[1] = k ? fmax(range[1], slope) : slope;
  }
}

/* Takes the stretches between two levels in their order, but for those that the slopes show to be
 * longer than the shorter one at either end, or than least_s. */
static void take_between(const stretches *of, double low, const stretch *at_low, double high,
                         const stretch *at_high, double least_s) {
  double from[2], to[2];
  if (high - low < 2) return;
  slopes_between(of->from, at_low->from.t_s, at_high->from.t_s, from);
  slopes_between(of->to, at_low->to.t_s, at_high->to.t_s, to);
  const double each_v = each_level_v(of->r), before_s = took_s(at_low), behind_s = took_s(at_high);
  least_s = fmin(least_s, fmin(before_s, behind_s));
  if (from[0] * of->from->h_s > FLAT * of->from->v1 && to[0] * of->to->h_s > FLAT * of->to->v1) {
    const double least = each_v * (1 / to[1] - 1 / from[0]), /* by level, s */
        most = each_v * (1 / to[0] - 1 / from[1]);
    if (least > of->rounding_s || most < -of->rounding_s) return;
    if ((before_s + behind_s + (least - most) * (high - low)) / 2 > least_s + of->rounding_s)
      return;
  }
  const double level = floor((low + high) / 2);
  const stretch middle = stretch_at(of, level);
  take_between(of, low, at_low, level, &middle, fmin(least_s, took_s(&middle)));
  take_stretch_of_rise(of->r, middle.from, middle.to);
  take_between(of, level, &middle, high, at_high, least_s);
}

/* The time between two levels by the straight lines. */
static double straight_between(const stretches *of, double level) {
  const double each_v = each_level_v(of->r);
  return straight_at(of->to, (level + VS_RISE_PARTS) * each_v) -
         straight_at(of->from, level * each_v);
}

/* Takes the steepest of the stretches that begin in one step, at its levels from `first` to `last`,
 * and end in another, or in the same. No course is farther from its straight line than bow_s, so
 * that they are looked at only where the straight lines, whose difference is least at the first
 * level or at the last, leave them room to be the steepest so far. Where both are one straight
 * line, the levels between the first and the last of more than are kept tell nothing. */
static void take_stretches(vs_rise *r, const vs_climbed *from, double first, double last,
                           const vs_climbed *to) {
  const double rounding_s =
      SAME_SLOPE * (from->h_s + to->h_s) + 8 * DBL_EPSILON * (to->t0_s + to->h_s);
  const stretches of = {r, from, to, rounding_s};
  if (last < first) return;
  const double off_s = from->bow_s + to->bow_s + 8 * DBL_EPSILON * (to->t0_s + to->h_s);
  if (fmin(straight_between(&of, first), straight_between(&of, last)) - off_s > r->best.took_s)
    return;
  const stretch begin = stretch_at(&of, first), end = stretch_at(&of, last);
  take_stretch_of_rise(r, begin.from, begin.to);
  const double low =
      from == to && !(to->bow_s > 0) ? fmax(first, last + VS_RISE_PARTS - VS_RISE_LEVELS) : first;
  const stretch at_low = low > first ? stretch_at(&of, low) : begin;
  take_between(&of, low, &at_low, last, &end, r->best.took_s);
  take_stretch_of_rise(r, end.from, end.to);
}

/* Number of the first entry of `passed` that goes up to a level or higher; n_passed: none does. */
static int entry_at(const vs_rise *r, double level) {
  int low = 0, high = r->n_passed;
  while (low < high) {
    const int middle = (low + high) / 2;
    if (r->passed[middle].last < level)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
}

/* Moves the entries of `passed` from number `from` on to number `to`. */
static void move_entries(vs_rise *r, int to, int from) {
  memmove(r->passed + to, r->passed + from, (size_t)(r->n_passed - from) * sizeof *r->passed);
  r->n_passed += to - from;
}

/* Notes that the levels from `first` to `last` were passed in a step. Entries for the same levels
 * lose them. */
static void keep_levels(vs_rise *r, const vs_climbed *c, double first, double last) {
  const double lowest = last - VS_RISE_LEVELS + 1;
  while (r->n_passed && r->passed[r->n_passed - 1].first > last + VS_RISE_ABOVE) r->n_passed--;
  if (r->n_passed + 2 > VS_RISE_ENTRIES) move_entries(r, 0, entry_at(r, lowest));
  int from = entry_at(r, first), to = entry_at(r, last + 1);
  if (from < r->n_passed && r->passed[from].first < first) {
    if (from == to) move_entries(r, ++to, from); /* it goes on above: two of it, the first stays */
    r->passed[from++].last = first - 1;
  }
  if (to < r->n_passed && r->passed[to].first <= last) r->passed[to].first = last + 1;
  move_entries(r, from + 1, to);
  r->passed[from] = (vs_passed){fmax(first, lowest), last, *c};
}

/* Goes through the levels of a step. A stretch that ends at one of them begins as the voltage last
 * went through the level that lies over_v below. */
static void pass_levels(vs_rise *r, const vs_climbed *c) {
  const double each_v = each_level_v(r), first = ceil(c->low_v / each_v - SAME_LEVEL),
               last = floor(c->v1 / each_v + SAME_LEVEL),
               end = fmin(first - 1, last - VS_RISE_PARTS);
  if (last < first) return;
  for (int k = entry_at(r, first - VS_RISE_PARTS); k < r->n_passed; k++) {
    const vs_passed *below = &r->passed[k];
    if (below->first > end) break;
    take_stretches(r, &below->course, fmax(below->first, first - VS_RISE_PARTS),
                   fmin(below->last, end), c);
  }
  take_stretches(r, c, first, last - VS_RISE_PARTS, c);
  keep_levels(r, c, first, last);
}

/* Takes the step that waits, with the slope at its end, or NaN. */
static void climb(vs_rise *r, double slope_v_s) {
  if (!r->waits) return;
  vs_climbed c = climbed_of(&r->rising, slope_v_s);
  const double each_v = each_level_v(r);
  r->waits = false;
  if (!(c.v1 / each_v < MOST_LEVELS)) return;
  if (!((c.v1 - c.low_v) / each_v < MOST_BENT)) c.bow_s = 0;
  if (c.v0 < 0) r->foot = instant_at(&c, 0);
  pass_levels(r, &c);
  if (c.s_per_v < r->s_per_v / 2) {
    r->knee = c.v0 < 0 ? r->foot : (vs_instant){c.t0_s, 0};
    r->knee_v = c.low_v;
  }
  r->s_per_v = c.s_per_v;
  pass_end(r, r->foot, r->foot_v, &c);
  pass_end(r, r->knee, r->knee_v, &c);
}

/* Follows the present rise. gated: its gate pulse is there. A rise ends at its top, once the
 * voltage has come down by a tenth of it, and true is returned then. It is followed while the
 * device conducts too, so that the voltage of a device that goes out is known from its own foot on:
 * where in that rise the current counts as gone is known less well than the voltage. A step that
 * rises waits for the next one, which tells its slope at the end. */
static bool follow_rise(vs_rise *r, const vs_course_step *c, bool gated) {
  double v0 = fmax(c->from[VS_OF_V], 0), v1 = fmax(c->to[VS_OF_V], 0);
  const double rate = (c->to[VS_OF_V] - c->from[VS_OF_V]) / c->h_s;
  const double slope_v_s = slope_between(r->rate_v_s, r->h_s, rate, c->h_s);
  climb(r, slope_v_s);
  r->rate_v_s = rate;
  r->h_s = c->h_s;
  if (c->from[VS_OF_V] < 0 && v1 > 0) begin_rise(r, c->t0_s - c->from[VS_OF_V] / rate, 0);
  if (!r->begun) begin_rise(r, c->t0_s, v0);
  r->waits = v1 > v0;
  if (r->waits)
    r->rising = (vs_rising){c->t0_s, c->t1_s, c->from[VS_OF_V], c->to[VS_OF_V], slope_v_s};
  else
    r->s_per_v = INFINITY;
  if (v1 > r->top_v) {
    r->top_v = v1;
    r->gated = r->gated && gated;
  }
  return r->top_v - v1 >= 0.1 * (r->top_v - r->foot_v);
}

/* Returns true if the last time at which the voltage went through a level is known. */
static bool is_kept(const vs_rise *r, double level, vs_instant *at) {
  const vs_passed *of = r->passed + entry_at(r, level);
  if (of == r->passed + r->n_passed || of->first > level) return false;
  *at = instant_at(&of->course, level * each_level_v(r));
  return true;
}

/* The steepest stretch of four fifths of what the present rise did, where that is less than over_v.
 * took_s is INFINITY where it rose by less than 10 V. */
static vs_rise_stretch four_fifths(const vs_rise *r) {
  double height_v = r->top_v - r->foot_v, each_v = each_level_v(r);
  double high = fmin(floor(0.8 * height_v / each_v), VS_RISE_PARTS),
         last = floor(r->top_v / each_v);
  vs_rise_stretch best = {.took_s = INFINITY};
  if (height_v < FORWARD_V || high < 1) return best;
  for (double level = ceil(r->foot_v / each_v); level + high <= last; level++) {
    vs_instant from, to;
    if (!is_kept(r, level, &from) || !is_kept(r, level + high, &to)) continue;
    const double took_s = to.t_s - from.t_s;
    if (took_s > 0 && took_s < best.took_s)
      best = (vs_rise_stretch){from.t_s, took_s, high * each_v, from.bent_s + to.bent_s};
  }
  return best;
}

/* True where four fifths of the present rise are less than over_v. */
static bool is_rise_low(const vs_rise *r) {
  return 0.8 * (r->top_v - r->foot_v) < r->over_v;
}

static double rate_of(const vs_rise_stretch *a) {
  return a->over_v / a->took_s;
}

static void tell_ascent(const vs_rise_stretch *a, vs_rise_rate *told) {
  if (!isfinite(a->took_s)) return;
  const double error = rate_of(a) * a->bent_s / a->took_s;
  *told = (vs_rise_rate){{true, rate_of(a), a->from_s}, a->over_v, error};
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
 * not known it counts as 150 us, which is long for a thyristor of this size. And one that had
 * conducted for longer as its pulse ended, and whose current was at less than half of its peak by
 * then, had latched before: it goes out by its circuit. */
static const double DECAYS = 10, SLOW_T_Q_S = 150e-6;
static double stores_s(const vs_switch *s) {
  return isfinite(s->t_q_s) ? s->t_q_s : SLOW_T_Q_S;
}
static double least_rest_s(const vs_switch *s) {
  return isfinite(s->t_q_s) ? s->t_q_s : DECAYS * SLOW_T_Q_S;
}

static bool has_latched(const vs_switch *s) {
  bool by_pulse = s->by_gate && s->gate.gates.count;
  double from_s = by_pulse ? s->gate.off_since_s : s->fired_s;
  if (!(from_s >= s->fired_s)) return false; /* its pulse is still there */
  const double decays_s = DECAYS * stores_s(s);
  bool waned = s->pulse_end_a < s->conduction.peak_a / 2;
  if (by_pulse && waned && from_s - s->fired_s > decays_s) return true;
  return s->zero_s - from_s > decays_s;
}

/* Of a device that conducts both ways: notes its current, and since when it is below a tenth of its
 * peak. */
static void follow_fall(vs_switch *s, const vs_course_step *c) {
  vs_slope_keep_fall(&s->fall, c->t0_s, c->from[VS_OF_I]);
  double i0 = c->from[VS_OF_I], i1 = c->to[VS_OF_I], tenth_a = s->conduction.peak_a / 10;
  if (i1 > tenth_a)
    s->tenth_s = NAN;
  else if (isnan(s->tenth_s))
    s->tenth_s = i0 > tenth_a ? c->t0_s + (i0 - tenth_a) / (i0 - i1) * c->h_s : c->t0_s;
}

/* Of a sine the two differ by 0.2 %: up to 1 % more hangs on no length that is assumed. */
static void note_fall(vs_switch *s, double zero_s) {
  const double of_tenth = s->conduction.peak_a / 10 / (zero_s - s->tenth_s),
               last = vs_slope_fall(&s->fall, zero_s);
  s->fell = (vs_value){zero_s > s->tenth_s, fmax(of_tenth, last), zero_s};
  s->fell_last = last > 1.01 * of_tenth;
}

/* Tells the fall once voltage is back, or the device fires by itself. Where the charge has decayed
 * before, as behind a fuse that has opened, or the gate fires it, nothing is commutated. */
static void tell_fall(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  const bool on = s->conduction.conducts, back = fabs(c->to[VS_OF_V]) > FORWARD_V,
             late = c->t0_s > s->zero_s + DECAYS * stores_s(s);
  if (!s->fell.known || !(on || back || late)) return;
  if (on ? !s->by_gate : !late) news->fall = s->fell;
  s->fell.known = false;
}

static void follow_conduction(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  if (s->gate.ended) s->pulse_end_a = c->from[VS_OF_I];
  const vs_conduction_step step = {c->t0_s,        c->t1_s,          c->from[VS_OF_I],
                                   c->to[VS_OF_I], c->from[VS_OF_V], c->to[VS_OF_V]};
  double event_s = NAN;
  s->conduction.gated = is_rise_gated(s);
  switch (vs_conduction_follow(&s->conduction, &step, &event_s)) {
  case VS_EV_FIRES:
    s->fired_s = event_s;
    follow_fired_v(s, c, s->fired_s);
    s->tenth_s = NAN;
    s->fall.count = 0;
    s->commutates = false;
    news->fires = (vs_value){true, 1, event_s};
    break;
  case VS_EV_EXTINCT:
    s->zero_s = event_s;
    s->rest = c->to[VS_OF_V] < 0 && !s->both_ways ? REST_REVERSED : REST_NO_REVERSE_YET;
    note_fall(s, event_s);
    s->commutates = s->both_ways;
    s->returned_v = 0;
    news->extinct = (vs_value){true, 1, event_s};
    s->latched = has_latched(s);
    s->rose_s = NAN;
    break;
  default:
    /* while it rests after a conduction the voltage at which that began is still asked for */
    if (s->conduction.conducts) break;
    s->leaked_v = c->to[VS_OF_I] < QUIET_A ? 0 : fmax(s->leaked_v, c->from[VS_OF_V]);
    if (s->rest == REST_NONE || s->rest == REST_FORWARD_AGAIN)
      follow_fired_v(s, c, s->conduction.foot_s);
  }
}

/* The device is back at forward voltage without having been reversed: it did not latch. As long as
 * its gate pulse lasts it may be fired again, by the next of the sub-pulses, and the end of the
 * pulse will tell. Otherwise this is a misfire. */
static void fall_back(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  s->rest = REST_NONE;
  if (s->gate.on)
    s->conducted = false;
  else if (s->by_gate && s->gate.gates.count) {
    news->misfire = (vs_value){true, 1, c->t1_s};
    news->unlatched = true;
  }
}

/* Forward voltage has returned. */
static void turn_off_switch(vs_switch *s, double returned_s) {
  s->rest = REST_FORWARD_AGAIN;
  s->offers = true;
  s->offered_s = fmax(returned_s - s->zero_s, 0);
  s->offer = (vs_switch_news){.doubt_s = s->conduction.tail_s,
                              .spread_s = s->conduction.peak_a / s->conduction.tail_a_s};
  if (!is_rise_gated(s)) /* else it is meant to conduct */
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
      turn_off_switch(s, isnan(s->rose_s) ? c->t1_s : s->rose_s);
      tell_offered(s, news);
    } else
      fall_back(s, c, news);
    break;
  case REST_REVERSED:
    if (v1 > 0) turn_off_switch(s, v0 < 0 ? c->t0_s - v0 / (v1 - v0) * c->h_s : c->t0_s);
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
static void turn_half_cycle(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  double v0 = c->from[VS_OF_V], v1 = c->to[VS_OF_V];
  double zero_s = v0 * v1 < 0 ? c->t0_s + v0 / (v0 - v1) * c->h_s : c->t0_s;
  s->way = -s->way;
  s->rise.rate_v_s = -s->rise.rate_v_s;
  for (size_t k = 0; k < VS_SLOPE_KNOTS; k++) s->on.y[k] = -s->on.y[k];
  memset(s->off.y, 0, sizeof s->off.y); /* what was forward voltage is reverse voltage now */
  vs_conduction_turn(&s->conduction, zero_s);
  if (s->rest == REST_NO_REVERSE_YET) {
    turn_off_switch(s, zero_s);
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

/* Called when a current has begun, at fired_s, which may lie before this step: a gate pulse that
 * has ended since then, but only after fired_s, still fired it. Without a pulse it is an unintended
 * firing, and a commutation failure besides where the device had less than its turn-off time to
 * rest. */
static void judge_firing(vs_switch *s, vs_switch_news *news) {
  s->by_gate = s->gate.on || s->fired_s < s->gate.off_since_s;
  if (s->rest == REST_FORWARD_AGAIN) tell_offered(s, news);
  if (!s->by_gate) {
    news->unintended = (vs_value){true, 1, s->fired_s};
    news->commutation_failure = s->rest == REST_FORWARD_AGAIN && s->offered_s < least_rest_s(s);
  }
  s->rest = REST_NONE;
}

/* The half cycle of the mains at t_s, from 0. */
static double half_cycle(const vs_switch *s, double t_s) {
  return floor(2 * t_s / s->gate.timeline->period_s);
}

/* A gate pulse of a triac that begins and ends while the current of the half cycle before flows is
 * lost if the device then blocks. With each second pulse lost, it conducts in one direction. */
static void follow_lost_pulse(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  const bool conducts = s->conduction.conducts;
  if (s->gate.begins)
    s->lost_s = s->both_ways && conducts && half_cycle(s, s->fired_s) < half_cycle(s, c->t0_s)
                    ? c->t0_s
                    : NAN;
  if (s->fired_s > s->lost_s) s->lost_s = NAN;
  if (isnan(s->lost_s) || s->gate.on || conducts || !(c->to[VS_OF_V] > FORWARD_V)) return;
  news->misfire = (vs_value){true, 1, s->lost_s};
  news->lost = true;
  s->lost_s = NAN;
}

/* Follows whether the device answers its gate pulses. A pulse that found forward voltage and has
 * ended is unanswered; as long as a small current flows, though, it may still have been answered.
 */
static void follow_gate_pulse(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  follow_lost_pulse(s, c, news);
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
  memset(s, 0, offsetof(vs_switch, rise.passed)); /* those count up to rise.n_passed */
  s->both_ways = device->kind->both_ways;
  s->way = 1;
  s->t_q_s = INFINITY;
  s->fired_s = s->rose_s = s->tenth_s = s->unanswered_s = s->lost_s = NAN;
  s->stored = (vs_rise_stretch){.took_s = INFINITY};
  s->stored_at_s = -INFINITY;
  vs_switching_gate_begin(&s->gate, timeline, gates);
  s->gate.bursts = deck->n_ports && vs_deck_has_port(deck, vs_port_is_burst);
  s->on.window_s =
      vs_parts_turn_on_s(deck, device->part < 0 ? NULL : deck->parts[device->part].file);
  vs_conduction_begin(&s->conduction);
  s->conduction.recovers = vs_conduction_turn_off(deck, device) > 0;
  s->conduction.both_ways = s->both_ways;
}

void vs_switching_resume(vs_switch *s, double i_a, double v_v) {
  if (s->both_ways) s->way = i_a < 0 ? -1 : 1;
  vs_conduction_resume(&s->conduction, s->way * i_a, s->way * v_v);
  if (!s->conduction.conducts) return;
  s->by_gate = true;
  s->fired_s = -INFINITY;
}

static void follow_switch_current(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
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

/* The largest rate of forward voltage, which counts as 0 while the voltage is reversed. */
static double forward_rate(vs_slope *slope, const vs_course_step *c) {
  double v0 = c->from[VS_OF_V], v1 = c->to[VS_OF_V], largest = -INFINITY, zero_s = c->t0_s;
  if ((v0 < 0) != (v1 < 0)) {
    zero_s = c->t0_s + v0 / (v0 - v1) * c->h_s;
    largest = vs_slope_rate(slope, c->t0_s, fmax(v0, 0), zero_s, 0, 1);
    v0 = 0;
  }
  return fmax(largest, vs_slope_rate(slope, zero_s, fmax(v0, 0), c->t1_s, fmax(v1, 0), 1));
}

/* Tells of the present rise what is steeper than what was told of it. */
static void tell_rise(vs_rise *r, vs_switch_news *news) {
  if (!(r->best.took_s < r->told_s)) return;
  r->told_s = r->best.took_s;
  tell_ascent(&r->best, &news->rise);
}

/* A rise behind a conduction has ended, or the conduction's charge has decayed meanwhile: it is
 * (dv/dt)c, too. One that is lower than over_v counts where it is higher than those before it. */
static void tell_return(vs_switch *s, vs_switch_news *news) {
  const double height_v = s->rise.top_v - s->rise.foot_v;
  const bool low = is_rise_low(&s->rise);
  if (low && !(height_v > s->returned_v)) return;
  vs_rise_stretch ascent = low ? four_fifths(&s->rise) : s->rise.best;
  tell_ascent(&ascent, &news->return_rise);
  if (news->return_rise.rate.known) s->returned_v = fmax(s->returned_v, height_v);
}

/* What the present rise may fire the device by: its steepest stretch. */
static vs_rise_stretch drive_of(const vs_rise *r) {
  return isfinite(r->best.took_s) ? r->best : four_fifths(r);
}

/* Keeps the steepest stretch of a rise that has ended while the device blocked: what it has stored
 * may fire the device some time later. One that is less steep is kept in its place once the charge
 * of the one before has decayed. */
static void keep_rise(vs_switch *s, double now_s) {
  vs_rise_stretch ascent = drive_of(&s->rise);
  bool decayed = now_s - s->stored_at_s > stores_s(s);
  if (!isfinite(ascent.took_s) || !(decayed || rate_of(&ascent) > rate_of(&s->stored))) return;
  s->stored = ascent;
  s->stored_at_s = now_s;
}

/* While the device blocks. What rises under its gate pulse is told only where the device has not
 * fired by the rise's end. */
static void tell_blocked(vs_switch *s, double now_s, bool ended, vs_switch_news *news) {
  if (ended || !s->rise.gated) tell_rise(&s->rise, news);
  if (ended) keep_rise(s, now_s);
  const bool decayed = s->commutates && now_s > s->zero_s + DECAYS * stores_s(s);
  if (s->commutates && (ended || decayed)) tell_return(s, news);
  if (decayed) s->commutates = false;
}

/* The device has fired. The rise that it fired by may have ended before. */
static void tell_fired(vs_switch *s, bool commutated, vs_switch_news *news) {
  climb(&s->rise, NAN);
  vs_rise_stretch by = drive_of(&s->rise);
  bool stored = s->fired_s - s->stored_at_s <= stores_s(s);
  if (stored && rate_of(&s->stored) > rate_of(&by)) by = s->stored;
  news->fired_v = fmax(s->fired_v, s->leaked_v);
  news->fired_rate = rate_of(&by);
  news->fired_over_v = by.over_v;
  s->stored_at_s = -INFINITY;
  if (s->rise.gated && !news->unintended.known) return;
  tell_rise(&s->rise, news);
  if (news->unintended.known && !news->rise.rate.known) tell_ascent(&by, &news->rise);
  if (commutated) tell_return(s, news);
}

static void follow_rises(vs_switch *s, const vs_course_step *c, bool was_on, bool commutated,
                         vs_switch_news *news) {
  bool on = s->conduction.conducts, ended = follow_rise(&s->rise, c, is_driven(s, c));
  if (!was_on && !on) tell_blocked(s, c->t1_s, ended, news);
  if (!was_on && on) tell_fired(s, commutated, news);
  if (!was_on && on)
    s->rise.begun = false;
  else if (ended)
    begin_rise(&s->rise, c->t1_s, fmax(c->to[VS_OF_V], 0));
}

static void follow_switch(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  bool was_on = s->conduction.conducts, commutated = s->commutates;
  double off_rate = forward_rate(&s->off, c);
  double on_rate = vs_slope_rate(&s->on, c->t0_s, c->from[VS_OF_I], c->t1_s, c->to[VS_OF_I], 1);
  vs_switching_gate_follow(&s->gate, c);
  follow_switch_current(s, c, news);
  tell_fall(s, c, news);
  follow_gate_pulse(s, c, news);
  if (s->rise.over_v > 0) follow_rises(s, c, was_on, commutated, news);
  if (!was_on && !s->conduction.conducts) {
    if (off_rate > s->off_rate) news->off_rate = (vs_value){true, off_rate, c->t1_s};
    s->off_rate = fmax(s->off_rate, off_rate);
  } else if (s->turning_on)
    news->on_rate = follow_turn_on(s, c, on_rate);
}

void vs_switching_finish(vs_switch *s, vs_switch_news *news) {
  *news = (vs_switch_news){.way = s->way};
  news->fall = s->fell; /* nobody knows what comes behind it */
  climb(&s->rise, NAN);
  if (!s->rise.begun || s->conduction.conducts) return;
  s->rise.told_s = INFINITY;
  if (!s->rise.gated) tell_rise(&s->rise, news);
  if (s->commutates) tell_return(s, news);
  news->any = news->rise.rate.known || news->return_rise.rate.known;
}

void vs_switching_follow(vs_switch *s, const vs_course_step *c, vs_switch_news *news) {
  *news = (vs_switch_news){0};
  if (!s->both_ways)
    follow_switch(s, c, news);
  else {
    if (!s->conduction.conducts && s->way * c->to[VS_OF_V] < 0) turn_half_cycle(s, c, news);
    vs_course_step half = in_half_cycle(s, c);
    follow_switch(s, &half, news);
  }
  news->way = s->way;
  news->any = news->rise.rate.known || news->off_rate.known || news->on_rate.known ||
              news->offered.known || news->misfire.known || news->unintended.known ||
              news->fires.known || news->extinct.known || news->fall.known ||
              news->return_rise.rate.known;
}

bool vs_switching_may_fail(const vs_switch *s, double now_s) {
  return s->rest == REST_FORWARD_AGAIN && !s->conduction.conducts && !s->gate.on &&
         s->offered_s < least_rest_s(s) && now_s - s->zero_s - s->offered_s < stores_s(s);
}
