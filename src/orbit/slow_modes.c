/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "slow_modes.h"

#include <math.h>
#include <string.h>

void vs_slow_modes_begin(vs_slow_modes *c, const vs_deck *deck, double tolerance, double period_s) {
  *c = (vs_slow_modes){
      .deck = deck, .tolerance = tolerance, .period_s = period_s, .moved = -1, .gain = 1};
  for (size_t k = 0; k < deck->n_probes; k++) c->probe[k].ratio = NAN;
}

static double value_of_probe(const vs_slow_modes *c, size_t k, const vs_knot *knot) {
  return c->deck->probes[k].sign * knot->terms[c->deck->probes[k].term];
}

void vs_slow_modes_accept(vs_slow_modes *c, const vs_step *step) {
  for (size_t k = 0; k < c->deck->n_probes; k++)
    c->probe[k].peak = fmax(c->probe[k].peak, fabs(value_of_probe(c, k, step->to)));
}

/* ---- what creeps ---- */

static bool is_flux(const vs_probe *p) {
  return !strcmp(p->unit, "Wb");
}

/* An integral, as of a fuse's heat, may grow for ever, and nothing comes back to where it was. */
static bool comes_back(const vs_probe *p) {
  return is_flux(p) || !strcmp(p->unit, "V") || !strcmp(p->unit, "A");
}

/* A probe creeps whose changes fall by about the same factor over ENOUGH passes: a factor of SLOW
 * and more, and each within SAME of the one before. */
static const double SLOW = 0.6, SAME = 0.1;
enum { ENOUGH = 2 };
/* A change that hardly falls is taken to go on for this many passes. */
static const double LASTS = 200;

static void follow_creeping_probe(vs_slow_modes_probe *p, double value, bool first, bool second) {
  double change = value - p->value, ratio = second ? NAN : change / p->change;
  bool same = fabs(ratio - p->ratio) <= SAME && ratio >= SLOW; /* false with NaN */
  p->steady = same ? p->steady + 1 : 0;
  p->ratio = first ? NAN : ratio;
  p->change = first ? NAN : change;
  p->value = value;
  p->scale = p->peak;
  p->peak = 0;
  p->remains = 0;
  if (p->steady >= ENOUGH)
    p->remains = fabs(change) * (ratio < 1 ? fmin(1 / (1 - ratio), LASTS) : LASTS);
}

const vs_slow_modes_probe *vs_slow_modes_worst(const vs_slow_modes *c, const char **name) {
  const vs_slow_modes_probe *worst = NULL;
  for (size_t k = 0; k < c->deck->n_probes; k++) {
    const vs_slow_modes_probe *p = &c->probe[k];
    bool creeps = comes_back(&c->deck->probes[k]) && p->remains > c->tolerance * p->scale;
    if (!creeps || (worst && p->remains * worst->scale <= worst->remains * p->scale)) continue;
    worst = p;
    *name = c->deck->probes[k].name;
  }
  return worst;
}

/* ---- what is moved ---- */

/* The flux linkage that creeps most is moved from then on. */
static void choose_flux(vs_slow_modes *c) {
  double most = 0;
  for (size_t k = 0; k < c->deck->n_probes; k++) {
    const vs_slow_modes_probe *p = &c->probe[k];
    if (!is_flux(&c->deck->probes[k]) || !(p->remains > fmax(c->tolerance * p->scale, most)))
      continue;
    most = p->remains;
    c->moved = (int)k;
  }
}

/* At most this share of its largest size a flux linkage is moved at once where it is not known how
 * far is too far: behind a knee of its core it creeps back ten times as fast. */
static const double MOST_MOVED = 0.2;

static void take_point(vs_slow_modes *c, double flux_wb, double change_wb) {
  vs_slow_modes_point p = {flux_wb, change_wb};
  if (c->points && p.change_wb * c->last.change_wb < 0) {
    c->across = c->last;
    c->bracketed = true;
  }
  c->before = c->last;
  c->last = p;
  c->points++;
}

/* How far from a, Wb, the straight line through two clean passes has no change; NaN: nowhere, or
 * where it would be driven away from. */
static double secant_of_creep(const vs_slow_modes_point *a, const vs_slow_modes_point *b) {
  double slope = (a->change_wb - b->change_wb) / (a->flux_wb - b->flux_wb);
  return slope < 0 ? -a->change_wb / slope : NAN;
}

/* How far from the last clean pass's beginning the flux linkage would stay, Wb. */
static double distance_of_creep(const vs_slow_modes *c, double scale) {
  double most = MOST_MOVED * scale, way = copysign(most, c->last.change_wb);
  double by = c->points > 1 ? secant_of_creep(&c->last, &c->before) : NAN;
  if (!c->bracketed) return isnan(by) ? way : fmin(fmax(by, -most), most);
  double gap = c->across.flux_wb - c->last.flux_wb;
  return by / gap > 0 && by / gap < 1 ? by : secant_of_creep(&c->last, &c->across);
}

/* A push that would move less than this part of what is wanted anyway is not worth a pass. */
static void decide_push(vs_slow_modes *c, double end_wb) {
  const vs_slow_modes_probe *p = &c->probe[c->moved];
  double by = c->last.flux_wb + distance_of_creep(c, p->scale) - end_wb;
  c->area_v_s = 0;
  if (!(fabs(by) > c->tolerance * p->scale)) return;
  c->from_wb = end_wb;
  c->nature_wb = c->last.change_wb;
  c->area_v_s = (by - c->nature_wb) / c->gain;
}

/* The pushed pass has ended: what the push was good for. */
static void learn_gain(vs_slow_modes *c, double end_wb) {
  double gain = (end_wb - c->from_wb - c->nature_wb) / c->area_v_s;
  if (gain > c->gain / 4 && gain < 4 * c->gain) c->gain = gain;
}

bool vs_slow_modes_turn(vs_slow_modes *c, const vs_knot *end) {
  bool clean = c->area_v_s == 0;
  double begun_wb = c->moved < 0 ? 0 : c->probe[c->moved].value;
  c->passes = clean ? c->passes + 1 : 0;
  for (size_t k = 0; k < c->deck->n_probes; k++)
    follow_creeping_probe(&c->probe[k], value_of_probe(c, k, end), c->passes < 1, c->passes < 2);
  if (c->moved < 0) {
    choose_flux(c);
    if (c->moved < 0) return clean;
    begun_wb = c->probe[c->moved].value - c->probe[c->moved].change;
  }
  const vs_slow_modes_probe *p = &c->probe[c->moved];
  if (clean) {
    take_point(c, begun_wb, p->value - begun_wb);
    decide_push(c, p->value);
  } else {
    learn_gain(c, p->value);
    c->area_v_s = 0;
  }
  return clean;
}

/* A change is known from the second pass on, a ratio from the third. */
bool vs_slow_modes_is_told(const vs_slow_modes *c) {
  return c->moved >= 0 || c->passes >= 3 + ENOUGH;
}

double vs_slow_modes_push(const vs_slow_modes *c, double t_s) {
  if (c->area_v_s == 0) return 0;
  return c->area_v_s / c->period_s * (1 - cos(2 * M_PI * t_s / c->period_s));
}
