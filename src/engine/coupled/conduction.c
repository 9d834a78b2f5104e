/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/conduction.h"

#include <math.h>

#include "netlist/parts.h"

/* Above this current, A, a conduction has begun for certain: holding currents are of this order or
 * larger. */
static const double CONDUCTS_A = 0.02;
/* With its gate pulse there a conduction has begun above GATED_A, a third of the peak at 178
 * degrees of 50 V, and above the share REMAINS of the peak before: behind a conduction of 38 mA the
 * solver made swings of 0.7 % of that at a tolerance of 1e-4. */
static const double GATED_A = 1e-5, REMAINS = 0.02;
/* A device that recovers, and whose current is back so soon, has not gone out: as it empties its
 * snubber, and goes on by its gate alone, the solver's step may end below zero. */
static const double AT_ONCE_S = 1e-6;
/* Leakage is told from this voltage on; below it rounding errors are as large. */
static const double LEAKS_FROM_V = 0.1;
/* Two currents do not count in CONDUCTS_A: what leaks through 500 ohm, half of the least
 * off_resistance that a part of spice/parts may have; and what a junction of 1 nF draws, where
 * devices of 100 A have a few hundred pF. */
static const double LEAKS_S = 2e-3, DISPLACED_F = 1e-9;
/* Below GONE_A a current is over. Its zero is looked for up to REST_S ahead: the slowest fall that
 * ends at a zero, of some 5 A/s, has come to it by then, and a current that decays has no zero.
 * Below LEAKAGE_A, which is what leaks through 1 kohm at an on-state voltage of 1 V, a current may
 * be over, if by the fall so far it should be gone. Where the current's peak was below CONDUCTS_A,
 * GONE_A and LEAKAGE_A are smaller in the same proportion. */
static const double GONE_A = 5e-6, REST_S = 1e-6, LEAKAGE_A = 1e-3;
/* A voltage above this is no on-state voltage, V. */
static const double BLOCKED_V = 10;
/* Where the current rises this many times as steeply as on the mean since its foot, another rise
 * begins, with its foot here. It must be well above 4: a current that begins as t^2 is up to 4
 * times as steep from one step to the next, if steps double. */
static const double KINK = 10;

/* Behind a turn of the voltage the current may be what the conduction before has stored: a triac's
 * recovery. Of a device of this size that is over within 150 us, the t_q of a slow thyristor. */
static const double RECOVERY_S = 150e-6;

/* No current that steps resolve turns round in each of ALTERNATES + 1 steps one behind the other,
 * each time by half of its last change or more. What is left so of displacement currents is a few
 * milliamperes, and 70 mA at a tolerance of 1e-2; MOST_A is beyond them and below what conducts for
 * certain. */
static const int ALTERNATES = 2;
static const double MOST_A = 0.2;

void vs_conduction_begin(vs_conduction *c) {
  *c = (vs_conduction){.leak_s = NAN,
                       .low_s = NAN,
                       .out_s = NAN,
                       .recovery_end_s = NAN,
                       .before_s = NAN,
                       .before_a = NAN,
                       .foot_s = NAN,
                       .foot_a = NAN};
}

double vs_conduction_turn_off(const vs_deck *deck, const vs_device *device) {
  const char *file = device && device->part >= 0 ? deck->parts[device->part].file : NULL;
  const vs_limit *t_q = file ? vs_parts_find_limit(deck, file, "t_q") : NULL;
  return t_q ? t_q->value : 0;
}

void vs_conduction_wind(vs_conduction *c, double by_s) {
  c->low_s -= by_s;
  c->out_s -= by_s;
  c->recovery_end_s -= by_s;
  c->before_s -= by_s;
  c->foot_s -= by_s;
}

bool vs_conduction_asks(const vs_conduction *c, double i_a) {
  return !c->conducts || ((c->recovers || c->both_ways) && i_a <= LEAKAGE_A);
}

/* Of all that it drew while it blocked in parts of the voltage the least counts: a capacitance's
 * current comes on top of leakage as the voltage grows, and that of a conduction on top of both.
 * More than LEAKS_S is none. */
static void follow_leakage(vs_conduction *c, const vs_conduction_step *s) {
  if (fabs(s->v1_v) < LEAKS_FROM_V) return;
  double leak_s = s->i1_a / s->v1_v;
  if (leak_s >= 0 && leak_s <= LEAKS_S)
    c->leak_s = fmin(c->leak_s, leak_s); /* which leaves NaN out */
}

double vs_conduction_current(const vs_conduction *c, double i_a, double v_v) {
  return isnan(c->leak_s) ? i_a : i_a - c->leak_s * v_v;
}

/* The most that the capacitance of the blocked junction draws forward. It does so as well while the
 * voltage comes back from reverse. */
static double displaced(const vs_conduction_step *s) {
  return DISPLACED_F * fmax((s->v1_v - s->v0_v) / (s->t1_s - s->t0_s), 0);
}

