/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "measure/extremes.h"

#include <float.h>
#include <math.h>

#include "engine/step.h"

/* ---- the extremes of one step ---- */

/* A deck's probe goes on a straight line over a piece of a step. */
static void follow_piece(vs_extreme *e, const vs_probe *probe, const vs_piece *p) {
  double from = probe->sign * p->from->terms[probe->term];
  double to = probe->sign * p->to->terms[probe->term], sense = e->sense;
  if (e->is_last) e->stands = fmin(e->climbed, fmax(sense * (e->best.value - to), 0));
  e->is_last = false;
  if (!e->best.known || sense * from > sense * e->best.value) {
    e->best = (vs_value){true, from, p->from->t_s};
    e->stands = 0;
  }
  if (!(sense * to > sense * e->best.value)) return;
  e->best = (vs_value){true, to, p->to->t_s};
  e->is_last = true;
  e->climbed = sense * (to - from);
  e->stands = 0;
}

static void follow_probe(vs_extreme *e, const vs_step *step) {
  const vs_probe *probe =
      &step->frame->deck->probes[e->channel - vs_channel_deck(step->frame->model)];
  for (int k = 0; k <= step->parts; k++) {
    const vs_piece p = vs_step_piece(step, k);
    follow_piece(e, probe, &p);
  }
}

/* Value and slope at a knot, of a channel that is no probe. */
typedef struct at_knot {
  double y, rate;
} at_knot;

static at_knot of_law(const vs_frame *frame, const vs_knot *k, int channel) {
  const vs_law_rates r = vs_step_coil_rates(frame, k);
  return channel == VS_CH_I ? (at_knot){r.i_a, r.i_rate_a_s}
                            : (at_knot){r.force_n, r.force_rate_n_s};
}

static inline at_knot knot_of(const vs_frame *frame, const vs_knot *k, int channel) {
  const vs_model *m = frame->model;
  int i = channel - VS_CH_Q, rate2 = channel - vs_channel_rates2(m);
  if (rate2 >= 0) return (at_knot){k->a[rate2], k->j[rate2]};
  if (i >= 0) return (at_knot){k->x[i], k->x[m->dof + i]};
  if (channel != VS_CH_TRAVEL) return of_law(frame, k, channel);
  return (at_knot){vs_mechanics_travel(m, k->x), vs_mechanics_travel(m, k->x + m->dof)};
}

/* What the search goes for: the largest of sign times the channel. */
typedef struct search {
  vs_extreme *extreme;
  const vs_step *step;
  double sign;
  double rounding; /* differences below it say nothing */
} search;

/* What of it is an extreme so far, in the sense of the search. */
static double reach_of_search(const search *s) {
  const vs_extreme *e = s->extreme;
  return e->sense ? e->sense * e->best.value : e->best.value;
}

static void keep_if_extreme(const search *s, double y, double at_s) {
  vs_extreme *e = s->extreme;
  if (e->best.known && !(s->sign * y > reach_of_search(s))) return;
  e->best = (vs_value){true, e->sense ? y : s->sign * y + 0.0, at_s}; /* no -0 */
}

/* An extreme inside the step; where it is no larger than a knot's by rounding it says when. */
static void take_inside(const search *s, double part) {
  const vs_step *step = s->step;
  double from = step->from->t_s, to = step->to->t_s;
  double at_s = fmin(fmax(from + part * (to - from), from), to);
  double y = vs_step_channel(step, at_s, s->extreme->channel);
  double *best_at_s = &s->extreme->best.at_s;
  bool same = s->sign * y >= reach_of_search(s) - s->rounding;
  keep_if_extreme(s, y, at_s);
  if (same && (*best_at_s == from || *best_at_s == to)) *best_at_s = at_s;
}

bool vs_extreme_turn_of_travel(const vs_step *step, vs_value *turn) {
  const vs_model *m = step->frame->model;
  double before = vs_mechanics_travel(m, step->from->x + m->dof),
         behind = vs_mechanics_travel(m, step->to->x + m->dof), y[VS_CH_MOST];
  if (!(before * behind < 0)) return false;
  vs_curve g = vs_step_curve_of(step, VS_CH_TRAVEL),
           slope = vs_step_curve_slope(&g, before > 0 ? 1 : -1);
  double h = step->to->t_s - step->from->t_s;
  turn->at_s = step->from->t_s + h * vs_step_curve_root(slope);
  vs_step_groups_at(step, turn->at_s, 0, y);
  turn->value = y[VS_CH_TRAVEL];
  turn->known = true;
  return true;
}

