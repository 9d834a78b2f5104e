/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "watch/extremes.h"

#include <assert.h>
#include <float.h>
#include <math.h>

#include "actuator/coil.h"

/* ---- polynomials over a step, by their Bernstein coefficients ---- */

enum { SEPTIC = 7, MOST = 2 * SEPTIC };
typedef struct curve {
  int degree;
  double b[MOST + 1];
} curve;

/* Of degree seven, by value and three derivatives at both ends; or of degree three, by one. */
static curve curve_between(const double from[4], const double to[4], double h, bool cubic) {
  curve c = {.degree = cubic ? 3 : SEPTIC};
  for (int end = 0; end < 2; end++) {
    const double *y = end ? to : from, s = end ? -h : h;
    double d = s * y[1] / c.degree, e = s * s * y[2] / 42, f = s * s * s * y[3] / 210;
    double *b = end ? c.b + c.degree : c.b;
    int on = end ? -1 : 1;
    b[0] = y[0];
    b[on] = y[0] + d;
    if (cubic) continue;
    b[2 * on] = y[0] + 2 * d + e;
    b[3 * on] = y[0] + 3 * d + 3 * e + f;
  }
  return c;
}

static curve coordinate(const vs_step *step, int i) {
  const vs_knot *a = step->from, *b = step->to;
  int dof = step->frame->model->dof;
  const double from[] = {a->x[i], a->x[dof + i], a->a[i], a->j[i]};
  const double to[] = {b->x[i], b->x[dof + i], b->a[i], b->j[i]};
  return curve_between(from, to, b->t_s - a->t_s, false);
}

static curve flux(const vs_step *step) {
  const vs_knot *a = step->from, *b = step->to;
  const double from[] = {a->flux_wb, a->flux_rate_v, a->flux_rate2_v_s, a->flux_rate3_v_s2};
  const double to[] = {b->flux_wb, b->flux_rate_v, b->flux_rate2_v_s, b->flux_rate3_v_s2};
  return curve_between(from, to, b->t_s - a->t_s, step->cubic_flux);
}

/* The same polynomial, said to be of one degree more. */
static void elevate(curve *c) {
  int n = ++c->degree;
  c->b[n] = c->b[n - 1];
  for (int k = n - 1; k > 0; k--) c->b[k] = (k * c->b[k - 1] + (n - k) * c->b[k]) / n;
}

static curve slope_of(const curve *c, double h) {
  curve s = {.degree = c->degree - 1};
  for (int k = 0; k < c->degree; k++) s.b[k] = c->degree * (c->b[k + 1] - c->b[k]) / h;
  return s;
}

static curve product(const curve *x, const curve *y) {
  static const double CHOOSE[SEPTIC + 1][SEPTIC + 1] = {{1},
                                                        {1, 1},
                                                        {1, 2, 1},
                                                        {1, 3, 3, 1},
                                                        {1, 4, 6, 4, 1},
                                                        {1, 5, 10, 10, 5, 1},
                                                        {1, 6, 15, 20, 15, 6, 1},
                                                        {1, 7, 21, 35, 35, 21, 7, 1}};
  int m = x->degree, n = y->degree;
  curve c = {.degree = m + n};
  for (int k = 0; k <= m + n; k++) {
    double sum = 0, all = 0;
    for (int i = k > n ? k - n : 0; i <= k && i <= m; i++) {
      double weight = CHOOSE[m][i] * CHOOSE[n][k - i];
      sum += weight * x->b[i] * y->b[k - i];
      all += weight;
    }
    c.b[k] = sum / all;
  }
  return c;
}

/* Its two halves; the first is returned. */
static curve halve(curve *c) {
  curve first = {.degree = c->degree};
  for (int k = 0; k <= c->degree; k++) {
    first.b[k] = c->b[0];
    for (int i = 0; i < c->degree - k; i++) c->b[i] = (c->b[i] + c->b[i + 1]) / 2;
  }
  return first;
}

