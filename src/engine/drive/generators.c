/* SPDX-License-Identifier: GPL-3.0-or-later
 * Kinds of events that are generators of a standard, coupled to the deck's line ('*$ line NODE
 * NODE'): surge, ring wave, fast transients. Several may come together, and closer than their waves
 * last: each is one of its own, with a network of its own on the line, which loads the others'
 * waves; a run warns of that (run/warnings.c). */
#include "engine/scene_event.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include "drive/wiring.h"
#include "netlist/cards.h"

/* YAML has no bare - as a value: it begins a list. The odd choices are negative. */
#define POLARITY                                                                                   \
  {                                                                                                \
    "polarity", VS_CHOICE, "", "+", 0, 0, false, VS_EVENT_V_(polarity),                            \
        "of the generator; - in quotes: '-'", "+|-|positive|negative", NULL                        \
  }
/* How it is coupled, from when on, and how often: the last rows of each table. `times` and `every`
 * change no wave: the run has one pulse. */
#define COUPLED(text)                                                                              \
  {"coupling", VS_CHOICE, "", "line", 0, 0, false, VS_EVENT_V_(earth), text, "line|earth", NULL},  \
      {"from",                                                                                     \
       VS_NAME,                                                                                    \
       "",                                                                                         \
       "start",                                                                                    \
       0,                                                                                          \
       0,                                                                                          \
       false,                                                                                      \
       VS_EVENT_V_(from),                                                                          \
       "since when its network lies on the line: start of the run, strike (with the wave), or a "  \
       "time",                                                                                     \
       NULL,                                                                                       \
       NULL},                                                                                      \
      {"times",                                                                                    \
       VS_COUNT,                                                                                   \
       "",                                                                                         \
       "1",                                                                                        \
       1,                                                                                          \
       1e6,                                                                                        \
       false,                                                                                      \
       VS_EVENT_V_(times),                                                                         \
       "how often the run with this pulse comes; one is simulated, heat adds up",                  \
       NULL,                                                                                       \
       NULL},                                                                                      \
  {                                                                                                \
    "every", VS_REAL, "s", "60 s", 0, 1e9, true, VS_EVENT_V_(every_s),                             \
        "from one of them to the next", NULL, NULL                                                 \
  }

/* ---- what they have in common ---- */

