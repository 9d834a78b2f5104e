/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "spice_sources.h"

#include <math.h>
#include <stdio.h>

#include "engine/gate.h"
#include "engine/signals.h"

/* ---- gates ---- */

/* Edges of 10 ns cost 1e-5 of the first peak; in shorter ones ngspice may fail to step (1 ns: one
 * scene of fifty, with a diode in its deck; 0.1 ns and below: that one always). */
static const double EDGE_S = 1e-8;

/* The beginning of the first pulse of a train that ends behind t = 0, as an expression:
 * ngspice aborts a run that has an edge of it there. A train's own first pulse lies up to a cycle
 * before t = 0. A single one that is over then moves beyond the end of the run. */
static void add_delay(vs_text *t, double turns, const char *width, const char *period) {
  char own[64];
  snprintf(own, sizeof own, "vs_fire+%.17g/f_mains", turns);
  vs_text_add(t, "%s+%s*max(0,-floor((%s+%s-1n)/%s))", own, period, own, width, period);
}

static void add_gate_delay(vs_text *t, double turns) {
  add_delay(t, turns, "vs_pulse", "vs_period");
}

void vs_spice_sources_timing(vs_text *t, const vs_timeline *timeline, const vs_deck *deck) {
  const double turn = 2 * M_PI;
  size_t gates = 0;
  vs_text_add(t, "* first rising zero of the mains, first pulse, period and edges of the pulses\n");
  vs_text_add(t, ".param vs_zero={(-phase/%.17g-floor(-phase/%.17g))/f_mains}\n", turn, turn);
  if (timeline->firing.no_valve)
    vs_text_add(t, ".param vs_fire=0\n");
  else
    vs_text_add(t, ".param vs_fire={vs_zero+(vs_first-1+vs_angle/%.17g)/f_mains}\n", turn);
  vs_text_add(t, ".param vs_period={vs_every>0 ? vs_every/f_mains : "
                 "vs_until+vs_pulse+1+1/f_mains}\n");
  vs_text_add(t, ".param vs_edge={min(1e-8,vs_pulse/10)}\n");
  vs_text_add(t, ".param vs_burst_edge={min(1e-8,vs_burst_duty/vs_burst/10)}\n");
  vs_text_add(t, "* the first pulse at any gate that does not end before t = 0\n.param vs_fired={");
  for (size_t k = 0; k < deck->n_ports; k++) {
    if (!vs_port_is_gated(&deck->ports[k].signal)) continue;
    vs_text_add(t, gates++ ? ",min(" : "min(");
    add_gate_delay(t, deck->ports[k].signal.shift_rad / turn);
  }
  vs_text_add(t, gates ? ",vs_until" : "vs_fire");
  while (gates--) vs_text_add(t, ")");
  vs_text_add(t, "}\n");
}

static void add_pulses(vs_text *t, const char *name, const char *nodes, double turns) {
  vs_text_add(t, "%s %s PULSE(0 1 {", name, nodes);
  add_gate_delay(t, turns);
  vs_text_add(t, "} {vs_edge} {vs_edge} {vs_pulse-vs_edge} {vs_period})\n");
}

static void write_gate(vs_text *t, const vs_spice_sources_source *s, const vs_timeline *timeline,
                       double until_s) {
  char nodes[2 * VS_DECK_NAME];
  (void)timeline, (void)until_s;
  snprintf(nodes, sizeof nodes, "%s %s", s->plus, s->minus);
  add_pulses(t, s->name, nodes, s->signal->shift_rad / (2 * M_PI));
}

/* Sub-pulses: those of one endless train that fall into a gate pulse. */
static void write_burst(vs_text *t, const vs_spice_sources_source *s, const vs_timeline *timeline,
                        double until_s) {
  char source[2 * VS_DECK_NAME], node[2 * VS_DECK_NAME];
  const char *name = s->name;
  double turns = s->signal->shift_rad / (2 * M_PI);
  (void)timeline, (void)until_s;
  snprintf(source, sizeof source, "Vvs_w_%s", name);
  snprintf(node, sizeof node, "vs_w_%s 0", name);
  add_pulses(t, source, node, turns);
  vs_text_add(t, "Vvs_b_%s vs_b_%s 0 PULSE(0 1 {", name, name);
  add_delay(t, turns, "vs_burst_duty/vs_burst", "(1/vs_burst)");
  vs_text_add(t,
              "} {vs_burst_edge} {vs_burst_edge} {vs_burst_duty/vs_burst-vs_burst_edge} "
              "{1/vs_burst})\n"
              "Bvs_%s vs_%s %s V = v(vs_w_%s)*v(vs_b_%s)\n%s %s vs_%s 0\n",
              name, name, s->minus, name, name, name, s->plus, name);
}

/* ---- mains ---- */

static void write_mains(vs_text *t, const vs_spice_sources_source *s, const vs_timeline *timeline,
                        double until_s) {
  (void)until_s;
  if (timeline->supply.direct)
    vs_text_add(t, "%s %s %s {u_rms}\n", s->name, s->plus, s->minus);
  else
    vs_text_add(t, "%s %s %s SIN(0 {sqrt(2)*u_rms} {f_mains} 0 0 {phase*%.17g})\n", s->name,
                s->plus, s->minus, 180 / M_PI);
}

/* ---- modulated switches ---- */