static double value_of(const curve *c, double s) {
  curve at = *c;
  for (int n = c->degree; n > 0; n--)
    for (int i = 0; i < n; i++) at.b[i] += s * (at.b[i + 1] - at.b[i]);
  return at.b[0];
}

/* ---- channels as such polynomials ---- */

/* The travel g = c.q. */
static curve travel(const vs_step *step) {
  const vs_model *m = step->frame->model;
  const vs_knot *a = step->from, *b = step->to;
  const double from[] = {vs_mechanics_travel(m, a->x), vs_mechanics_travel(m, a->x + m->dof),
                         vs_mechanics_travel(m, a->a), vs_mechanics_travel(m, a->j)};
  const double to[] = {vs_mechanics_travel(m, b->x), vs_mechanics_travel(m, b->x + m->dof),
                       vs_mechanics_travel(m, b->a), vs_mechanics_travel(m, b->j)};
  return curve_between(from, to, b->t_s - a->t_s, false);
}

static curve current(const vs_step *step) {
  const vs_model *m = step->frame->model;
  curve c = flux(step), z = step->frame->gap_at_rest ? (curve){0} : travel(step);
  for (int k = 0; k <= z.degree; k++) z.b[k] = (z.b[k] + m->coil.gap_rest_m) / (2 * m->coil.a_hm);
  return product(&c, &z);
}

static curve force(const vs_step *step) {
  curve c = flux(step);
  c = product(&c, &c);
  for (int k = 0; k <= c.degree; k++) c.b[k] /= 4 * step->frame->model->coil.a_hm;
  return c;
}

/* Adds x times a polynomial of no higher degree. */
static void add(curve *sum, double x, const curve *more) {
  curve c = *more;
  while (c.degree < sum->degree) elevate(&c);
  for (int k = 0; k <= c.degree; k++) sum->b[k] += x * c.b[k];
}

/* Eq. 54. Where the armature touches its stop it does so all over a step, as steps end there. */
static curve acceleration(const vs_step *step, int i) {
  const vs_model *m = step->frame->model;
  const vs_stop *stop = &m->stops.item[0];
  curve sum = {.degree = SEPTIC}, g = travel(step);
  double share = vs_stops_touched(&m->stops, value_of(&g, 0.5)) ? m->mf[i] : 0;
  for (int n = 0; n < m->dof; n++) {
    curve q = coordinate(step, n), v = slope_of(&q, step->to->t_s - step->from->t_s);
    double pull = share * m->along[n];
    add(&sum, pull * stop->stiffness - m->mk_column[n][i], &q);
    add(&sum, pull * stop->damping_ns_m - m->mb_column[n][i], &v);
  }
  for (int k = 0; k <= SEPTIC; k++) {
    if (share != 0) sum.b[k] -= share * stop->stiffness * stop->at_m;
    if (m->loaded) sum.b[k] += m->m0[i];
  }
  if (vs_step_is_quiet(step)) return sum;
  curve f = force(step);
  while (sum.degree < f.degree) elevate(&sum);
  add(&sum, m->mf[i], &f);
  return sum;
}

static curve curve_of(const vs_step *step, int channel) {
  if (channel == VS_CH_I) return current(step);
  if (channel == VS_CH_FORCE) return force(step);
  const vs_model *m = step->frame->model;
  int rate2 = channel - vs_channel_rates2(m);
  if (channel == VS_CH_TRAVEL) return travel(step);
  return rate2 >= 0 ? acceleration(step, rate2) : coordinate(step, channel - VS_CH_Q);
}

/* ---- the extremes of one step ---- */

/* A deck's probe goes on a straight line between two knots. */
static void follow_probe(vs_extreme *e, const vs_step *step) {
  const vs_probe *probe =
      &step->frame->deck->probes[e->channel - vs_channel_deck(step->frame->model)];
  double from = probe->sign * step->from->terms[probe->term];
  double to = probe->sign * step->to->terms[probe->term], sense = e->sense;
  if (!e->best.known || sense * from > sense * e->best.value)
    e->best = (vs_value){true, from, step->from->t_s};
  if (sense * to > sense * e->best.value) e->best = (vs_value){true, to, step->to->t_s};
}