/* Where the line through two points of the current passes zero. */
static double zero_of(double t0_s, double i0_a, double t1_s, double i1_a) {
  return t0_s + (t1_s - t0_s) * i0_a / (i0_a - i1_a);
}

static void set_foot(vs_conduction *c, double t_s, double i_a) {
  c->foot_s = t_s;
  c->foot_a = i_a;
}

void vs_conduction_turn(vs_conduction *c, double zero_s) {
  c->before_a = -c->before_a;
  c->change_a = -c->change_a;
  c->mean_a[0] = -c->mean_a[0];
  c->mean_a[1] = -c->mean_a[1];
  c->recovery_end_s = zero_s + RECOVERY_S;
  c->has_blocked = false;
  set_foot(c, zero_s, 0);
}

/* The most that a blocking device leaks at this voltage. */
static double leakage(double v_v) {
  return LEAKS_S * fabs(v_v);
}

void vs_conduction_resume(vs_conduction *c, double i_a, double v_v) {
  const bool recovers = c->recovers, both_ways = c->both_ways;
  vs_conduction_begin(c);
  c->recovers = recovers;
  c->both_ways = both_ways;
  c->conducts = i_a > CONDUCTS_A + leakage(v_v);
  c->peak_a = c->conducts ? i_a : 0;
}

static bool is_on_state(double v_v) {
  return v_v > 0 && v_v < BLOCKED_V;
}

/* The least rise of the current that is a conduction's where its gate pulse is there. */
static double remains(const vs_conduction *c) {
  return fmin(fmax(REMAINS * c->peak_a, c->recovers ? LEAKAGE_A : GATED_A), CONDUCTS_A);
}

/* A current that stands above its foot, with a gate pulse and at an on-state voltage: the jump by
 * which it came there may have been excused as a capacitance's, and from then on it may only fall,
 * as where the thyristor discharges its snubber. */
static bool stands(const vs_conduction *c, const vs_conduction_step *s) {
  return c->gated && is_on_state(s->v0_v) && is_on_state(s->v1_v) &&
         s->i1_a - c->foot_a > remains(c) + displaced(s);
}

/* Moves the foot on to the step's end where the current has not begun: where it does not rise, or
 * only charges a capacitance, or leaks. */
static void follow_foot(vs_conduction *c, const vs_conduction_step *s) {
  if (isnan(c->foot_s)) set_foot(c, s->t0_s, s->i0_a);
  double rise = s->i1_a - s->i0_a, steep = rise / (s->t1_s - s->t0_s);
  bool blocked = fabs(s->v1_v) > BLOCKED_V && s->i1_a <= leakage(s->v1_v);
  bool goes_on = isfinite(c->recovery_end_s) && !c->has_blocked; /* as it does since the turn */
  if ((rise <= 0 && !goes_on && !stands(c, s)) || s->i1_a <= displaced(s) || blocked)
    set_foot(c, s->t1_s, s->i1_a);
  else if (s->i0_a <= 0)
    set_foot(c, zero_of(s->t0_s, s->i0_a, s->t1_s, s->i1_a), 0);
  else if (steep * (s->t0_s - c->foot_s) > KINK * (s->i0_a - c->foot_a))
    set_foot(c, s->t0_s, s->i0_a);
}

/* True while a current that is there since the voltage turned is recovery: the voltage rises as the
 * current goes, where that of a device that goes on conducting stays that of the on-state, or comes
 * back to it. */
static bool is_recovery(vs_conduction *c, const vs_conduction_step *s) {
  bool back = c->has_blocked && is_on_state(s->v1_v);
  c->has_blocked = c->has_blocked || s->v1_v > BLOCKED_V;
  return !back && s->t1_s < c->recovery_end_s;
}

/* True where a conduction begins in the step; *event_s is its foot, where the rise began. With a
 * gate pulse a small rise is enough; without one the current must be more than leakage and
 * capacitance can explain. */
static bool fires(vs_conduction *c, const vs_conduction_step *s, double *event_s) {
  follow_foot(c, s);
  double moved_a = DISPLACED_F * fabs(s->v1_v - s->v0_v) / (s->t1_s - s->t0_s);
  bool by_gate = c->gated && is_on_state(s->v1_v) && s->i1_a - c->foot_a > remains(c) + moved_a;
  bool small = s->i1_a <= CONDUCTS_A + displaced(s) + leakage(s->v1_v);
  if (small) c->recovery_end_s = NAN;
  if (!by_gate && (small || is_recovery(c, s))) return false;
  *event_s = c->foot_s;
  c->peak_a = s->i1_a;
  return true;
}

/* Continues the fall up to the step's beginning. Returns the current that this gives at the step's
 * end, and *zero_s is when it comes to zero; both are INFINITY where there was no fall. */
