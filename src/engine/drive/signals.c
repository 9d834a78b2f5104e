/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "engine/signals.h"

#include <math.h>

#include "engine/events.h"
#include "engine/gate.h"
#include "engine/pwm.h"

static double mains_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  (void)s;
  return vs_timeline_voltage(t, t_s);
}
static double no_edge(const vs_timeline *t, const vs_signal *s, double t_s) {
  (void)t, (void)s, (void)t_s;
  return INFINITY;
}
static double gate_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_gate_voltage(t, s->shift_rad, t_s);
}
static double gate_edge(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_gate_edge(t, s->shift_rad, t_s);
}
static double burst_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_gate_burst(t, s->shift_rad, t_s) ? vs_gate_voltage(t, s->shift_rad, t_s) : 0;
}
static double burst_edge(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_gate_burst_edge(t, s->shift_rad, t_s);
}
/* The switch that a port of pulse-width modulation drives. */
static vs_pwm_switch switch_of(const vs_signal *s) {
  return (vs_pwm_switch){s->shift_rad, s->drive == VS_PORT_PWM_LOW};
}
static double pwm_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_pwm_is_on(&t->pwm, switch_of(s), t_s) ? 1 : 0;
}
static double pwm_edge(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_pwm_edge(&t->pwm, switch_of(s), t_s);
}
static double event_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  const vs_scene_event *e = &t->events.item[s->event];
  return e->kind->source(e, t_s);
}
static double on_line_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  return vs_scene_event_on_line(&t->events.item[s->event], t_s);
}

/* By VS_PORT_.... */
static const struct drive {
  double (*voltage)(const vs_timeline *timeline, const vs_signal *signal, double t_s);
  double (*edge)(const vs_timeline *timeline, const vs_signal *signal, double t_s);
  bool holds; /* the voltage stays from one edge to the next, of its own or of an event */
} DRIVES[] = {[VS_PORT_MAINS] = {mains_voltage, no_edge, false},
              [VS_PORT_GATE] = {gate_voltage, gate_edge, true},
              [VS_PORT_BURST] = {burst_voltage, burst_edge, true},
              [VS_PORT_PWM] = {pwm_voltage, pwm_edge, true},
              [VS_PORT_PWM_LOW] = {pwm_voltage, pwm_edge, true},
              [VS_PORT_EVENT] = {event_voltage, no_edge, false},
              [VS_PORT_ON_LINE] = {on_line_voltage, no_edge, true}};
_Static_assert(sizeof DRIVES / sizeof *DRIVES == VS_PORT_DRIVES, "a row for each drive of a port");

double vs_signals_voltage(const vs_timeline *t, const vs_signal *s, double t_s) {
  return DRIVES[s->drive].voltage(t, s, t_s);
}

double vs_signals_edge(const vs_timeline *t, const vs_signal *s, double t_s) {
  return DRIVES[s->drive].edge(t, s, t_s);
}

bool vs_signals_holds(const vs_signal *s) {
  return DRIVES[s->drive].holds;
}

/* ---- cached ---- */

/* Edges are told from one another by vs_scene_event_rounding, or by 1e-9 of the time between two of
 * them (engine/drive/generators.c, engine/drive/disturbances.c), which is a period of the mains at
 * most. */
static const double ROUNDINGS = 8, OF_PERIOD = 2e-9;

double vs_signals_near(const vs_timeline *t, double t_s) {
  return fmax(ROUNDINGS * vs_scene_event_rounding(fabs(t_s)), OF_PERIOD * t->period_s);
}

/* What a control decides next is not known, nor when sub-pulses are spared, so that nothing is
 * remembered there. On an edge the voltage still is what it was before it. */
double vs_signals_voltage_cached(vs_signals_cache *h, const vs_timeline *t, const vs_signal *s,
                                 double t_s) {
  if (vs_signals_cache_holds(h, t_s)) return h->number;
  double v = vs_signals_voltage(t, s, t_s);
  if (!vs_signals_holds(s) || t->program || (t->spares && s->drive == VS_PORT_BURST)) return v;
  double near_s = vs_signals_near(t, t_s), before_s = t_s - near_s;
  double edge_s = fmin(vs_signals_edge(t, s, before_s), vs_events_edge(&t->events, before_s));
  *h = (vs_signals_cache){t_s, edge_s - near_s, v};
  return v;
}