/* Looks into the part of the step from `lo` that is `width` long, both in parts of the step. Cut in
 * halves, a curve comes as near to its coefficients as the square of the width: twenty-five times
 * is as near as rounding. What is level to rounding has no extreme but its ends. */
static void look_into(const search *s, vs_curve c, double lo, double width) {
  double most = -INFINITY, least = INFINITY;
  int changes = 0, before = 0, first = 0;
  for (int k = 0; k <= c.degree; k++) {
    most = fmax(most, s->sign * c.b[k]);
    least = fmin(least, s->sign * c.b[k]);
  }
  if (most < reach_of_search(s) - s->rounding || most - least <= s->rounding) return;
  vs_curve slope = vs_step_curve_slope(&c, s->sign);
  for (int k = 0; k <= slope.degree; k++) {
    int now = (slope.b[k] > 0) - (slope.b[k] < 0);
    if (!now) continue;
    changes += before && now != before;
    if (!first) first = now;
    before = now;
  }
  if (!changes || (changes == 1 && first < 0)) return; /* largest at an end */
  if (changes == 1)
    take_inside(s, lo + width * vs_step_curve_root(slope));
  else if (width > 0x1p-25) {
    vs_curve half = vs_step_curve_halve(&c);
    look_into(s, half, lo, width / 2);
    look_into(s, c, lo + width / 2, width / 2);
  }
}

/* What the cubic through the values and slopes at both ends says of the step: whether it stays
 * below the extreme so far, and whether it rises or falls all along, so that an end is the most. A
 * sine that moves by one radian, the longest there is, leaves that cubic by 1/384 of its size, and
 * its slope by three times that; a twentieth of what is at the ends is allowed for, and a tenth of
 * the way. Of a law's current, which rises faster than the flux where the iron saturates, five and
 * three times as much. */
typedef enum outlook { BELOW, AT_AN_END, UNKNOWN } outlook;

static inline outlook outlook_of(const vs_extreme *e, at_knot from, at_knot to, double h,
                                 bool exact) {
  double d = h / 3 * from.rate, f = h / 3 * to.rate, m = to.y - from.y - d - f, sign = e->sense;
  double y[] = {from.y, from.y + d, to.y - f, to.y};
  double size = fabs(from.y) + fabs(to.y) + fabs(d) + fabs(f);
  for (int k = 0; k < 4; k++) y[k] = e->sense ? sign * y[k] : fabs(y[k]);
  double a = y[0] > y[1] ? y[0] : y[1], b = y[2] > y[3] ? y[2] : y[3]; /* fmax would be called */
  double most = (a > b ? a : b) + (exact ? 0.05 : 0.25) * size;
  if (e->best.known && most < (e->sense ? sign * e->best.value : e->best.value)) return BELOW;
  double least = (exact ? 0.1 : 0.3) * (fabs(d) + fabs(m) + fabs(f));
  bool rises = d > least && m > least && f > least, falls = d < -least && m < -least && f < -least;
  return rises || falls ? AT_AN_END : UNKNOWN;
}

static void take_ends_of_search(const search *s, at_knot from, at_knot to) {
  keep_if_extreme(s, from.y, s->step->from->t_s);
  keep_if_extreme(s, to.y, s->step->to->t_s);
}

/* True if nothing in the step has a corner or is stiffer than the step is long: no armature in a
 * stop that is not linear, and none that is held. */
static bool is_smooth(const vs_step *step, bool jammed) {
  const vs_model *m = step->frame->model;
  if (jammed) return false;
  if (m->plain || !m->stops.count) return true;
  return !vs_stops_touched(&m->stops, vs_mechanics_travel(m, step->from->x)) &&
         !vs_stops_touched(&m->stops, vs_mechanics_travel(m, step->to->x));
}

/* What a polynomial through values may miss, of the channel's largest on the step: a hundredth of
 * the 1e-10 that an extreme is to be right to. Rounding may be more, as the rates are differences
 * of coordinates that hardly change in a short step. What is missed then falls no more when a part
 * is cut in halves; at a corner it falls to half, but is not so small. */
static const double MISSED = 1e-12, MOST_ROUNDING = 1e-9;

/* Looks into a part of the step by the polynomial through the channel's own values there. Where
 * that misses the channel between two of its points, as at a corner, the part is cut in halves. A
 * part that is a thousand millionth of the step is left with the values themselves: a corner is met
 * that well. missed_before: what was missed in the part twice as wide. */
enum {
  MOST_PARTS = 400
}; /* of a step; several times what a few corners take, while rounding alone,
      as of a moving coil without a current, would take all there are */