/* The signal's first edge after t at which it changes; INFINITY: none up to until_s. */
static double next_change(const vs_timeline *timeline, const vs_signal *s, double t_s,
                          double until_s) {
  double before = vs_signals_voltage(timeline, s, vs_gate_of_step(t_s, t_s));
  for (double at_s = t_s; at_s <= until_s;) {
    at_s = vs_signals_edge(timeline, s, at_s);
    if (vs_signals_voltage(timeline, s, vs_gate_of_step(at_s, at_s)) != before) return at_s;
  }
  return INFINITY;
}

static bool is_even(const vs_pwm_values *p) {
  return p->depth == 0 && !p->duty.count;
}

/* Pulses that are all alike, as PULSE from the first edge behind t = 0. */
static void write_even(vs_text *t, const vs_timeline *timeline, const vs_signal *s, double first_s,
                       int level) {
  double period_s = 1 / timeline->pwm.carrier_hz, second_s = next_change(timeline, s, first_s, 1e9);
  double edge_s = fmin(EDGE_S, fmin(second_s - first_s, first_s + period_s - second_s) / 10);
  vs_text_add(t, " PULSE(%d %d %.17g %.17g %.17g %.17g %.17g)\n", level, 1 - level, first_s, edge_s,
              edge_s, second_s - first_s - edge_s, period_s);
}

/* Pulses that differ, edge by edge. An edge takes EDGE_S, or a tenth of a shorter pulse. */
static void write_edges(vs_text *t, const vs_timeline *timeline, const vs_signal *s, double until_s,
                        int level) {
  double at_s = next_change(timeline, s, 0, until_s);
  vs_text_add(t, " PWL(0 %d", level);
  for (; at_s < until_s; level = 1 - level) {
    double next_s = next_change(timeline, s, at_s, until_s);
    vs_text_add(t, "\n+ %.15g %d %.15g %d", at_s, level, at_s + fmin(EDGE_S, (next_s - at_s) / 10),
                1 - level);
    at_s = next_s;
  }
  vs_text_add(t, ")\n");
}

static void write_modulated(vs_text *t, const vs_spice_sources_source *s,
                            const vs_timeline *timeline, double until_s) {
  const vs_signal *signal = s->signal;
  int level = vs_signals_voltage(timeline, signal, vs_gate_of_step(0, 0)) > 0;
  double first_s = next_change(timeline, signal, 0, until_s);
  vs_text_add(t, "%s %s %s", s->name, s->plus, s->minus);
  if (isinf(first_s))
    vs_text_add(t, " %d\n", level);
  else if (is_even(&timeline->pwm))
    write_even(t, timeline, signal, first_s, level);
  else
    write_edges(t, timeline, signal, until_s, level);
}

/* ---- all ---- */

/* By VS_PORT_.... Events are not exported. */
static void (*const WRITERS[])(vs_text *, const vs_spice_sources_source *, const vs_timeline *,
                               double) = {[VS_PORT_MAINS] = write_mains,
                                          [VS_PORT_GATE] = write_gate,
                                          [VS_PORT_BURST] = write_burst,
                                          [VS_PORT_PWM] = write_modulated,
                                          [VS_PORT_PWM_LOW] = write_modulated};
_Static_assert(sizeof WRITERS / sizeof *WRITERS == VS_PORT_EVENT, "a row for each port of a deck");

void vs_spice_sources_write(vs_text *t, const vs_spice_sources_source *s,
                            const vs_timeline *timeline, double until_s) {
  WRITERS[s->signal->drive](t, s, timeline, until_s);
}

/* What plain ngspice should be given at most. It looks for its place in a list of points from the
 * beginning on, at each step. */
enum { MOST_EDGES = 20000 };

/* Error: the edges of one port are too many. */
static vs_status check_edges(const vs_timeline *t, const vs_deck *deck, double until_s,
                             vs_error *err) {
  double edges = 2 * t->pwm.carrier_hz * until_s;
  if (is_even(&t->pwm) || edges <= MOST_EDGES || !vs_deck_has_port(deck, vs_port_is_modulated))
    return VS_OK;
  return vs_fail(err, VS_INPUT,
                 "export: pwm: the reference is not constant, and each of its edges is written: "
                 "%.0f up to run.until = %g s; allowed: %d, so run.until of at most %.3g s, or "
                 "pwm.depth: 0",
                 edges, until_s, MOST_EDGES, MOST_EDGES / (2 * t->pwm.carrier_hz));
}

/* The exported train of pulses has one angle, and its sub-pulses keep their phase from gate pulse
 * to gate pulse. */
vs_status vs_spice_sources_check(const vs_timeline *timeline, const vs_deck *deck, double until_s,
                                 vs_error *err) {
  const vs_firing_values *f = &timeline->firing;
  if (f->angle.count)
    return vs_fail(err, VS_INPUT,
                   "export: firing.angle: a table over time cannot be exported; write one angle");
  double n = f->burst_hz * f->every * timeline->period_s;
  for (size_t k = 0; k < deck->n_ports; k++)
    if (deck->ports[k].signal.drive == VS_PORT_BURST && fabs(n - rint(n)) > 1e-6 * (n + 1))
      return vs_fail(err, VS_INPUT,
                     "export: firing.burst_frequency: the time from gate pulse to gate pulse must "
                     "be a whole number of sub-pulses (it is %.9g)",
                     n);
  return check_edges(timeline, deck, until_s, err);
}