static double sign(const vs_scene_event *e) {
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

/* When the network comes onto the line, and when the wave begins. */
static double wave_edge(const vs_scene_event *e, double t_s) {
  double start_s = vs_scene_event_edge(e, t_s);
  return t_s < e->on_line_s ? fmin(e->on_line_s, start_s) : start_s;
}

/* ---- the way to the line ----
 * A generator's network lies between the line's first node and its return: the line's second node,
 * or the earth. From line to line 18 uF couple it, from line to earth 9 uF and 10 ohm in series
 * (IEC 61000-4-5). For a surge that is the standard's; for a ring wave it is assumed; fast
 * transients have 33 nF both ways. */

static const char *return_of(const vs_scene_event *e, const vs_deck *deck) {
  return e->v.earth ? deck->earth : deck->line[1];
}

/* True where an element of the deck has a node of that name, or it is ground. */
static bool names_node(const vs_deck *deck, const char *node) {
  const vs_cards *c = vs_deck_cards(deck);
  bool names = vs_words_is_ground(vs_words_of(node));
  for (size_t k = 0; k < c->count && !names; k++)
    names =
        c->card[k].kind == VS_CARDS_ELEMENT && vs_cards_has_node(c, &c->card[k], vs_words_of(node));
  return names;
}

/* Error: the deck does not say where the generator couples in, or names a node there that it does
 * not have. */
static vs_status check_line(const vs_scene_event *e, const vs_deck *deck, vs_error *err) {
  if (!*deck->line[0])
    return vs_fail_at(err, e->where,
                      "events.%s: the deck has no line '*$ line NODE NODE', which says where a %s "
                      "couples in",
                      e->name, e->kind->name);
  if (e->v.earth && !*deck->earth)
    return vs_fail_at(err, e->where,
                      "events.%s.coupling: the deck has no line '*$ earth NODE', which says which "
                      "node is the earth; give it one, or take coupling: line",
                      e->name);
  for (int n = 0; n < 3; n++) {
    const char *node = n < 2 ? deck->line[n] : deck->earth;
    if (!*node || (n == 2 && !e->v.earth) || names_node(deck, node)) continue;
    return vs_fail_at(
        err, e->where,
        "events.%s: the deck's line '*$ %s' names the node '%s', and no element of the "
        "deck has it",
        e->name, n < 2 ? "line" : "earth", node);
  }
  if (e->v.earth && !strcasecmp(deck->earth, deck->line[0]))
    return vs_fail_at(err, e->where,
                      "events.%s.coupling: '*$ earth %s' is the node of '*$ line'; another one is "
                      "wanted, or coupling: line",
                      e->name, deck->earth);
  return VS_OK;
}

/* Brings the network onto the line in the midst of a run, at node vs_k<index>. Up to then it is
 * without current and charge, and 1 fF holds the line's voltage. From then on this voltage lies in
 * series with the coupling capacitor, as if that had been charged to it: so no current flows
 * because of the switch alone, and the line does not jump. The 10 uohm of the closed switch are a
 * hundred thousandth of what follows. 1 fF is little enough to leave ngspice's steps alone: its
 * charge at 1 V is what an error of a charge does not matter below (engine/coupled/pace.c). */
static vs_status switch_on(const vs_scene_event *e, size_t k, vs_deck *deck, vs_error *err) {
  const char *back = return_of(e, deck);
  vs_status status = vs_wiring_on_line(deck, e, k, err);
  if (status) return status;
  vs_wiring_line(deck, e->where,
                 "Bvs_m%zu 0 vs_m%zu I = v(vs_w%zu) > 0.5 ? 0 : v(vs_l%zu,%s)-v(vs_m%zu)", k, k, k,
                 k, back, k);
  vs_wiring_line(deck, e->where, "Cvs_m%zu vs_m%zu 0 1f ic=0", k, k);
  vs_wiring_line(deck, e->where,
                 "Bvs_k%zu vs_l%zu vs_k%zu I = v(vs_w%zu) > 0.5 ? "
                 "1e5*(v(vs_l%zu,vs_k%zu)-v(vs_m%zu)) : 0",
                 k, k, k, k, k, k, k);
  return VS_OK;
}

/* Puts the generator's source and its connection to the deck's line into the deck. Node vs_g<index>
 * is the source's. */
static vs_status at_line(const vs_scene_event *e, size_t k, vs_deck *deck, vs_error *err) {
  char node[VS_DECK_NAME], nodes[2 * VS_DECK_NAME + 1];
  vs_status status = check_line(e, deck, err);
  if (status) return status;
  const char *back = return_of(e, deck);
  snprintf(nodes, sizeof nodes, "%s,%s", deck->line[0], back);
  vs_wiring_line(deck, e->where, "Vvs_s%zu %s vs_l%zu 0", k, deck->line[0], k);
  status = vs_wiring_loss(deck, e, k, nodes, err);
  if (!status && e->on_line_s > 0) status = switch_on(e, k, deck, err);
  if (status) return status;
  snprintf(node, sizeof node, "vs_g%zu", k);
  return vs_wiring_source(deck, e, k, node, back, err);
}

/* What a generator is coupled by; in the units of a netlist. */
typedef struct coupling {
  const char *capacitor[2];   /* of coupling: line, earth */
  const char *earth_resistor; /* in series with the latter; NULL: none */
} coupling;

/* Puts the coupling between the generator's output, node vs_o<index>, and what at_line has put
 * there. */
static void couple(const vs_scene_event *e, size_t k, vs_deck *deck, const coupling *by) {
  const char end = e->on_line_s > 0 ? 'k' : 'l';
  bool resists = e->v.earth && by->earth_resistor;
  if (resists)
    vs_wiring_line(deck, e->where, "Rvs_q%zu vs_o%zu vs_q%zu %s", k, k, k, by->earth_resistor);
  vs_wiring_line(deck, e->where, "Cvs_o%zu vs_%c%zu vs_%c%zu %s ic=0", k, resists ? 'q' : 'o', k,
                 end, k, by->capacitor[e->v.earth]);
}

static const coupling OF_SURGES = {{"18u", "9u"}, "10"}, OF_BURSTS = {{"33n", "33n"}, NULL};

/* ---- surge 1.2/50-8/20 us, 2 ohm (IEC 61000-4-5) ----
 * A capacitor of 5.9302 uF, charged to 1.06044 of the level, is switched onto 20.154 ohm; then
 * follow 10.871 uH and 0.81412 ohm to the output, across which lie 26.151 ohm; then the coupling.
 * The network was solved for the standard's front and tail times in open and short circuit.
 *
 * The charge is a voltage below the capacitor. Up to the strike the voltage is 0, and the capacitor
 * is cut off: what the mains drive through the rest does not reach it. A capacitor that was charged
 * before behaves alike. The voltage itself closes the switch, of 10 uohm, and it stays closed. */

static const vs_field SURGE[] = {
    VS_EVENT_KIND, VS_EVENT_AT,
    VS_EVENT_LEVEL("1 kV", 0.5, 4, "open-circuit voltage of the generator (IEC 61000-4-5)"),
    POLARITY, COUPLED("line to line, 18 uF; line to earth, 9 uF and 10 ohm")};

static double surge_source(const vs_scene_event *e, double t_s) {
  return t_s > e->start_s + vs_scene_event_rounding(t_s) ? sign(e) * 1.06044 * e->v.level_v : 0;
}

/* Behind the wave the mains' inductance rings with the 18 uF, at some kHz and tens of amperes: a
 * step of 5 us there leaves 1 mJ in the energy audit, by h di dv/12 of that inductance. */
static double surge_longest(const vs_scene_event *e, double t_s) {
  double since = t_s - e->start_s, rings = since >= 0 && since < 600e-6 ? 2e-6 : INFINITY;
  return fmin(steps_of(since, 1.2e-6, 50e-6), rings);
}

static vs_status surge_wire(const vs_scene_event *e, size_t k, vs_deck *deck, vs_error *err) {
  vs_status status = at_line(e, k, deck, err);
  if (status) return status;
  const char *back = return_of(e, deck);
  vs_wiring_line(deck, e->where, "Cvs_g%zu vs_g%zu vs_c%zu 5.9302u ic=0", k, k, k);
  vs_wiring_line(deck, e->where,
                 "Bvs_c%zu vs_c%zu vs_h%zu I = abs(v(vs_g%zu,%s)) > 1 ? 1e5*v(vs_c%zu,vs_h%zu) : 0",
                 k, k, k, k, back, k, k);
  vs_wiring_line(deck, e->where, "Rvs_g%zu vs_h%zu %s 20.154", k, k, back);
  vs_wiring_line(deck, e->where, "Lvs_g%zu vs_h%zu vs_i%zu 10.871u ic=0", k, k, k);
  vs_wiring_line(deck, e->where, "Rvs_i%zu vs_i%zu vs_o%zu 0.81412", k, k, k);
  vs_wiring_line(deck, e->where, "Rvs_o%zu vs_o%zu %s 26.151", k, k, back);
  couple(e, k, deck, &OF_SURGES);
  return VS_OK;
}

static void surge_network(const vs_scene_event *e, char *text, size_t size) {
  snprintf(text, size, e->v.earth ? "9 uF + 10 ohm + 2 ohm" : "18 uF + 2 ohm");
}

/* ---- ring wave 0.5 us - 100 kHz (IEEE C62.41, IEC 61000-4-12) ----
 * The open-circuit wave is an ideal source behind the generator's impedance, which lies on the line
 * with the coupling. Before and behind the wave the source has 0 V. So the mains add to the wave
 * and do not change it. */

static const vs_field RING_WAVE[] = {
    VS_EVENT_KIND,
    VS_EVENT_AT,
    VS_EVENT_LEVEL("1 kV", 0.25, 6, "open-circuit peak of the generator (IEEE C62.41)"),
    POLARITY,
    {"impedance", VS_REAL, "ohm", "12 ohm", 12, 200, false, VS_EVENT_V_(impedance_ohm),
     "of the generator", NULL, NULL},
    COUPLED("line to line, 18 uF; line to earth, 9 uF and 10 ohm (all assumed)")};

/* Open-circuit voltage, V, per volt of its level: 1.590 (1 - exp(-t/0.533 us)) exp(-t/9.788 us)
 * cos(2 pi 100 kHz t). */
static double ring_source(const vs_scene_event *e, double t_s) {
  double t_us = 1e6 * (t_s - e->start_s);
  if (t_us <= 0 || t_us > 300) return 0; /* 5e-14 of the peak */
  return sign(e) * e->v.level_v * 1.590 * (1 - exp(-t_us / 0.533)) * exp(-t_us / 9.788) *
         cos(2 * M_PI * 0.1 * t_us);
}

static double ring_longest(const vs_scene_event *e, double t_s) {
  return steps_of(t_s - e->start_s, 0.5e-6, 10e-6);
}

static vs_status ring_wire(const vs_scene_event *e, size_t k, vs_deck *deck, vs_error *err) {
  vs_status status = at_line(e, k, deck, err);
  if (status) return status;
  vs_wiring_line(deck, e->where, "Rvs_g%zu vs_g%zu vs_o%zu %.17g", k, k, k, e->v.impedance_ohm);
  couple(e, k, deck, &OF_SURGES);
  return VS_OK;
}

static void ring_network(const vs_scene_event *e, char *text, size_t size) {
  snprintf(text, size, "%s + %.6g ohm", e->v.earth ? "9 uF + 10 ohm" : "18 uF", e->v.impedance_ohm);
}

/* ---- burst of 5/50 ns pulses (IEC 61000-4-4) ----
 * The pulses are an ideal source behind 50 ohm; 33 nF to the line, as the standard's coupling
 * network has. Between pulses the source has 0 V. At 50 Hz the mains drive some milliamperes
 * through 33 nF, whatever lies behind these. */

static const vs_field EFT[] = {
    VS_EVENT_KIND,
    VS_EVENT_AT,
    VS_EVENT_LEVEL("1 kV", 0.25, 4, "open-circuit peak of the generator (IEC 61000-4-4)"),
    POLARITY,
    {"frequency", VS_REAL, "kHz", "5 kHz", 1, 100, false, VS_EVENT_V_(frequency_hz),
     "of the pulses", NULL, NULL},
    VS_EVENT_DURATION("15 ms"),
    COUPLED("line to line, or line to earth, 33 nF")};

/* The standard's pulse with a peak of 1; t in ns. */
static double eft_pulse(double t_ns) {
  const double v1 = 0.92, rise = 3.5, fall = 51, n = 1.8;
  double scale = exp(-rise / fall * pow(n * fall / rise, 1 / n));
  double x = pow(t_ns / rise, n);
  return t_ns > 0 ? v1 / scale * x / (1 + x) * exp(-t_ns / fall) : 0;
}

/* Time since the last pulse of the burst began, s; negative: none did. A pulse that begins within
 * NEAR_S counts: the step from there on is its first. */
static double since_pulse(const vs_scene_event *e, double t_s) {
  double n = floor((t_s - e->start_s + NEAR_S) * e->v.frequency_hz);
  double most = ceil(e->v.duration_s * e->v.frequency_hz) - 1;
  return n < 0 ? -1 : t_s - e->start_s - fmin(n, most) / e->v.frequency_hz;
}

/* Open-circuit voltage, V, by the equation of the pulse that IEC 61000-4-4 gives. 2 us are 39 time
 * constants of a pulse's fall. */
static double eft_source(const vs_scene_event *e, double t_s) {
  double since = since_pulse(e, t_s);
  return since > 0 && since < 2e-6 ? sign(e) * e->v.level_v * eft_pulse(1e9 * since) : 0;
}

/* The beginning of the burst's first pulse after t; INFINITY: none. */
static double next_eft_pulse(const vs_scene_event *e, double t_s) {
  /* 1e-9 of a period: an edge reached is passed */
  double n = t_s < e->start_s ? 0 : floor((t_s - e->start_s) * e->v.frequency_hz + 1e-9) + 1;
  return n / e->v.frequency_hz < e->v.duration_s ? e->start_s + n / e->v.frequency_hz : INFINITY;
}

static double eft_longest(const vs_scene_event *e, double t_s) {
  return steps_of(since_pulse(e, t_s), 5e-9, 50e-9);
}

/* The same, and when the network comes onto the line. */
static double eft_edge(const vs_scene_event *e, double t_s) {
  double pulse_s = next_eft_pulse(e, t_s);
  return t_s < e->on_line_s ? fmin(e->on_line_s, pulse_s) : pulse_s;
}

static vs_status eft_wire(const vs_scene_event *e, size_t k, vs_deck *deck, vs_error *err) {
  vs_status status = at_line(e, k, deck, err);
  if (status) return status;
  vs_wiring_line(deck, e->where, "Rvs_g%zu vs_g%zu vs_o%zu 50", k, k, k);
  couple(e, k, deck, &OF_BURSTS);
  return VS_OK;
}

static void eft_network(const vs_scene_event *e, char *text, size_t size) {
  (void)e;
  snprintf(text, size, "33 nF + 50 ohm");
}

/* ---- the kinds ---- */

const vs_event_kind vs_generators[] = {
    {"surge", "1.2/50-8/20 us generator of IEC 61000-4-5", VS_EVENT_KEYS(SURGE), .edge = wave_edge,
     .longest = surge_longest, .wire = surge_wire, .source = surge_source,
     .network = surge_network},
    {"ring_wave", "100 kHz ring wave of IEEE C62.41", VS_EVENT_KEYS(RING_WAVE), .edge = wave_edge,
     .longest = ring_longest, .wire = ring_wire, .source = ring_source, .network = ring_network},
    {"eft", "burst of 5/50 ns pulses of IEC 61000-4-4", VS_EVENT_KEYS(EFT), .edge = eft_edge,
     .longest = eft_longest, .wire = eft_wire, .source = eft_source, .network = eft_network},
    {.name = NULL}};
