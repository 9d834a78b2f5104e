/* SPDX-License-Identifier: GPL-3.0-or-later
 * Reduction to the energy that a device turns into heat in one pulse. It is told from the voltage
 * and current at the device's terminals, between which there may be a capacitance too.
 *
 * A pulse begins when |i| reaches 1 mA. It ends when |i| has stayed below that for a quarter of a
 * mains cycle, 5 ms at 50 Hz. A maker's rating is for one pulse of 2 ms. A disc's heat needs tens
 * of milliseconds to get from its middle to its electrodes, so that what a ring or a burst brings
 * within a few milliseconds adds up as if it had come at once. Yet pulses that come back with every
 * half cycle of the mains stay single ones; the mean power is the measure for those.
 *
 * The integral of v i is heat and what the capacitance stores. What is stored depends on |v| alone.
 * So between two instants of the same |v| the integral is heat alone; and where |v| is less at the
 * second instant, the integral is less than the heat. A pulse's heat is the largest such integral
 * in it. Therefore it counts nothing that is only stored, and it is never above the integral over
 * the run. It is known when the voltage has come back. Of a pulse whose current still flows as the
 * run ends, all of the integral is taken for heat, which is too much by what is stored then. */
#include "devices/reductions.h"

#include <math.h>

/* A current from here on begins a pulse, or keeps it going. */
static const double PULSE_A = 1e-3;

/* Levels of |v| whose first passing is noted: 0 V, then 16 to an octave from 1 V to 131 kV. Heat
 * below a level is left out where the pulse never comes back to that level; levels are 4.4 % apart.
 */
enum { OCTAVES = 17, IN_OCTAVE = 16, LEVELS = 2 + OCTAVES * IN_OCTAVE };

/* Start from {.rest_s = }. Energies count from the pulse's beginning, J. */
typedef struct pulse {
  double rest_s; /* a pulse ends when its current has stayed away this long */
  bool lasts;
  double current_s;        /* when the device last had a current */
  double energy_j;         /* the integral of v i */
  double heat_j;           /* the most of it that was found to be heat */
  double begin_v;          /* |v| at the pulse's beginning */
  double passed_j[LEVELS]; /* the integral when |v| was first at each level */
  int top;                 /* the highest level passed */
} pulse;

static double heat_level_v(int k) {
  return k ? exp2((double)(k - 1) / IN_OCTAVE) : 0;
}

/* The lowest level that is not below v. */
static int level_above(double v) {
  if (v <= 1) return v > 0;
  return 1 + (int)ceil(IN_OCTAVE * log2(fmin(v, exp2(OCTAVES + 1))));
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
static double pulse_energy_at(const leg *l, double at) {
  const vs_course_step *c = l->c;
  double p0 = c->from[VS_OF_POWER], pm = c->mid[VS_OF_POWER], p1 = c->to[VS_OF_POWER];
  double slope = 4 * pm - 3 * p0 - p1, bend = 2 * (p0 - 2 * pm + p1);
  return l->begin_j + c->h_s * at * (p0 + at * (slope / 2 + at * bend / 3));
}

/* The pulse's energy when |v| is v; at the leg's end where |v| does not come there. */
static double energy_when(const leg *l, double v) {
  bool comes = l->v0 != l->v1 && (v - l->v0) * (v - l->v1) <= 0;
  return pulse_energy_at(l, comes ? l->at0 + (l->at1 - l->at0) * (v - l->v0) / (l->v1 - l->v0)
                                  : l->at1);
}

static void follow_leg(pulse *p, const leg *l) {
  while (p->top + 1 < LEVELS && heat_level_v(p->top + 1) <= l->v1) {
    p->top++;
    p->passed_j[p->top] = energy_when(l, heat_level_v(p->top));
  }
  int k = level_above(l->v1);
  if (k <= p->top) {
    double v = l->v1 < l->v0 ? heat_level_v(k) : INFINITY;
    p->heat_j = fmax(p->heat_j, energy_when(l, v) - p->passed_j[k]);
  }
  if (p->begin_v < l->v1) return;
  p->heat_j = fmax(p->heat_j, energy_when(l, l->v1 < l->v0 ? p->begin_v : INFINITY));
}

static void begin_pulse(pulse *p, const vs_course_step *c) {
  p->lasts = true;
  p->energy_j = p->heat_j = 0;
  p->begin_v = fabs(c->from[VS_OF_V]);
  for (p->top = 0; p->top + 1 < LEVELS && heat_level_v(p->top + 1) <= p->begin_v; p->top++)
    p->passed_j[p->top] = 0;
  p->passed_j[p->top] = 0;
}

/* Takes the next step of the device's course. Returns the heat of the present pulse, J; 0 where
 * there is none. */
static double follow_heat_pulse(pulse *p, const vs_course_step *c) {
  bool current = fmax(fabs(c->from[VS_OF_I]), fabs(c->to[VS_OF_I])) >= PULSE_A;
  p->lasts = p->lasts && (current ? c->t0_s : c->t1_s) - p->current_s < p->rest_s;
  if (current && !p->lasts) begin_pulse(p, c);
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
  p->energy_j = pulse_energy_at(&l, 1);
  return p->heat_j;
}

/* True if there is no pulse, and a step with this current, A, at both ends begins none. */
static bool pulse_rests(const pulse *p, double i_a) {
  return !p->lasts && fabs(i_a) < PULSE_A;
}

/* Once the run is over, at now_s: all the energy of a pulse whose current still flows; 0 where
 * there is none. */
static double unfinished_j(const pulse *p, double now_s) {
  return p->lasts && p->current_s >= now_s ? p->energy_j : 0;
}

/* ---- as a reduction ---- */

static void prepare_heat(vs_watched *w, vs_reduced *r) {
  pulse *p = r->state;
  p->rest_s = w->timeline->period_s / 4;
}

static void follow_heat(const vs_watched *w, vs_reduced *r, const vs_course_step *c) {
  pulse *p = r->state;
  double before = p->heat_j, heat = follow_heat_pulse(p, c);
  (void)w;
  vs_reducer_take_largest(r, c, fmin(before, heat), heat);
}

static bool heat_rests(const vs_watched *w, const vs_reduced *r, const vs_courses *c) {
  const pulse *p = r->state;
  bool rests = pulse_rests(p, w->last[VS_OF_I]);
  for (size_t n = 0; n < c->count && rests; n++) rests = pulse_rests(p, c->of[VS_OF_I][n][1]);
  return rests;
}

/* What the present current has brought as the run ends counts whole. No pulse has more heat than
 * the run, whose integral may be less by the rounding of sums. */
static void finish_heat(const vs_watched *w, vs_reduced *r, const vs_run_end *end) {
  double heat_j = unfinished_j(r->state, end->now_s);
  if (heat_j > r->value.value) r->value = (vs_value){true, heat_j, end->now_s};
  r->value.value = fmin(r->value.value, fmax(w->sum[VS_OF_POWER], 0));
  if (r->limit && isnan(r->failed_s) && r->value.value > r->limit->value) r->failed_s = end->now_s;
}

const vs_reducer vs_pulse_heat = {.state_size = sizeof(pulse),
                                  .prepare = prepare_heat,
                                  .begin = vs_reducer_begin_at_zero,
                                  .follow = follow_heat,
                                  .rests = heat_rests,
                                  .finish = finish_heat};
