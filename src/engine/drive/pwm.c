/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/pwm.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>

#include "engine/scene_event.h"

#define P_(member) offsetof(vs_pwm_values, member)

static const vs_field PWM[] = {
    {"on", VS_REAL, "ms", "0 ms", 0, 1e9, false, P_(on_s),
     "pwm is on once, from this instant on, and there is no carrier; this section is for "
     "decks with a port pwm",
     NULL, NULL},
    {"off", VS_REAL, "ms", "0 ms", 0, 1e9, false, P_(off_s),
     "up to this instant; 0: it stays on; without on and off there is a carrier", NULL, NULL},
    {"carrier", VS_REAL, "kHz", "10 kHz", 1e-3, 1e4, false, P_(carrier_hz),
     "frequency of the triangular carrier", NULL, NULL},
    {"duty", VS_PROFILE, "", "0.5", 0, 1, false, P_(duty),
     "mean share of a carrier period for which pwm is on", NULL, NULL},
    {"depth", VS_REAL, "", "0", 0, 1, false, P_(depth),
     "how far the sine moves that share, from least to largest", NULL, NULL},
    {"frequency", VS_REAL, "Hz", "50 Hz", 0, 1e6, false, P_(frequency_hz), "of the sine", NULL,
     NULL},
    {"phase", VS_REAL, "deg", "0 deg", -360, 360, false, P_(phase_rad), "of the sine at t = 0",
     NULL, NULL},
    {"dead_time", VS_REAL, "us", "0 us", 0, 1e6, false, P_(dead_s),
     "between the end of a pulse of pwm and the begin of one of pwm_low, and the other way round",
     NULL, NULL},
};
const vs_section vs_pwm_section = {"pwm", PWM, sizeof PWM / sizeof *PWM};

/* ---- one pulse ---- */

bool vs_pwm_is_single(const vs_pwm_values *p) {
  return p->on_s > 0 || p->off_s > 0;
}

/* Where the pulse of the upper switch begins and ends, or the gap between the lower one's. A pulse
 * from t = 0 on was there before. */
static void pulse_of(const vs_pwm_values *p, bool low, double at_s[2]) {
  at_s[0] = p->on_s > 0 ? p->on_s + (low ? 0 : p->dead_s) : -INFINITY;
  at_s[1] = p->off_s > 0 ? p->off_s + (low ? p->dead_s : 0) : INFINITY;
}

static bool is_in_pulse(const vs_pwm_values *p, bool low, double t_s) {
  double at_s[2];
  pulse_of(p, low, at_s);
  return (t_s >= at_s[0] && t_s < at_s[1]) != low;
}

static double pulse_edge(const vs_pwm_values *p, bool low, double t_s) {
  double at_s[2];
  pulse_of(p, low, at_s);
  return at_s[0] > t_s ? at_s[0] : at_s[1] > t_s ? at_s[1] : INFINITY;
}

/* ---- reference and carrier ---- */

/* The sine's angle is taken in turns, so that it does not lose digits over a million of them. */
static double reference(const vs_pwm_values *p, double shift_rad, double t_s) {
  double duty = vs_field_profile_at(&p->duty, t_s), turns = p->frequency_hz * t_s;
  if (p->depth == 0) return duty;
  turns -= floor(turns);
  return duty + p->depth / 2 * sin(2 * M_PI * turns + p->phase_rad - shift_rad);
}

static bool rises(double k) {
  return fmod(k, 2) == 0;
}

/* The instant on flank k at which the carrier has the value c. It is computed from a whole number,
 * so that it does not drift over a million periods. */
static double instant(const vs_pwm_values *p, double k, double c) {
  return (k + (rises(k) ? c : 1 - c)) / (2 * p->carrier_hz);
}

/* The root of g(c) = c - m(t(c)), which rises with c. Newton's iteration with the slope that the
 * last two points have, within a bracket; the slope is near 1, as the reference is slow. */