static void look_sampled(const search *s, double lo, double width, double missed_before,
                         int *parts) {
  if (++*parts > MOST_PARTS) return;
  const double from = s->step->from->t_s, h = s->step->to->t_s - from;
  double y[VS_CURVE_POINTS], most = -INFINITY, missed = 0;
  for (int k = 0; k < VS_CURVE_POINTS; k++) {
    double at_s = from + h * (lo + width * vs_step_curve_point(k));
    y[k] = vs_step_channel(s->step, at_s, s->extreme->channel);
    most = fmax(most, s->sign * y[k]);
    keep_if_extreme(s, y[k], at_s);
  }
  const vs_curve c = vs_step_curve_through(y);
  for (int k = 1; k <= 3; k++) { /* in the middle of the step and at the sides, off the points */
    double at = (vs_step_curve_point(3 * k) + vs_step_curve_point(3 * k + 1)) / 2;
    double truly = vs_step_channel(s->step, from + h * (lo + width * at), s->extreme->channel);
    missed = fmax(missed, fabs(vs_step_curve_value(&c, at) - truly));
  }
  bool rounding = missed > missed_before / 2 && missed * MISSED < s->rounding * MOST_ROUNDING;
  if (missed <= s->rounding || rounding) {
    search in = *s;
    in.rounding = fmax(missed, s->rounding);
    look_into(&in, c, lo, width);
    return;
  }
  if (most + 100 * missed < reach_of_search(s) || width < 0x1p-30) return;
  look_sampled(s, lo, width / 2, missed, parts);
  look_sampled(s, lo + width / 2, width / 2, missed, parts);
}

static void look_at_samples(const search *s) {
  const vs_step *step = s->step;
  search in = *s;
  int parts = 0;
  double size = 0;
  for (int k = 0; k < VS_CURVE_POINTS; k++) {
    double part = vs_step_curve_point(k),
           at_s = step->from->t_s + part * (step->to->t_s - step->from->t_s);
    size = fmax(size, fabs(vs_step_channel(step, at_s, s->extreme->channel)));
  }
  in.rounding = MISSED * size;
  if (size > 0) look_sampled(&in, 0, 1, INFINITY, &parts);
}

static void look_between_knots(const search *s) {
  const vs_step *step = s->step;
  search in = *s;
  if (!vs_step_curve_is_exact(step->frame->model, s->extreme->channel)) {
    look_at_samples(s);
    return;
  }
  vs_curve c = vs_step_curve_of(step, s->extreme->channel);
  double size = 0;
  for (int k = 0; k <= c.degree; k++) size = fmax(size, fabs(c.b[k]));
  in.rounding = 4 * DBL_EPSILON * size;
  keep_if_extreme(&in, c.b[0], step->from->t_s);
  keep_if_extreme(&in, c.b[c.degree], step->to->t_s);
  if (size > 0) look_into(&in, c, 0, 1);
}

/* True if the current or the force of a square coil stays below the extreme so far: a cubic of the
 * flux linkage leaves its ends by a third of what their slopes are over the step at most, and the
 * gap by no more than it moves at the rates and with the accelerations of both ends together. */
static bool stays_below(const vs_extreme *e, const vs_step *step) {
  const vs_model *m = step->frame->model;
  const vs_knot *a = step->from, *b = step->to;
  if (!e->best.known || !m->coil.square || !step->cubic_flux || step->frame->gap_at_rest ||
      (m->coil.eddies && e->channel == VS_CH_I))
    return false;
  double h = b->t_s - a->t_s, flux = fabs(a->flux_wb), other = fabs(b->flux_wb);
  flux = (flux > other ? flux : other) + h * (fabs(a->flux_rate_v) + fabs(b->flux_rate_v)) / 3;
  if (e->channel == VS_CH_FORCE) return 1.001 * flux * flux < 4 * m->coil.a_hm * e->best.value;
  double z = fabs(vs_mechanics_gap(m, a->x)), z1 = fabs(vs_mechanics_gap(m, b->x));
  double moves = h * (fabs(vs_mechanics_travel(m, a->x + m->dof)) +
                      fabs(vs_mechanics_travel(m, b->x + m->dof))) +
                 h * h * (fabs(vs_mechanics_travel(m, a->a)) + fabs(vs_mechanics_travel(m, b->a)));
  return 1.001 * flux * ((z > z1 ? z : z1) + moves) < 2 * m->coil.a_hm * fabs(e->best.value);
}

