/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "event/generators.h"

#include <math.h>
#include <stdio.h>

#include "event/wiring.h"

/* YAML has no bare - as a value: it begins a list. The odd choices are negative. */
#define POLARITY                                                                                   \
  {                                                                                                \
    "polarity", VS_CHOICE, "", "+", 0, 0, false, VS_EVENT_V_(polarity),                            \
        "of the generator; - in quotes: '-'", "+|-|positive|negative", NULL                        \
  }

/* ---- what they have in common ---- */

static double sign(const vs_occurrence *e) {
  return e->v.polarity % 2 ? -1 : 1;
}

/* A step that begins a wave may begin this much before it, s, by the rounding of its instant. */
static const double NEAR_S = 1e-12;

/* The longest step in a wave that began since_s ago: 20 steps for its front, up to 5 of these; 400
 * for its tail, up to 4 of these. */
static double steps_of(double since_s, double front_s, double tail_s) {
  if (since_s < -NEAR_S) return INFINITY;
  return since_s < 5 * front_s ? front_s / 20 : since_s < 4 * tail_s ? tail_s / 400 : INFINITY;
}

/* Puts the generator's source and its connection to the deck's line into the deck. Node
 * `vs_g<index>` is the source's, `vs_l<index>` the one where the coupling capacitor is to end. */
static vs_status at_line(const vs_occurrence *e, size_t index, vs_deck *deck, vs_error *err) {
  char node[VS_DECK_NAME], nodes[2 * VS_DECK_NAME + 1];
  if (!*deck->line[0])
    return vs_fail_at(err, e->where,
                      "events.%s: the deck has no line '*$ line NODE NODE', which says where a %s "
                      "couples in",
                      e->name, e->kind->name);
  snprintf(nodes, sizeof nodes, "%s,%s", deck->line[0], deck->line[1]);
  vs_wiring_line(deck, e->where, "Vvs_s%zu %s vs_l%zu 0", index, deck->line[0], index);
  vs_status status = vs_wiring_loss(deck, e, index, nodes, err);
  if (status) return status;
  snprintf(node, sizeof node, "vs_g%zu", index);
  return vs_wiring_source(deck, e, index, node, deck->line[1], err);
}

/* ---- surge 1.2/50-8/20 us, 2 ohm (IEC 61000-4-5) ----
 * A capacitor of 5.9302 uF, charged to 1.06044 of the level, lies beside 20.154 ohm; then follow
 * 10.871 uH and 0.81412 ohm to the output, across which lie 26.151 ohm; then 18 uF to the line. The
 * network was solved for the standard's front and tail times in open and short circuit. The charge
 * comes as a step of the voltage below the capacitor. */

static const vs_field SURGE[] = {
    VS_EVENT_KIND, VS_EVENT_AT,
    VS_EVENT_LEVEL("1 kV", 0.5, 4, "open-circuit voltage of the generator (IEC 61000-4-5)"),
    POLARITY};

static double surge_source(const vs_occurrence *e, double t_s) {
  return t_s > e->start_s + vs_occurrence_rounding(t_s) ? sign(e) * 1.06044 * e->v.level_v : 0;
}

/* Behind the wave the mains' inductance rings with the 18 uF, at some kHz and tens of amperes: a
 * step of 5 us there leaves 1 mJ in the energy audit, by h di dv/12 of that inductance. */
static double surge_longest(const vs_occurrence *e, double t_s) {
  double since = t_s - e->start_s, rings = since >= 0 && since < 600e-6 ? 2e-6 : INFINITY;
  return fmin(steps_of(since, 1.2e-6, 50e-6), rings);
}

static vs_status surge_wire(const vs_occurrence *e, size_t k, vs_deck *deck, vs_error *err) {
  vs_status status = at_line(e, k, deck, err);
  if (status) return status;
  const char *back = deck->line[1];
  vs_wiring_line(deck, e->where, "Cvs_g%zu vs_g%zu vs_h%zu 5.9302u ic=0", k, k, k);
  vs_wiring_line(deck, e->where, "Rvs_g%zu vs_h%zu %s 20.154", k, k, back);
  vs_wiring_line(deck, e->where, "Lvs_g%zu vs_h%zu vs_i%zu 10.871u ic=0", k, k, k);
  vs_wiring_line(deck, e->where, "Rvs_i%zu vs_i%zu vs_o%zu 0.81412", k, k, k);
  vs_wiring_line(deck, e->where, "Rvs_o%zu vs_o%zu %s 26.151", k, k, back);
  vs_wiring_line(deck, e->where, "Cvs_o%zu vs_o%zu vs_l%zu 18u ic=0", k, k, k);
  return VS_OK;
}

/* ---- ring wave 0.5 us - 100 kHz (IEEE C62.41) ----
 * The wave lies behind the generator's impedance; 18 uF to the line are assumed. */

static const vs_field RING_WAVE[] = {
    VS_EVENT_KIND,
    VS_EVENT_AT,
    VS_EVENT_LEVEL("1 kV", 0.25, 6, "open-circuit peak of the generator (IEEE C62.41)"),
    POLARITY,
    {"impedance", VS_REAL, "ohm", "12 ohm", 12, 200, false, VS_EVENT_V_(impedance_ohm),
     "of the generator", NULL, NULL}};

