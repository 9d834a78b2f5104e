/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/gate.h"

#include <math.h>

#include "engine/events.h"
#include "engine/firing.h"

/* ---- the train ---- */

/* The leading edge of the n-th pulse (n = 0, 1, ...). It is computed from integers, so that it does
 * not drift over a million cycles. A firing that is left out counts as one at its cycle's
 * beginning, of no length; one that is not decided yet is never. */
static double pulse_start(const vs_timeline *t, double shift_rad, double n) {
  double cycle = t->firing.first_cycle - 1 + n * t->firing.every;
  if (!vs_firing_is_decided(t, n)) return INFINITY;
  double angle_rad = vs_firing_is_even(t) ? t->firing.angle.first : vs_firing_angle(t, n);
  if (isnan(angle_rad)) angle_rad = 0;
  return t->first_zero_s + (cycle + (angle_rad + shift_rad) / (2 * M_PI)) * t->period_s;
}

static bool is_left_out(const vs_timeline *t, double n) {
  return !vs_firing_is_even(t) && vs_firing_is_decided(t, n) && isnan(vs_firing_angle(t, n));
}

/* The number of the last pulse that started before t, where angles differ: that of its cycle, or
 * one of the two before, as a pulse ends less than two firing periods behind its cycle's beginning.
 * The last of these that is no firing left out. */
static double last_of_uneven(const vs_timeline *t, double shift_rad, double before_s) {
  double every_s = t->firing.every * t->period_s;
  double n = every_s > 0 ? floor((before_s - vs_firing_cycle_s(t, 0)) / every_s) : 0;
  while (n >= 0 && !(pulse_start(t, shift_rad, n) < before_s)) n--;
  for (double k = n; k >= fmax(n - 2, 0); k--)
    if (!is_left_out(t, k)) return k;
  return fmax(n, -1);
}

/* The number of the last pulse that started before t, strictly but for rounding; -1: none yet. */
static double last_pulse(const vs_timeline *t, double shift_rad, double t_s) {
  double slack = vs_scene_event_rounding(t_s);
  if (!vs_firing_is_even(t)) return last_of_uneven(t, shift_rad, t_s - slack);
  double since = t_s - pulse_start(t, shift_rad, 0);
  if (since <= slack) return -1;
  if (!t->firing.every) return 0;
  return ceil((since - slack) / (t->firing.every * t->period_s)) - 1;
}

/* The length and the voltage of the n-th pulse, as events leave it. */
static void pulse(const vs_timeline *t, double shift_rad, double n, double *width_s,
                  double *voltage) {
  *width_s = t->firing.pulse_width_s;
  *voltage = 1;
  if (is_left_out(t, n)) *width_s = *voltage = 0;
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_scene_event *e = &t->events.item[k];
    if (e->kind->pulse && e->v.cycle == t->firing.first_cycle + n * t->firing.every &&
        vs_scene_event_at_gate(e, shift_rad))
      e->kind->pulse(e, width_s, voltage);
  }
}

/* As vs_gate_stretch, of the train's pulses alone. */
static bool train_stretch(const vs_timeline *t, double shift_rad, double t_s, double until_s,
                          double *from_s, double *to_s) {
  double width, voltage;
  for (double n = fmax(last_pulse(t, shift_rad, t_s), 0); n == 0 || t->firing.every; n++) {
    double start = pulse_start(t, shift_rad, n);
    if (start >= until_s) return false;
    pulse(t, shift_rad, n, &width, &voltage);
    if (!(voltage > 0) || start + width <= t_s) continue;
    *from_s = fmax(start, t_s);
    *to_s = start + width;
    return true;
  }
  return false;
}

bool vs_gate_stretch(const vs_timeline *t, double shift_rad, double t_s, double until_s,
                     double *from_s, double *to_s) {
  bool found = train_stretch(t, shift_rad, t_s, until_s, from_s, to_s);
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_scene_event *e = &t->events.item[k];
    double from = fmax(e->start_s, t_s);
    if (!e->kind->adds_pulse || e->end_s <= t_s || e->start_s >= until_s ||
        !vs_scene_event_at_gate(e, shift_rad) || (found && *from_s <= from))
      continue;
    found = true;
    *from_s = from;
    *to_s = e->end_s;
  }
  return found;
}

/* The start and the end of a pulse at t that an event adds to the train; the start is -INFINITY
 * where there is none. */
static double added_pulse(const vs_timeline *t, double shift_rad, double t_s, double *end_s) {
  double slack = vs_scene_event_rounding(t_s);
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_scene_event *e = &t->events.item[k];
    *end_s = e->end_s;
    if (e->kind->adds_pulse && t_s > e->start_s + slack && t_s <= e->end_s + slack &&
        vs_scene_event_at_gate(e, shift_rad))
      return e->start_s;
  }
  return -INFINITY;
}