/* Value and slope at a knot, of a channel that is no probe. */
typedef struct at_knot {
  double y, rate;
} at_knot;

static at_knot of_law(const vs_frame *frame, const vs_knot *k, int channel) {
  const vs_model *m = frame->model;
  double z = frame->gap_at_rest ? m->coil.gap_rest_m : vs_mechanics_gap(m, k->x);
  double z_rate = frame->gap_at_rest ? 0 : vs_mechanics_travel(m, k->x + m->dof);
  vs_law_rates r = vs_coil_rates(&m->coil, k->flux_wb, k->flux_rate_v, z, z_rate);
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
static double reach(const search *s) {
  const vs_extreme *e = s->extreme;
  return e->sense ? e->sense * e->best.value : e->best.value;
}

static void take(const search *s, double y, double at_s) {
  vs_extreme *e = s->extreme;
  if (e->best.known && !(s->sign * y > reach(s))) return;
  e->best = (vs_value){true, e->sense ? y : s->sign * y + 0.0, at_s}; /* no -0 */
}

/* An extreme inside the step; where it is no larger than a knot's by rounding it says when. */
static void take_inside(const search *s, double part) {
  const vs_step *step = s->step;
  double from = step->from->t_s, to = step->to->t_s;
  double at_s = fmin(fmax(from + part * (to - from), from), to);
  double y = vs_step_channel(step, at_s, s->extreme->channel);
  double *best_at_s = &s->extreme->best.at_s;
  bool same = s->sign * y >= reach(s) - s->rounding;
  take(s, y, at_s);
  if (same && (*best_at_s == from || *best_at_s == to)) *best_at_s = at_s;
}

/* Root of a curve that changes its sign once, from > 0 to < 0: Newton's, kept between bounds, on
 * its powers. What rounding makes of those of degree 13 moves the root by 1e-11 of the step. */
static double falls_through_zero(curve slope) {
  int n = slope.degree;
  double *a = slope.b, lo = 0, hi = 1, at = 0.5;
  for (int k = 1; k <= n; k++)
    for (int i = n; i >= k; i--) a[i] -= a[i - 1];
  double choose = 1;
  for (int k = 0; k <= n; k++) {
    a[k] *= choose;
    choose *= (double)(n - k) / (k + 1);
  }
  for (int turn = 0; turn < 60; turn++) {
    double y = a[n], rate = 0;
    for (int k = n - 1; k >= 0; k--) {
      rate = rate * at + y;
      y = y * at + a[k];
    }
    if (y > 0)
      lo = at;
    else
      hi = at;
    double next = at - y / rate;
    if (!(next > lo && next < hi)) next = (lo + hi) / 2;
    if (fabs(next - at) <= DBL_EPSILON) break;
    at = next;
  }
  return at;
}

bool vs_extreme_turn_of_travel(const vs_step *step, vs_value *turn) {
  const vs_model *m = step->frame->model;
  double before = vs_mechanics_travel(m, step->from->x + m->dof),
         behind = vs_mechanics_travel(m, step->to->x + m->dof), y[VS_CH_MOST];
  if (!(before * behind < 0)) return false;
  curve g = travel(step), slope = slope_of(&g, before > 0 ? 1 : -1);
  double h = step->to->t_s - step->from->t_s;
  turn->at_s = step->from->t_s + h * falls_through_zero(slope);
  vs_step_groups_at(step, turn->at_s, 0, y);
  turn->value = y[VS_CH_TRAVEL];
  turn->known = true;
  return true;
}

/* Looks into the part of the step from `lo` that is `width` long, both in parts of the step. Cut in
 * halves, a curve comes as near to its coefficients as the square of the width: twenty-five times
 * is as near as rounding. What is level to rounding has no extreme but its ends. */
static void look_into(const search *s, curve c, double lo, double width) {
  double most = -INFINITY, least = INFINITY;
  int changes = 0, before = 0, first = 0;
  for (int k = 0; k <= c.degree; k++) {
    most = fmax(most, s->sign * c.b[k]);
    least = fmin(least, s->sign * c.b[k]);
  }
  if (most < reach(s) - s->rounding || most - least <= s->rounding) return;
  curve slope = slope_of(&c, s->sign);
  for (int k = 0; k <= slope.degree; k++) {
    int now = (slope.b[k] > 0) - (slope.b[k] < 0);
    if (!now) continue;
    changes += before && now != before;
    if (!first) first = now;
    before = now;
  }
  if (!changes || (changes == 1 && first < 0)) return; /* largest at an end */
  if (changes == 1)
    take_inside(s, lo + width * falls_through_zero(slope));
  else if (width > 0x1p-25) {
    curve half = halve(&c);
    look_into(s, half, lo, width / 2);
    look_into(s, c, lo + width / 2, width / 2);
  }
}

/* What the cubic through the values and slopes at both ends says of the step: whether it stays
 * below the extreme so far, and whether it rises or falls all along, so that an end is the most. A
 * sine that moves by one radian, the longest there is, leaves that cubic by 1/384 of its size, and
 * its slope by three times that; a twentieth of what is at the ends is allowed for, and a tenth of
 * the way. */
typedef enum outlook { BELOW, AT_AN_END, UNKNOWN } outlook;

static inline outlook outlook_of(const vs_extreme *e, at_knot from, at_knot to, double h) {
  double d = h / 3 * from.rate, f = h / 3 * to.rate, m = to.y - from.y - d - f, sign = e->sense;
  double y[] = {from.y, from.y + d, to.y - f, to.y};
  double size = fabs(from.y) + fabs(to.y) + fabs(d) + fabs(f);
  for (int k = 0; k < 4; k++) y[k] = e->sense ? sign * y[k] : fabs(y[k]);
  double a = y[0] > y[1] ? y[0] : y[1], b = y[2] > y[3] ? y[2] : y[3]; /* fmax would be called */
  double most = (a > b ? a : b) + 0.05 * size;
  if (e->best.known && most < (e->sense ? sign * e->best.value : e->best.value)) return BELOW;
  double least = 0.1 * (fabs(d) + fabs(m) + fabs(f));
  bool rises = d > least && m > least && f > least, falls = d < -least && m < -least && f < -least;
  return rises || falls ? AT_AN_END : UNKNOWN;
}

static void take_ends(const search *s, at_knot from, at_knot to) {
  take(s, from.y, s->step->from->t_s);
  take(s, to.y, s->step->to->t_s);
}

static void look_between(const search *s) {
  const vs_step *step = s->step;
  search in = *s;
  curve c = curve_of(step, s->extreme->channel);
  double size = 0;
  for (int k = 0; k <= c.degree; k++) size = fmax(size, fabs(c.b[k]));
  in.rounding = 4 * DBL_EPSILON * size;
  take(&in, c.b[0], step->from->t_s);
  take(&in, c.b[c.degree], step->to->t_s);
  if (size > 0) look_into(&in, c, 0, 1);
}

void vs_extreme_follow(vs_extreme *e, const vs_step *step, bool jammed) {
  bool of_flux = e->channel == VS_CH_I || e->channel == VS_CH_FORCE;
  const vs_model *m = step->frame->model;
  if (e->channel >= vs_channel_deck(m)) {
    follow_probe(e, step);
    return;
  }
  if (of_flux && e->best.known && vs_step_is_quiet(step)) return; /* both are 0, and |i| is meant */
  const at_knot from = knot_of(step->frame, step->from, e->channel),
                to = knot_of(step->frame, step->to, e->channel);
  bool held = jammed && e->channel >= vs_channel_rates2(m);
  outlook seen = held ? UNKNOWN : outlook_of(e, from, to, step->to->t_s - step->from->t_s);
  if (seen == BELOW) return;
  for (int sign = 1; sign >= -1; sign -= 2) {
    const search s = {.extreme = e, .step = step, .sign = sign};
    if (e->sense && e->sense != sign) continue;
    take_ends(&s, from, to);
    if (seen == UNKNOWN) look_between(&s);
  }
}