double vs_generators_ring_source(const vs_occurrence *e, double t_s) {
  double t_us = 1e6 * (t_s - e->start_s);
  if (t_us <= 0 || t_us > 300) return 0; /* 5e-14 of the peak */
  return sign(e) * e->v.level_v * 1.590 * (1 - exp(-t_us / 0.533)) * exp(-t_us / 9.788) *
         cos(2 * M_PI * 0.1 * t_us);
}

static double ring_longest(const vs_occurrence *e, double t_s) {
  return steps_of(t_s - e->start_s, 0.5e-6, 10e-6);
}

static vs_status ring_wire(const vs_occurrence *e, size_t k, vs_deck *deck, vs_error *err) {
  vs_status status = at_line(e, k, deck, err);
  if (status) return status;
  vs_wiring_line(deck, e->where, "Rvs_g%zu vs_g%zu vs_o%zu %.17g", k, k, k, e->v.impedance_ohm);
  vs_wiring_line(deck, e->where, "Cvs_o%zu vs_o%zu vs_l%zu 18u ic=0", k, k, k);
  return VS_OK;
}

/* ---- burst of 5/50 ns pulses (IEC 61000-4-4) ----
 * The pulses lie behind 50 ohm; 33 nF to the line, as the standard's coupling network has. */

static const vs_field EFT[] = {
    VS_EVENT_KIND,
    VS_EVENT_AT,
    VS_EVENT_LEVEL("1 kV", 0.25, 4, "open-circuit peak of the generator (IEC 61000-4-4)"),
    POLARITY,
    {"frequency", VS_REAL, "kHz", "5 kHz", 1, 100, false, VS_EVENT_V_(frequency_hz),
     "of the pulses", NULL, NULL},
    VS_EVENT_DURATION("15 ms")};

/* The standard's pulse with a peak of 1; t in ns. */
static double eft_pulse(double t_ns) {
  const double v1 = 0.92, rise = 3.5, fall = 51, n = 1.8;
  double scale = exp(-rise / fall * pow(n * fall / rise, 1 / n));
  double x = pow(t_ns / rise, n);
  return t_ns > 0 ? v1 / scale * x / (1 + x) * exp(-t_ns / fall) : 0;
}

/* Time since the last pulse of the burst began, s; negative: none did. A pulse that begins within
 * NEAR_S counts: the step from there on is its first. */
static double since_pulse(const vs_occurrence *e, double t_s) {
  double n = floor((t_s - e->start_s + NEAR_S) * e->v.frequency_hz);
  double most = ceil(e->v.duration_s * e->v.frequency_hz) - 1;
  return n < 0 ? -1 : t_s - e->start_s - fmin(n, most) / e->v.frequency_hz;
}

/* 2 us are 39 time constants of a pulse's fall. */
double vs_generators_eft_source(const vs_occurrence *e, double t_s) {
  double since = since_pulse(e, t_s);
  return since > 0 && since < 2e-6 ? sign(e) * e->v.level_v * eft_pulse(1e9 * since) : 0;
}

double vs_generators_eft_edge(const vs_occurrence *e, double t_s) {
  /* 1e-9 of a period: an edge reached is passed */
  double n = t_s < e->start_s ? 0 : floor((t_s - e->start_s) * e->v.frequency_hz + 1e-9) + 1;
  return n / e->v.frequency_hz < e->v.duration_s ? e->start_s + n / e->v.frequency_hz : INFINITY;
}

static double eft_longest(const vs_occurrence *e, double t_s) {
  return steps_of(since_pulse(e, t_s), 5e-9, 50e-9);
}

static vs_status eft_wire(const vs_occurrence *e, size_t k, vs_deck *deck, vs_error *err) {
  vs_status status = at_line(e, k, deck, err);
  if (status) return status;
  vs_wiring_line(deck, e->where, "Rvs_g%zu vs_g%zu vs_o%zu 50", k, k, k);
  vs_wiring_line(deck, e->where, "Cvs_o%zu vs_o%zu vs_l%zu 33n ic=0", k, k, k);
  return VS_OK;
}

/* ---- the kinds ---- */

const vs_event_kind vs_generators[] = {
    {"surge", "1.2/50-8/20 us generator of IEC 61000-4-5 from line to line, through 18 uF",
     VS_EVENT_KEYS(SURGE), .edge = vs_occurrence_edge, .longest = surge_longest, .wire = surge_wire,
     .source = surge_source},
    {"ring_wave", "100 kHz ring wave of IEEE C62.41 from line to line", VS_EVENT_KEYS(RING_WAVE),
     .edge = vs_occurrence_edge, .longest = ring_longest, .wire = ring_wire,
     .source = vs_generators_ring_source},
    {"eft", "burst of 5/50 ns pulses of IEC 61000-4-4", VS_EVENT_KEYS(EFT),
     .edge = vs_generators_eft_edge, .longest = eft_longest, .wire = eft_wire,
     .source = vs_generators_eft_source},
    {.name = NULL}};
