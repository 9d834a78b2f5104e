/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "devices/pulse.h"

#include <math.h>

/* A current from here on begins a pulse, or keeps it going. */
static const double PULSE_A = 1e-3;

static double level_v(int k) {
  return k ? exp2((double)(k - 1) / VS_PULSE_IN_OCTAVE) : 0;
}

/* The lowest level that is not below v. */
static int level_above(double v) {
  if (v <= 1) return v > 0;
  return 1 + (int)ceil(VS_PULSE_IN_OCTAVE * log2(fmin(v, exp2(VS_PULSE_OCTAVES + 1))));
}

/* A part of a step in which |v| goes one way. */
typedef struct leg {
  const vs_course_step *c;
  double at0, at1; /* where it lies, in parts of the step */
  double v0, v1;   /* |v| */
  double begin_j;  /* the pulse's energy at the step's beginning */
} leg;

/* The pulse's energy at `at`, a part of the step from its beginning on. Within a step the power
 * runs on a parabola. */
static double energy_at(const leg *l, double at) {
  const vs_course_step *c = l->c;
  double p0 = c->from[VS_OF_POWER], pm = c->mid[VS_OF_POWER], p1 = c->to[VS_OF_POWER];
  double slope = 4 * pm - 3 * p0 - p1, bend = 2 * (p0 - 2 * pm + p1);
  return l->begin_j + c->h_s * at * (p0 + at * (slope / 2 + at * bend / 3));
}

/* The pulse's energy when |v| is v; at the leg's end where |v| does not come there. */
static double energy_when(const leg *l, double v) {
  bool comes = l->v0 != l->v1 && (v - l->v0) * (v - l->v1) <= 0;
  return energy_at(l, comes ? l->at0 + (l->at1 - l->at0) * (v - l->v0) / (l->v1 - l->v0) : l->at1);
}

static void follow_leg(vs_pulse *p, const leg *l) {
  while (p->top + 1 < VS_PULSE_LEVELS && level_v(p->top + 1) <= l->v1) {
    p->top++;
    p->passed_j[p->top] = energy_when(l, level_v(p->top));
  }
  int k = level_above(l->v1);
  if (k <= p->top) {
    double v = l->v1 < l->v0 ? level_v(k) : INFINITY;
    p->heat_j = fmax(p->heat_j, energy_when(l, v) - p->passed_j[k]);
  }
  if (p->begin_v < l->v1) return;
  p->heat_j = fmax(p->heat_j, energy_when(l, l->v1 < l->v0 ? p->begin_v : INFINITY));
}

static void begin(vs_pulse *p, const vs_course_step *c) {
  p->lasts = true;
  p->energy_j = p->heat_j = 0;
  p->begin_v = fabs(c->from[VS_OF_V]);
  for (p->top = 0; p->top + 1 < VS_PULSE_LEVELS && level_v(p->top + 1) <= p->begin_v; p->top++)
    p->passed_j[p->top] = 0;
  p->passed_j[p->top] = 0;
}

double vs_pulse_follow(vs_pulse *p, const vs_course_step *c) {
  bool current = fmax(fabs(c->from[VS_OF_I]), fabs(c->to[VS_OF_I])) >= PULSE_A;
  p->lasts = p->lasts && (current ? c->t0_s : c->t1_s) - p->current_s < p->rest_s;
  if (current && !p->lasts) begin(p, c);
  if (!p->lasts) return 0;
  if (current) p->current_s = c->t1_s;
  double v0 = c->from[VS_OF_V], v1 = c->to[VS_OF_V];
  leg l = {c, 0, 1, fabs(v0), fabs(v1), p->energy_j};
  if (v0 * v1 < 0) { /* down to 0 and up again */
    leg down = l;
    down.at1 = l.at0 = v0 / (v0 - v1);
    down.v1 = l.v0 = 0;
    follow_leg(p, &down);
  }
  follow_leg(p, &l);
  p->energy_j = energy_at(&l, 1);
  return p->heat_j;
}

bool vs_pulse_rests(const vs_pulse *p, double i_a) {
  return !p->lasts && fabs(i_a) < PULSE_A;
}

double vs_pulse_unfinished(const vs_pulse *p, double now_s) {
  return p->lasts && p->current_s >= now_s ? p->energy_j : 0;
}