double vs_pwm_crossing(const vs_pwm_values *p, double shift_rad, double k) {
  if (p->depth == 0 && !p->duty.count) return instant(p, k, p->duty.first);
  double low = 0, high = 1, c = reference(p, shift_rad, instant(p, k, 0.5)), slope = 1;
  double before = NAN, g_before = NAN;
  for (int n = 0; n < 60; n++) {
    double g = c - reference(p, shift_rad, instant(p, k, c));
    if (g <= 0) low = c;
    if (g >= 0) high = c;
    if (n > 0 && c != before) slope = (g - g_before) / (c - before);
    double next = c - g / slope;
    if (!(next >= low && next <= high)) next = low + (high - low) / 2;
    before = c;
    g_before = g;
    c = next;
    if (fabs(c - before) <= DBL_EPSILON / 2) break;
  }
  return instant(p, k, c);
}

/* ---- one switch ---- */

/* Would the switch be on at t without a dead time? */
static bool is_wanted(const vs_pwm_values *p, vs_pwm_switch of, double t_s) {
  double flanks = 2 * p->carrier_hz * t_s, k = floor(flanks);
  double carrier = rises(k) ? flanks - k : 1 - (flanks - k);
  double m = reference(p, of.shift_rad, t_s);
  return (m > carrier || m >= 1) != of.low;
}

/* Is the switch off at the instant between t0 and t1, at most half a period apart, at which the
 * carrier turns in the middle of its off time? The upper one is off where the carrier is at 1. */
static bool turns_off_between(const vs_pwm_values *p, vs_pwm_switch of, double t0_s, double t1_s) {
  double half = of.low ? 0 : 0.5, n = floor(p->carrier_hz * t1_s - half);
  if (n == floor(p->carrier_hz * t0_s - half)) return false;
  double m = reference(p, of.shift_rad, (n + half) / p->carrier_hz);
  return of.low ? m > 0 : m < 1;
}

bool vs_pwm_is_on(const vs_pwm_values *p, vs_pwm_switch of, double t_s) {
  double before_s = t_s - vs_scene_event_rounding(t_s), since_s = before_s - p->dead_s;
  if (vs_pwm_is_single(p)) return is_in_pulse(p, of.low, before_s);
  if (!is_wanted(p, of, before_s)) return false;
  return p->dead_s == 0 ||
         (is_wanted(p, of, since_s) && !turns_off_between(p, of, since_s, before_s));
}

/* The edge that flank k brings: the begin of a pulse, put off by the dead time, or the end of one.
 * NaN where the pulse is left out. */
static double edge_of(const vs_pwm_values *p, vs_pwm_switch of, double k) {
  bool begins = rises(k) == of.low;
  double at_s = vs_pwm_crossing(p, of.shift_rad, k);
  if (p->dead_s == 0) return at_s;
  double other_s = vs_pwm_crossing(p, of.shift_rad, begins ? k + 1 : k - 1);
  if (begins) return at_s + p->dead_s < other_s ? at_s + p->dead_s : NAN;
  return other_s + p->dead_s < at_s ? at_s : NAN;
}

double vs_pwm_edge(const vs_pwm_values *p, vs_pwm_switch of, double t_s) {
  enum { FLANKS = 5 };
  double slack = vs_scene_event_rounding(t_s);
  if (vs_pwm_is_single(p)) return pulse_edge(p, of.low, t_s + slack);
  double k = floor(2 * p->carrier_hz * (t_s - p->dead_s - slack));
  for (int n = 0; n < FLANKS; n++, k++) {
    double at_s = edge_of(p, of, k);
    if (at_s > t_s + slack) return at_s;
  }
  return k / (2 * p->carrier_hz);
}

/* ---- what is refused, and what is said ---- */

/* The least and the largest value of the reference. */
static void range_of(const vs_pwm_values *p, double range[2]) {
  const vs_field_profile *d = &p->duty;
  range[0] = range[1] = d->first;
  for (int k = 1; k < d->count; k++) {
    range[0] = fmin(range[0], d->value[k]);
    range[1] = fmax(range[1], d->value[k]);
  }
  range[0] -= p->depth / 2;
  range[1] += p->depth / 2;
}