static double taken_on(const vs_conduction *c, const vs_conduction_step *s, double *zero_s) {
  *zero_s = INFINITY;
  if (!(s->i0_a < c->before_a)) return INFINITY;
  *zero_s = zero_of(c->before_s, c->before_a, s->t0_s, s->i0_a);
  return s->i0_a * (*zero_s - s->t1_s) / (*zero_s - s->t0_s);
}

/* Since when the current is below low_a. */
static void follow_low(vs_conduction *c, const vs_conduction_step *s, double low_a) {
  if (s->i1_a > low_a)
    c->low_s = NAN;
  else if (isnan(c->low_s))
    c->low_s =
        s->i0_a > low_a ? zero_of(s->t0_s, s->i0_a - low_a, s->t1_s, s->i1_a - low_a) : s->t0_s;
}

/* The current is over, or goes on below all that counts, since *out_s. may_go_on: it may be taken
 * up again, so that a fall says nothing of where it ends. */
static bool is_over(vs_conduction *c, const vs_conduction_step *s, bool may_go_on, double *out_s) {
  double zero_s, expected_a = taken_on(c, s, &zero_s);
  c->peak_a = fmax(c->peak_a, s->i1_a);
  double part = fmin(c->peak_a / CONDUCTS_A, 1);
  bool blocked = fabs(s->v1_v) > BLOCKED_V && s->i1_a < leakage(s->v1_v) / 2;
  double leaks_a = part * LEAKAGE_A;
  follow_low(c, s, leaks_a);
  bool broke_off = s->i1_a <= leaks_a && expected_a <= 0 && !may_go_on;
  if (s->i1_a > part * GONE_A && !broke_off && !blocked) return false;
  if (!isnan(c->out_s)) return true;
  double chord_s = s->i1_a < s->i0_a ? zero_of(s->t0_s, s->i0_a, s->t1_s, s->i1_a) : s->t1_s;
  if (s->i1_a > 0 && (broke_off || blocked)) chord_s = s->t1_s;
  zero_s = fmin(fmax(zero_s, s->t0_s), chord_s);
  *out_s = fmin(zero_s, s->t1_s + REST_S);
  c->tail_s = isnan(c->low_s) ? 0 : fmax(*out_s - c->low_s, 0);
  c->tail_a_s = leaks_a / c->tail_s;
  return true;
}

/* True where the conduction goes out; *event_s is when its current ended. A device that recovers
 * and is still gated may take its current up again: it goes out only once the current has stayed
 * away for AT_ONCE_S, and one that conducts both ways once its voltage or its gate pulse has gone,
 * as its gate's current and a ring of its snubber flow there the other way. Until then the end
 * found first waits in c->out_s, and is forgotten where the current comes back. */
static bool goes_out(vs_conduction *c, const vs_conduction_step *s, double *event_s) {
  const bool may_go_on = (c->recovers || c->both_ways) && c->gated && is_on_state(s->v1_v);
  double out_s = c->out_s;
  bool over = is_over(c, s, may_go_on, &out_s);
  c->out_s = over ? out_s : NAN;
  if (!over || (may_go_on && (c->both_ways || s->t1_s < out_s + AT_ONCE_S))) return false;
  *event_s = out_s;
  c->out_s = c->low_s = NAN;
  return true;
}

/* Takes the current, without its leakage, over each step in the place of that at its end, where it
 * goes up and down from step to step. */
static void smooth(vs_conduction *c, vs_conduction_step *net) {
  double change_a = net->i1_a - net->i0_a, mean_a = (net->i0_a + net->i1_a) / 2;
  bool back = change_a * c->change_a < 0 && fabs(change_a) > fabs(c->change_a) / 2 &&
              fabs(change_a) < MOST_A;
  c->alternations = back ? c->alternations + 1 : 0;
  if (c->alternations >= ALTERNATES) {
    c->before_a = c->mean_a[1];
    net->i0_a = c->mean_a[0];
    net->i1_a = mean_a;
  }
  c->change_a = change_a;
  c->mean_a[1] = c->mean_a[0];
  c->mean_a[0] = mean_a;
}

vs_event vs_conduction_follow(vs_conduction *c, const vs_conduction_step *step, double *event_s) {
  bool was = c->conducts;
  if (!was) follow_leakage(c, step);
  vs_conduction_step net = *step;
  net.i0_a = vs_conduction_current(c, step->i0_a, step->v0_v);
  net.i1_a = vs_conduction_current(c, step->i1_a, step->v1_v);
  smooth(c, &net);
  c->conducts = was ? !goes_out(c, &net, event_s) : fires(c, &net, event_s);
  c->before_s = net.t0_s;
  c->before_a = net.i0_a;
  if (c->conducts == was) return VS_EV_NONE;
  set_foot(c, net.t1_s, net.i1_a);
  return was ? VS_EV_EXTINCT : VS_EV_FIRES;
}
