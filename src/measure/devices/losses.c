/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "devices/losses.h"

#include <math.h>

/* What losses.h defines V1 and I1 by. */
static const double ON_V = 10, ON_SHARE = 0.1, OFF_SHARE = 0.02, OFF_A = 1e-3;

void vs_losses_begin(vs_losses *l, bool rectifies) {
  *l = (vs_losses){.rectifies = rectifies, .phase = VS_LOSS_BLOCKING};
}

/* V1 */
static double on_level_v(const vs_losses *l) {
  return l->most_v < ON_V ? ON_V : fmin(ON_SHARE * l->most_v, ON_V);
}

/* I1, or the end of a diode's recovery. */
static double level_a(const vs_losses *l) {
  return fmax(OFF_SHARE * (l->rectifies ? l->reverse_a : l->on_a), OFF_A);
}

/* ---- which phase ---- */

static int phase_of_switch(const vs_losses *l, double v, double i) {
  if (fabs(v) <= on_level_v(l)) return VS_LOSS_CONDUCTION;
  if (fabs(i) <= level_a(l)) return VS_LOSS_BLOCKING;
  bool was_on = l->phase == VS_LOSS_CONDUCTION || l->phase == VS_LOSS_OFF;
  return was_on ? VS_LOSS_OFF : VS_LOSS_ON;
}

static int phase_of_diode(const vs_losses *l, double v, double i) {
  if (v > 0 && i > 0) return VS_LOSS_CONDUCTION;
  bool behind = l->phase == VS_LOSS_CONDUCTION || l->phase == VS_LOSS_RECOVERY;
  return behind && (v > 0 || fabs(i) > level_a(l)) ? VS_LOSS_RECOVERY : VS_LOSS_BLOCKING;
}

static int phase_of(const vs_losses *l, double v, double i) {
  return l->rectifies ? phase_of_diode(l, v, i) : phase_of_switch(l, v, i);
}

/* ---- the parts of a step ---- */

static double between_ends(double y0, double y1, double at) {
  return y0 + at * (y1 - y0);
}

/* The first part of the step behind `at` at which the course is `level`, and not behind `end`. */
static double crossing_of_level(double y0, double y1, double level, double at, double end) {
  double s = y0 == y1 ? INFINITY : (level - y0) / (y1 - y0);
  return s > at + 1e-12 && s < end ? s : end;
}

/* The next instant at which the phase may change: within the part that begins there it does not. */
static double next_cut(const vs_losses *l, const vs_course_step *c, double at) {
  double v0 = c->from[VS_OF_V], v1 = c->to[VS_OF_V], i0 = c->from[VS_OF_I], i1 = c->to[VS_OF_I];
  double v = l->rectifies ? 0 : on_level_v(l), i = level_a(l), end = 1;
  end = crossing_of_level(v0, v1, v, at, end);
  end = crossing_of_level(v0, v1, -v, at, end);
  end = crossing_of_level(i0, i1, i, at, end);
  end = crossing_of_level(i0, i1, -i, at, end);
  return l->rectifies ? crossing_of_level(i0, i1, 0, at, end) : end;
}

double vs_losses_at(const vs_course_step *c, double at) {
  double p0 = c->from[VS_OF_POWER], pm = c->mid[VS_OF_POWER], p1 = c->to[VS_OF_POWER];
  double slope = 4 * pm - 3 * p0 - p1, bend = 2 * (p0 - 2 * pm + p1);
  return c->h_s * at * (p0 + at * (slope / 2 + at * bend / 3));
}

static void keep_largest(vs_value *largest, double value, double at_s) {
  if (!largest->known || value > largest->value) *largest = (vs_value){true, value, at_s};
}

/* The phase ends, and `next` begins. */
static void turn_phase(vs_losses *l, int next, double at_s) {
  bool turned_on = l->phase == VS_LOSS_ON && next == VS_LOSS_CONDUCTION;
  bool turned_off = l->phase == VS_LOSS_OFF && next == VS_LOSS_BLOCKING;
  if (turned_on || turned_off || l->phase == VS_LOSS_RECOVERY)
    keep_largest(&l->largest[l->phase], l->stretch_j, at_s);
  if (turned_off) keep_largest(&l->turned_off, l->on_a, at_s);
  if (next == VS_LOSS_RECOVERY) l->reverse_a = 0;
  l->phase = next;
  l->stretch_j = 0;
}

/* Takes the part of the step from `at` to `end`, and its current at that end. */
static void take_part_of_loss(vs_losses *l, const vs_course_step *c, double at, double end) {
  double mid = (at + end) / 2;
  double v = between_ends(c->from[VS_OF_V], c->to[VS_OF_V], mid);
  double i = between_ends(c->from[VS_OF_I], c->to[VS_OF_I], mid);
  int phase = phase_of(l, v, i);
  if (phase != l->phase) turn_phase(l, phase, c->t0_s + at * c->h_s);
  double joule = vs_losses_at(c, end) - vs_losses_at(c, at);
  l->joule[phase] += joule;
  l->stretch_j += joule;
  double end_a = between_ends(c->from[VS_OF_I], c->to[VS_OF_I], end);
  if (phase == VS_LOSS_CONDUCTION) l->on_a = fabs(end_a);
  if (phase == VS_LOSS_RECOVERY) l->reverse_a = fmax(l->reverse_a, -end_a);
}

void vs_losses_resume(vs_losses *l, double v_v, double i_a) {
  l->phase = phase_of(l, v_v, i_a);
  l->on_a = l->phase == VS_LOSS_CONDUCTION ? fabs(i_a) : 0;
  l->most_v = fabs(v_v);
}

/* A step has at most one part more than there are crossings; the levels may move once. */
enum { MOST_PARTS = 16 };

void vs_losses_follow(vs_losses *l, const vs_course_step *c) {
  double at = 0;
  for (int n = 0; at < 1 && n < MOST_PARTS; n++) {
    double end = n + 1 < MOST_PARTS ? next_cut(l, c, at) : 1;
    take_part_of_loss(l, c, at, end);
    at = end;
  }
  l->most_v = fmax(l->most_v, fabs(c->to[VS_OF_V]));
}
