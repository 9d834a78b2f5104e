/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/wave.h"

#include <math.h>

#include "engine/gate.h"

double vs_wave_edge(const vs_timeline *t, double t_s) {
  double next = INFINITY;
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_scene_event *e = &t->events.item[k];
    if (e->kind->mains && e->kind->edge) next = fmin(next, e->kind->edge(e, t_s));
  }
  return next;
}

/* Puts the events that are on behind t into the wave, by the stages of engine/timeline.h. What is
 * on is asked for half way to the next edge, where rounding does not matter. */
static void add_disturbances(const vs_timeline *t, double t_s, vs_wave *w) {
  double edge = vs_wave_edge(t, t_s);
  double inside = isinf(edge) ? t_s + t->period_s : t_s + (edge - t_s) / 2;
  double factor = vs_timeline_stage(t, VS_MAINS_FACTOR, inside);
  vs_sine *first = &w->sine[0];
  first->phase_rad += vs_timeline_stage(t, VS_MAINS_ANGLE, inside);
  for (size_t k = 0; k < t->events.count; k++) {
    const vs_scene_event *e = &t->events.item[k];
    if (!e->kind->mains || e->kind->stage != VS_MAINS_ADDED || !vs_scene_event_is_on(e, inside))
      continue;
    int order = e->v.order;
    double phase = remainder(order * first->phase_rad, 2 * M_PI) + e->v.phase_rad;
    vs_sine sine = {factor * e->v.fraction * t->peak_v, order * t->omega_rad_s, phase};
    w->highest_rad_s = fmax(w->highest_rad_s, sine.omega_rad_s);
    w->sine[w->count++] = sine;
  }
  first->peak_v *= factor;
}

/* Direct voltage behind t. Of the events only the factors act on it. */
static void make_direct_wave(const vs_timeline *t, double t_s, vs_wave *w) {
  double edge = vs_wave_edge(t, t_s), inside = isinf(edge) ? t_s + t->period_s : (t_s + edge) / 2;
  w->count = 0;
  w->highest_rad_s = 0;
  w->direct_v = t->peak_v * vs_timeline_stage(t, VS_MAINS_FACTOR, inside);
}

void vs_wave_of(const vs_timeline *t, double t_s, vs_wave *w) {
  if (t->supply.direct) {
    make_direct_wave(t, t_s, w);
    return;
  }
  w->direct_v = 0;
  w->count = 1;
  w->highest_rad_s = t->omega_rad_s;
  w->sine[0] = (vs_sine){t->peak_v, t->omega_rad_s, remainder(vs_timeline_phase(t, t_s), 2 * M_PI)};
  if (t->events.count) add_disturbances(t, t_s, w);
}

void vs_wave_at(const vs_wave *w, double since_s, double u[3]) {
  u[0] = w->direct_v;
  u[1] = u[2] = 0;
  for (size_t k = 0; k < w->count; k++) {
    const vs_sine *s = &w->sine[k];
    double omega = s->omega_rad_s, phase = s->phase_rad + omega * since_s;
    double v = s->peak_v * sin(phase), rate = s->peak_v * omega * cos(phase);
    double bend = -v * omega * omega;
    u[0] = k ? u[0] + v : v;
    u[1] = k ? u[1] + rate : rate;
    u[2] = k ? u[2] + bend : bend;
  }
}

bool vs_wave_is_silent(const vs_wave *w) {
  if (w->direct_v != 0) return false;
  for (size_t k = 0; k < w->count; k++)
    if (w->sine[k].peak_v != 0) return false;
  return true;
}

/* A voltage below this fraction of the sum of all peaks is zero: rounding makes that much of it. */
static const double NONE = 1e-13;

/* As vs_wave_turns, of sense*u > above_v. With u for sense*u - above_v:
 *
 * |u''| never exceeds `bound`, the sum of peak times omega^2. So s behind an instant u is at most
 * u + u' s + bound s^2/2, and up to the zero of that parabola u has none: the search steps there.
 * Near a zero of u these are Newton's steps. A voltage that only touches zero does not turn: at a
 * zero it must rise by more than rounding, and the bound gives the rate that this takes. */
static double turns_above(const vs_wave *w, int sense, double above_v, double since_s,
                          double until_s) {
  double peak = 0, bound = 0, u[3];
  for (size_t k = 0; k < w->count; k++) {
    double omega = w->sine[k].omega_rad_s, of_sine = fabs(w->sine[k].peak_v);
    peak += of_sine;
    bound += of_sine * omega * omega;
  }
  double none = NONE * peak, at = since_s;
  while (peak > 0 && at < until_s) {
    vs_wave_at(w, at, u);
    double v = sense * u[0] - above_v, rate = sense * u[1];
    if (v > none || (v >= -none && rate > sqrt(4 * bound * none))) return at;
    v = fmin(v, -none); /* it falls through zero, or has touched it */
    double root = sqrt(rate * rate - 2 * bound * v);
    at = fmax(at + (rate > 0 ? -2 * v / (root + rate) : (root - rate) / bound),
              nextafter(at, INFINITY));
  }
  return NAN;
}

double vs_wave_turns(const vs_wave *w, int sense, double since_s, double until_s) {
  if (sense * w->direct_v > 0) return since_s < until_s ? since_s : NAN;
  return turns_above(w, sense, 0, since_s, until_s);
}

/* The first instant in [from_s, to_s) from which on the mains, with events, are above `above_v` in
 * that sense; NaN: there is none. */
static double mains_above(const vs_timeline *t, int sense, double above_v, double from_s,
                          double to_s) {
  while (from_s < to_s) {
    double edge = fmin(vs_wave_edge(t, from_s), to_s);
    vs_wave wave;
    vs_wave_of(t, from_s, &wave);
    double since = turns_above(&wave, sense, above_v, 0, edge - from_s);
    if (!isnan(since)) return from_s + since;
    from_s = edge;
  }
  return NAN;
}

double vs_wave_conduction(const vs_timeline *t, double t_s, double until_s) {
  double from, to;
  for (; vs_gate_stretch(t, 0, t_s, until_s, &from, &to); t_s = to) {
    double first = mains_above(t, 1, 0, from, to);
    if (!isnan(first)) return first;
  }
  return INFINITY;
}

double vs_wave_chance(const vs_timeline *t, double shift_rad, double above_v, double until_s) {
  double from, to, t_s = 0;
  for (; vs_gate_stretch(t, shift_rad, t_s, until_s, &from, &to); t_s = to) {
    double end = fmin(to, until_s), first = mains_above(t, 1, above_v, from, end);
    if (shift_rad != 0) first = fmin(first, mains_above(t, -1, above_v, from, end));
    if (!isnan(first)) return first;
  }
  return INFINITY;
}