double vs_gate_voltage(const vs_timeline *t, double shift_rad, double t_s) {
  double n = last_pulse(t, shift_rad, t_s), width, voltage, end,
         slack = vs_scene_event_rounding(t_s);
  if (t->events.count && added_pulse(t, shift_rad, t_s, &end) > -INFINITY) return 1;
  if (n < 0) return 0;
  pulse(t, shift_rad, n, &width, &voltage);
  return t_s <= pulse_start(t, shift_rad, n) + width + slack ? voltage : 0;
}

bool vs_gate_is_on(const vs_timeline *t, double shift_rad, double t_s) {
  return vs_gate_voltage(t, shift_rad, t_s) > 0;
}

double vs_gate_of_step(double t0_s, double t1_s) {
  return fmax(t1_s, t0_s + 2 * vs_scene_event_rounding(t1_s));
}

double vs_gate_edge(const vs_timeline *t, double shift_rad, double t_s) {
  double n = last_pulse(t, shift_rad, t_s), slack = vs_scene_event_rounding(t_s), width, voltage;
  double fall = -INFINITY;
  if (n >= 0) pulse(t, shift_rad, n, &width, &voltage), fall = pulse_start(t, shift_rad, n) + width;
  if (fall > t_s + slack) return fall;
  double next = n + 1;
  while (is_left_out(t, next) && t->firing.every) next++;
  double rise = n < 0 || t->firing.every ? pulse_start(t, shift_rad, next) : INFINITY;
  return rise > t_s + slack ? rise : vs_gate_edge(t, shift_rad, t_s + 2 * slack);
}

/* The start of the last sub-pulse that began before t, strictly but for rounding, and the end of
 * its gate pulse. Returns false where t lies in no sub-pulse's period. */
static bool last_sub_pulse(const vs_timeline *t, double shift_rad, double t_s, double *start_s,
                           double *end_s) {
  double n = last_pulse(t, shift_rad, t_s), slack = vs_scene_event_rounding(t_s), width, voltage;
  double start = t->events.count ? added_pulse(t, shift_rad, t_s, end_s) : -INFINITY, k;
  if (start == -INFINITY && n < 0) return false;
  if (start == -INFINITY) {
    pulse(t, shift_rad, n, &width, &voltage);
    start = pulse_start(t, shift_rad, n);
    *end_s = start + width;
  }
  k = ceil((t_s - start - slack) * t->firing.burst_hz) - 1;
  *start_s = start + k / t->firing.burst_hz;
  return *start_s < *end_s - slack;
}

static bool are_spared(const vs_timeline *t) {
  return t->spares && *t->spares;
}

bool vs_gate_burst(const vs_timeline *t, double shift_rad, double t_s) {
  double start, end, slack = vs_scene_event_rounding(t_s);
  return !are_spared(t) && last_sub_pulse(t, shift_rad, t_s, &start, &end) &&
         t_s <= fmin(start + t->firing.burst_duty / t->firing.burst_hz, end) + slack;
}

double vs_gate_burst_edge(const vs_timeline *t, double shift_rad, double t_s) {
  double start, end, slack = vs_scene_event_rounding(t_s);
  if (!are_spared(t) &&
      last_sub_pulse(t, shift_rad, t_s + 2 * slack, &start, &end)) { /* with one that begins at t */
    double fall = fmin(start + t->firing.burst_duty / t->firing.burst_hz, end);
    double rise = start + 1 / t->firing.burst_hz;
    if (fall > t_s + slack) return fall;
    if (rise > t_s + slack && rise < end - slack) return rise;
  }
  /* the next sub-pulse begins with a gate pulse: trailing edges are passed over */
  double edge = vs_gate_edge(t, shift_rad, t_s);
  return vs_gate_is_on(t, shift_rad, edge) ? vs_gate_edge(t, shift_rad, edge) : edge;
}

double vs_gate_next_conduction(const vs_timeline *t, double t_s) {
  double n = last_pulse(t, 0, t_s);
  if (n < 0) n = 0;
  for (;; n++) { /* a pulse that meets no forward voltage is followed by others */
    if (n > 0 && !t->firing.every) return INFINITY;
    double start = pulse_start(t, 0, n), from = fmax(start, t_s);
    double to = start + t->firing.pulse_width_s;
    if (isinf(start)) return INFINITY;
    if (from > to || is_left_out(t, n)) continue;
    double phase = vs_timeline_phase(t, from);
    if (phase < M_PI) return from;
    double zero = from + (2 * M_PI - phase) / t->omega_rad_s;
    if (zero < to) return zero;
  }
}

/* ---- what a watcher sees of it ---- */

void vs_gate_watch_begin(vs_gate_watch *g, const vs_timeline *timeline, const vs_gates *gates) {
  *g = (vs_gate_watch){
      .timeline = timeline, .gates = *gates, .edge_s = -INFINITY, .off_since_s = -INFINITY};
}

void vs_gate_watch_follow(vs_gate_watch *g, double t0_s, double t1_s) {
  g->begins = g->ended = false;
  if (!g->gates.count) {
    g->on = true;
    return;
  }
  if (t1_s < g->edge_s) return;
  bool was = g->on;
  double at_s = vs_gate_of_step(t0_s, t1_s);
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
  if (g->ended) g->off_since_s = t0_s;
}