void vs_extreme_follow(vs_extreme *e, const vs_step *step, bool jammed) {
  bool of_flux = e->channel == VS_CH_I || e->channel == VS_CH_FORCE;
  const vs_model *m = step->frame->model;
  if (e->idle) return;
  if (e->channel >= vs_channel_deck(m)) {
    follow_probe(e, step);
    return;
  }
  if (of_flux && e->best.known && vs_step_is_quiet(step)) return; /* both are 0, and |i| is meant */
  if (of_flux && stays_below(e, step)) return;
  const at_knot from = knot_of(step->frame, step->from, e->channel),
                to = knot_of(step->frame, step->to, e->channel);
  bool of_rates2 = e->channel >= vs_channel_rates2(m);
  bool exact = vs_step_curve_is_exact(m, e->channel);
  outlook seen = UNKNOWN;
  if (!of_rates2 || is_smooth(step, jammed))
    seen = outlook_of(e, from, to, step->to->t_s - step->from->t_s, exact);
  if (seen == BELOW) return;
  for (int sign = 1; sign >= -1; sign -= 2) {
    const search s = {.extreme = e, .step = step, .sign = sign};
    if (e->sense && e->sense != sign) continue;
    take_ends_of_search(&s, from, to);
    if (seen == UNKNOWN) look_between_knots(&s);
  }
}

void vs_extreme_follow_any(vs_extreme *e, const vs_step *step) {
  if (e->channel >= vs_channel_deck(step->frame->model)) {
    follow_probe(e, step);
    return;
  }
  const search s = {.extreme = e, .step = step, .sign = e->sense};
  keep_if_extreme(&s, vs_step_channel(step, step->from->t_s, e->channel), step->from->t_s);
  keep_if_extreme(&s, vs_step_channel(step, step->to->t_s, e->channel), step->to->t_s);
  look_at_samples(&s);
}

/* Which of a coordinate's three extremes may lie in the step, as bits. The acceleration stays
 * within its largest value at the ends and 3/8 of the way that the jerk at the ends would take it:
 * for a sine that moves by one radian, the longest there is, 1.06 of its peak. The coordinate
 * leaves the chord between its ends by at most 1/8 of the acceleration times the length squared. */
static inline unsigned may_be_new(const vs_extreme of[VS_OF_COORDINATE], const vs_step *step, int i,
                                  double h) {
  const vs_knot *from = step->from, *to = step->to;
  double a0 = fabs(from->a[i]), a1 = fabs(to->a[i]), j0 = fabs(from->j[i]), j1 = fabs(to->j[i]);
  double x0 = from->x[i], x1 = to->x[i];
  double a = (a0 > a1 ? a0 : a1) + 0.375 * h * (j0 > j1 ? j0 : j1), bulge = 0.15 * h * h * a;
  return ((x0 < x1 ? x0 : x1) - bulge < of[VS_LEAST].best.value ? 1u << VS_LEAST : 0) |
         ((x0 > x1 ? x0 : x1) + bulge > of[VS_LARGEST].best.value ? 1u << VS_LARGEST : 0) |
         (a > of[VS_PEAK].best.value ? 1u << VS_PEAK : 0);
}

void vs_extreme_follow_motion(vs_extreme *all, const vs_step *step, bool jammed) {
  const vs_model *m = step->frame->model;
  double h = step->to->t_s - step->from->t_s;
  const bool smooth = is_smooth(step, jammed);
  for (int i = 0; i < m->dof; i++) {
    vs_extreme *of = all + VS_OF_COORDINATE * i;
    if (of->idle) continue;
    unsigned look = of->best.known && smooth ? may_be_new(of, step, i, h) : ~0u;
    for (int k = 0; look && k < VS_OF_COORDINATE; k++)
      if (look >> k & 1) vs_extreme_follow(&of[k], step, jammed);
  }
}

static void follow_piece_of_probes(vs_extreme *pairs, const vs_deck *deck, vs_piece p) {
  for (size_t n = 0; n < deck->n_probes; n++, pairs += 2) {
    const vs_probe *probe = &deck->probes[n];
    double from = probe->sign * p.from->terms[probe->term];
    double to = probe->sign * p.to->terms[probe->term];
    double least = pairs[0].best.value, largest = pairs[1].best.value;
    bool settled = pairs[0].best.known && !pairs[0].is_last && !pairs[1].is_last;
    if (settled && from >= least && to >= least && from <= largest && to <= largest) continue;
    follow_piece(&pairs[0], probe, &p);
    follow_piece(&pairs[1], probe, &p);
  }
}

void vs_extreme_follow_probes(vs_extreme *pairs, const vs_step *step) {
  for (int k = 0; k <= step->parts; k++)
    follow_piece_of_probes(pairs, step->frame->deck, vs_step_piece(step, k));
}