/* The steepest slope of the reference, 1/s. */
static double steepest(const vs_pwm_values *p) {
  const vs_field_profile *d = &p->duty;
  double most = 0;
  for (int k = 1; k < d->count; k++)
    if (d->value[k] != d->value[k - 1])
      most = fmax(most, fabs((d->value[k] - d->value[k - 1]) / (d->at_s[k] - d->at_s[k - 1])));
  return most + M_PI * p->frequency_hz * p->depth;
}

/* The place of the first of the keys that the section has, else the section's own. */
static vs_where place_of(const vs_node *section, const char *key, const char *other) {
  const vs_node *node = vs_tree_child(section, key);
  if (!node) node = vs_tree_child(section, other);
  return node ? node->where : section ? section->where : (vs_where){0};
}

/* The carrier's keys are as they are by default where there is none. */
static vs_status check_pulse(const vs_node *section, const vs_pwm_values *p, vs_error *err) {
  static const char *const KEYS[] = {"carrier", "duty", "depth"};
  const bool other[] = {p->carrier_hz != 1e4, p->duty.count || p->duty.first != 0.5, p->depth != 0};
  for (int k = 0; k < 3; k++)
    if (other[k])
      return vs_fail_at(err, place_of(section, KEYS[k], "on"),
                        "pwm.%s: with pwm.on and pwm.off there is one pulse and no carrier; leave "
                        "it out, or leave on and off out",
                        KEYS[k]);
  if (p->off_s == 0 || p->off_s > p->on_s) return VS_OK;
  return vs_fail_at(err, place_of(section, "off", "on"),
                    "pwm.off: %.9g ms is not behind pwm.on, %.9g ms; a later instant, or without "
                    "off for a pulse without an end",
                    1e3 * p->off_s, 1e3 * p->on_s);
}

vs_status vs_pwm_check(const vs_node *section, vs_pwm_values *p, vs_error *err) {
  static const double ROUNDING = 1e-12;
  double range[2], flank_s = 1 / (2 * p->carrier_hz);
  if (vs_tree_child(section, "on") && p->on_s == 0 && p->off_s == 0) p->off_s = INFINITY;
  if (vs_pwm_is_single(p)) return check_pulse(section, p, err);
  range_of(p, range);
  if (range[0] < -ROUNDING || range[1] > 1 + ROUNDING)
    return vs_fail_at(err, place_of(section, "depth", "duty"),
                      "pwm.depth: duty and half of depth make a reference from %.6g to %.6g; "
                      "allowed: from 0 to 1",
                      range[0], range[1]);
  if (isinf(steepest(p)))
    return vs_fail_at(err, place_of(section, "duty", "carrier"),
                      "pwm.duty: it jumps where two points have one time; wanted: a duty without "
                      "jumps, so a time between them");
  if (!(steepest(p) < 1 / flank_s))
    return vs_fail_at(err, place_of(section, "carrier", "frequency"),
                      "pwm.carrier: the reference changes by up to %.6g in a second, faster than "
                      "the carrier, by %.6g; a carrier above %.6g kHz, or a duty without jumps",
                      steepest(p), 1 / flank_s, steepest(p) / 2e3);
  if (p->dead_s < flank_s) return VS_OK;
  return vs_fail_at(
      err, place_of(section, "dead_time", "carrier"),
      "pwm.dead_time: %.6g us is half a period of the carrier, or more; allowed here: "
      "below %.6g us",
      1e6 * p->dead_s, 1e6 * flank_s);
}

bool vs_pwm_drops(const vs_pwm_values *p, bool low, char *text, size_t size) {
  double range[2];
  if (vs_pwm_is_single(p)) return false;
  range_of(p, range);
  double least = low ? 1 - range[1] : range[0], least_s = fmax(least, 0) / p->carrier_hz;
  if (p->dead_s == 0 || least_s > p->dead_s) return false;
  snprintf(text, size,
           "pwm.dead_time: pulses of port pwm%s no longer than %.6g us are left out; the shortest "
           "would last %.6g us, where the reference is %.6g",
           low ? "_low" : "", 1e6 * p->dead_s, 1e6 * least_s, low ? range[1] : range[0]);
  return true;
}
