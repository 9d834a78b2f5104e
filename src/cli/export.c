/* SPDX-License-Identifier: GPL-3.0-or-later
 * The netlist of `vibrospice export`: parameters, the deck with sources of its own, the machine
 * (export_machine.h), the analysis, and commands that measure. Whatever {expression} a B source
 * holds stands in brackets: ngspice pastes it as text. */
#include "export.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

#include "base/file.h"
#include "base/text.h"
#include "base/units.h"
#include "commands.h"
#include "engine/gate.h"
#include "engine/pace.h"
#include "engine/signals.h"
#include "engine/timeline.h"
#include "export_fmu.h"
#include "export_machine.h"
#include "measure/measures.h"
#include "netlist/deck.h"
#include "netlist/netlist.h"
#include "options.h"
#include "run/scene.h"

/* ---- the signals of ports as sources of plain ngspice ---- */

/* A voltage source of the deck. */
typedef struct spice_source {
  const char *name, *plus, *minus; /* it and its nodes */
  const vs_signal *signal;         /* what drives it */
  bool stands;                     /* the run begins at the operating point, with switches off */
} spice_source;

/* ---- instants ---- */

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

/* When the first of the modulated switches is on for the first time; 0: none ever is. */
static double first_on_s(const vs_timeline *timeline, const vs_deck *deck, double until_s) {
  double first_s = INFINITY;
  for (size_t k = 0; k < deck->n_ports; k++) {
    const vs_signal *s = &deck->ports[k].signal;
    if (!vs_port_is_modulated(s)) continue;
    const bool on = vs_signals_voltage(timeline, s, vs_gate_of_step(0, 0)) > 0;
    first_s = fmin(first_s, on ? 0 : next_change(timeline, s, 0, until_s));
  }
  return isfinite(first_s) ? first_s : 0;
}

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

/* Writes the .param lines that the sources of gates use: instants of the pulses, as engine/gate.h
 * has them, from the scene's parameters vs_angle, vs_pulse, vs_first, vs_every, ...; and vs_fired,
 * when the first pulse of the deck's gates begins that does not end before t = 0, or a direct
 * supply is switched on. */
static void spice_sources_timing(vs_text *t, const vs_timeline *timeline, const vs_deck *deck,
                                 double until_s) {
  const double on_s = timeline->supply.direct ? first_on_s(timeline, deck, until_s) : 0;
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
  if (!gates && on_s > 0)
    vs_text_add(t, "%.17g", on_s);
  else
    vs_text_add(t, gates ? ",vs_until" : "vs_fire");
  while (gates--) vs_text_add(t, ")");
  vs_text_add(t, "}\n");
}

static void add_pulses(vs_text *t, const char *name, const char *nodes, double turns) {
  vs_text_add(t, "%s %s PULSE(0 1 {", name, nodes);
  add_gate_delay(t, turns);
  vs_text_add(t, "} {vs_edge} {vs_edge} {vs_pulse-vs_edge} {vs_period})\n");
}

static void write_gate(vs_text *t, const spice_source *s, const vs_timeline *timeline,
                       double until_s) {
  char nodes[2 * VS_DECK_NAME];
  (void)timeline, (void)until_s;
  snprintf(nodes, sizeof nodes, "%s %s", s->plus, s->minus);
  add_pulses(t, s->name, nodes, s->signal->shift_rad / (2 * M_PI));
}

/* Sub-pulses: those of one endless train that fall into a gate pulse. */
static void write_burst(vs_text *t, const spice_source *s, const vs_timeline *timeline,
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

static void write_mains(vs_text *t, const spice_source *s, const vs_timeline *timeline,
                        double until_s) {
  (void)until_s;
  if (timeline->supply.direct)
    vs_text_add(t, "%s %s %s {u_rms}\n", s->name, s->plus, s->minus);
  else
    vs_text_add(t, "%s %s %s SIN(0 {sqrt(2)*u_rms} {f_mains} 0 0 {phase*%.17g})\n", s->name,
                s->plus, s->minus, 180 / M_PI);
}

/* ---- modulated switches ---- */

static bool is_even(const vs_pwm_values *p) {
  return p->depth == 0 && !p->duty.count && !vs_pwm_is_single(p);
}

/* A switch that is on from the beginning is off at the operating point. */
static const char *first_level(bool stands, int level) {
  return stands && level ? "0 0 1e-08" : "0";
}

/* Pulses that are all alike, as PULSE from the first edge behind t = 0. */
static void write_even(vs_text *t, const vs_timeline *timeline, const vs_signal *s, double first_s,
                       int level) {
  double period_s = 1 / timeline->pwm.carrier_hz, second_s = next_change(timeline, s, first_s, 1e9);
  double edge_s = fmin(EDGE_S, fmin(second_s - first_s, first_s + period_s - second_s) / 10);
  vs_text_add(t, " PULSE(%d %d %.17g %.17g %.17g %.17g %.17g)\n", level, 1 - level, first_s, edge_s,
              edge_s, second_s - first_s - edge_s, period_s);
}

/* The same where the first pulse is under way at t = 0 and the switch is off at the operating
 * point: the rest of that pulse by a source of its own. */
static void write_begun(vs_text *t, const vs_timeline *timeline, const spice_source *s,
                        double first_s) {
  const double next_s = next_change(timeline, s->signal, first_s, 1e9),
               ends_s = next_change(timeline, s->signal, next_s, 1e9),
               edge_s = fmin(EDGE_S, fmin(first_s, next_s - first_s) / 10);
  vs_text_add(t, "%s %s vs_b_%s PULSE(0 1 %.17g %.17g %.17g %.17g %.17g)\n", s->name, s->plus,
              s->name, next_s, edge_s, edge_s, ends_s - next_s - edge_s,
              1 / timeline->pwm.carrier_hz);
  vs_text_add(t, "Vvs_b_%s vs_b_%s %s PWL(0 0 %.17g 1 %.17g 1 %.17g 0)\n", s->name, s->name,
              s->minus, edge_s, first_s, first_s + edge_s);
}

/* Pulses that differ, edge by edge. An edge takes EDGE_S, or a tenth of a shorter pulse. */
static void write_edges(vs_text *t, const vs_timeline *timeline, const vs_signal *s, double until_s,
                        int level, bool stands) {
  double at_s = next_change(timeline, s, 0, until_s);
  vs_text_add(t, " PWL(%s %d", first_level(stands, level), level);
  for (; at_s < until_s; level = 1 - level) {
    double next_s = next_change(timeline, s, at_s, until_s);
    vs_text_add(t, "\n+ %.15g %d %.15g %d", at_s, level, at_s + fmin(EDGE_S, (next_s - at_s) / 10),
                1 - level);
    at_s = next_s;
  }
  vs_text_add(t, ")\n");
}

static void write_modulated(vs_text *t, const spice_source *s, const vs_timeline *timeline,
                            double until_s) {
  const vs_signal *signal = s->signal;
  int level = vs_signals_voltage(timeline, signal, vs_gate_of_step(0, 0)) > 0;
  double first_s = next_change(timeline, signal, 0, until_s);
  const bool even = is_even(&timeline->pwm) && !isinf(first_s), begun = s->stands && level;
  if (even && begun) {
    write_begun(t, timeline, s, first_s);
    return;
  }
  vs_text_add(t, "%s %s %s", s->name, s->plus, s->minus);
  if (isinf(first_s) && !begun)
    vs_text_add(t, " %d\n", level);
  else if (even)
    write_even(t, timeline, signal, first_s, level);
  else
    write_edges(t, timeline, signal, until_s, level, s->stands);
}

/* ---- all sources ---- */

/* By VS_PORT_.... Events are not exported. */
static void (*const WRITERS[])(vs_text *, const spice_source *, const vs_timeline *,
                               double) = {[VS_PORT_MAINS] = write_mains,
                                          [VS_PORT_GATE] = write_gate,
                                          [VS_PORT_BURST] = write_burst,
                                          [VS_PORT_PWM] = write_modulated,
                                          [VS_PORT_PWM_LOW] = write_modulated};
_Static_assert(sizeof WRITERS / sizeof *WRITERS == VS_PORT_EVENT, "a row for each port of a deck");

/* Writes the source with that signal up to until_s. */
static void spice_sources_write(vs_text *t, const spice_source *s, const vs_timeline *timeline,
                                double until_s) {
  WRITERS[s->signal->drive](t, s, timeline, until_s);
}

/* What plain ngspice should be given at most. It looks for its place in a list of points from the
 * beginning on, at each step. */
enum { MOST_EDGES = 20000 };

/* Error: the edges of one port are too many. */
static vs_status check_edges(const vs_timeline *t, const vs_deck *deck, double until_s,
                             vs_error *err) {
  double edges = 2 * t->pwm.carrier_hz * until_s;
  if (is_even(&t->pwm) || vs_pwm_is_single(&t->pwm) || edges <= MOST_EDGES ||
      !vs_deck_has_port(deck, vs_port_is_modulated))
    return VS_OK;
  return vs_fail(err, VS_INPUT,
                 "export: pwm: the reference is not constant, and each of its edges is written: "
                 "%.0f up to run.until = %g s; allowed: %d, so run.until of at most %.3g s, or "
                 "pwm.depth: 0",
                 edges, until_s, MOST_EDGES, MOST_EDGES / (2 * t->pwm.carrier_hz));
}

/* The exported train of pulses has one angle, and its sub-pulses keep their phase from gate pulse
 * to gate pulse. */
static vs_status spice_sources_check(const vs_timeline *timeline, const vs_deck *deck,
                                     double until_s, vs_error *err) {
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

/* Measured under plain ngspice against the circuit tier at a tolerance of 1e-6, with steps of a
 * two-thousandth of a period by the trapezoidal rule: p is off by 3e-5 of its peak after a single
 * shot and by 1.4e-4 after ten cycles of continuous firing, p, u, w, phi, i and force by up to 5e-4
 * where the thyristor fires late; with a stop, 67 steps in a radian of the contact keep them within
 * 6e-4. The error falls with the square of the step, and Gear's rule has four times as much. */
static double largest_step(const vs_setup *s) {
  double period = s->timeline.period_s;
  double fine = fmin(period / 2000, 0.015 / s->model.contact_rad_s);
  double h = fmin(sqrt(s->run.tolerance / 1e-4) * fine, period / 200);
  if (s->run.gear) h /= 2;
  return s->run.max_step_s > 0 ? s->run.max_step_s : h;
}
/* With ngspice's relative tolerance of 1e-3 halfwave_bare and halfwave_snubbed are as right, and 3
 * to 8 % faster. But a chopper's current is off by 1.4e-3 after 80 periods of 20 kHz, as each edge
 * leaves an error of its own, and p of halfwave_paper is off by 4e-3. */
static const double RELTOL = 1e-4;

/* True for a node's name in which ngspice's commands would see an operator. */
static bool wants_quotes(const char *signal) {
  char word[16];
  snprintf(word, sizeof word, " %.*s ", (int)strlen(signal) - 3, signal + 2);
  return strpbrk(signal, "+-:") || strstr(" gt lt ge le eq ne and or not ", word);
}

/* A difference of two signals as commands have it: nothing for v(0). */
static void add_difference(vs_text *t, const char *plus, const char *minus) {
  const char *const signal[] = {plus, minus};
  for (int k = 0; k < 2; k++) {
    if (!strcmp(signal[k], "v(0)")) continue;
    const char *quote = wants_quotes(signal[k]) ? "\"" : "";
    vs_text_add(t, "%s%.2s%s%.*s%s)", k ? "-" : "", signal[k], quote, (int)strlen(signal[k]) - 3,
                signal[k] + 2, quote);
  }
  if (!strcmp(plus, "v(0)") && !strcmp(minus, "v(0)")) vs_text_add(t, "0*time");
}

/* ---- the columns of the table ---- */

typedef struct column {
  char name[VS_DECK_NAME + 32]; /* as in run.csv */
  vs_text value;                /* of vectors that are saved */
} column;
enum {
  OUR_COLUMNS = 5,
  MOST_COLUMNS = VS_MOST_DOF + OUR_COLUMNS + VS_MACHINE_PROBES + VS_DECK_MOST
};

static void name_column(column *c, vs_channel channel) {
  char suffix[32];
  vs_units_suffix(channel.unit, suffix, sizeof suffix);
  snprintf(c->name, sizeof c->name, "%s%s%s", channel.name, *suffix ? "_" : "", suffix);
}

static size_t find_columns(const vs_scene *scene, column columns[MOST_COLUMNS]) {
  static const int OURS[OUR_COLUMNS] = {VS_CH_Z, VS_CH_LAMBDA, VS_CH_I, VS_CH_FORCE, VS_CH_V_EVA};
  const vs_deck *deck = &scene->setup.deck;
  const vs_model *m = &scene->setup.model;
  const vs_frame *frame = &scene->frame;
  column *ours = columns + m->dof;
  for (int k = 0; k < m->dof; k++) {
    name_column(&columns[k], vs_channel_at(frame, VS_CH_Q + k));
    vs_text_add(&columns[k].value, "v(vs_%s)/1000", vs_export_machine_state(m, k));
  }
  for (int k = 0; k < OUR_COLUMNS; k++) name_column(&ours[k], vs_channel_at(frame, OURS[k]));
  vs_text_add(&ours[0].value, "v(%s.z)", deck->eva);
  vs_text_add(&ours[1].value, "v(%s.lam)", deck->eva);
  if (m->coil.square && !m->coil.eddies)
    vs_text_add(&ours[2].value, "v(%s.lam)*v(%s.z)/(2*vs_a)", deck->eva, deck->eva);
  else
    vs_text_add(&ours[2].value, "v(vs_i)");
  vs_text_add(&ours[3].value, "v(vs_f)");
  char plus[VS_DECK_NAME + 4], minus[VS_DECK_NAME + 4];
  snprintf(plus, sizeof plus, "v(%s)", deck->eva_plus);
  snprintf(minus, sizeof minus, "v(%s)", deck->eva_minus);
  add_difference(&ours[4].value, plus, minus);
  column *of_machine = ours + OUR_COLUMNS, *of_deck = of_machine + m->machine->n_probes;
  for (int k = 0; k < m->machine->n_probes; k++) {
    name_column(&of_machine[k], vs_channel_at(frame, vs_channel_probes(m) + k));
    vs_text_add(&of_machine[k].value, "v(vs_probe%d)", k + 1);
  }
  for (size_t k = 0; k < deck->n_probes; k++) {
    column *c = &of_deck[k];
    const vs_probe *probe = &deck->probes[k];
    name_column(c, vs_channel_at(frame, vs_channel_deck(m) + (int)k));
    const vs_term *term = &deck->terms[probe->term];
    if (probe->sign < 0) vs_text_add(&c->value, "-(");
    add_difference(&c->value, term->plus, term->minus);
    if (probe->sign < 0) vs_text_add(&c->value, ")");
  }
  return (size_t)(of_deck - columns) + deck->n_probes;
}

/* ---- names ---- */

/* Does a line of the deck use a name the export makes? They all begin with "vs_", those of elements
 * behind their letter. (A voltage source may be called vs_..., there is none among them.) */
static bool uses_our_names(const char *line) {
  for (const char *s = line; *s;) {
    size_t n = 0;
    while (isalnum((unsigned char)s[n]) || s[n] == '_' || s[n] == '.') n++;
    bool element = s == line && n > 0;
    if (!strncasecmp(s + element, "vs_", 3)) return true;
    s += n ? n : 1;
  }
  return false;
}

/* What the commands measure; names of vectors, as the columns' are. The first two are of the
 * travel, and are called after the coordinate that it is. */
enum { MEASURED_FIRST, MEASURED_LEAST, MEASURED_I, MEASURED_FORCE, N_MEASURED };
typedef char measured_name[VS_DECK_NAME + 32];

static void name_measured(const vs_scene *scene, measured_name names[N_MEASURED]) {
  const vs_model *m = &scene->setup.model;
  int one = vs_export_machine_travel_is(m);
  const char *of = one < 0 ? "gap" : vs_export_machine_state(m, one);
  snprintf(names[MEASURED_FIRST], sizeof *names, "%s_first_peak_m", of);
  snprintf(names[MEASURED_LEAST], sizeof *names, "%s_min_m", of);
  snprintf(names[MEASURED_I], sizeof *names, "i_peak_a");
  snprintf(names[MEASURED_FORCE], sizeof *names, "force_peak_n");
}

/* True for a coil whose force opens the gap, as a moving coil's: the first peak is a maximum then.
 * So little flux is within the range of every law. */
static bool opens_the_gap(const vs_model *m) {
  return vs_coil_force(&m->coil, 1e-6, m->coil.gap_rest_m) < 0;
}

/* A column named as a node whose voltage is asked for later would hide it. */
static vs_status check_column(const vs_deck *deck, const char *name, vs_error *err) {
  char signal[sizeof(column) + 4];
  snprintf(signal, sizeof signal, "v(%s)", name);
  bool used = !strcasecmp(deck->eva_plus, name) || !strcasecmp(deck->eva_minus, name) ||
              !strcasecmp(name, "time");
  for (size_t j = 0; j < deck->n_terms && !used; j++)
    used = !strcasecmp(deck->terms[j].plus, signal) || !strcasecmp(deck->terms[j].minus, signal);
  return used ? vs_fail_at(err, (vs_where){deck->files[0], 1, 1},
                           "node %s: the export's table has a column of this name; give the node "
                           "another one",
                           name)
              : VS_OK;
}

static vs_status check_names(const vs_scene *scene, const column *columns, size_t count,
                             vs_error *err) {
  const vs_deck *deck = &scene->setup.deck;
  measured_name measured[N_MEASURED];
  name_measured(scene, measured);
  static const char OURS[] = "names that begin with vs_ are the export's own";
  for (size_t k = 0; k < deck->n_lines; k++)
    if (uses_our_names(deck->lines[k].text)) return vs_fail_at(err, deck->lines[k].where, OURS);
  for (size_t k = 0; k < deck->section.count; k++)
    if (!strncasecmp(deck->section.fields[k].key, "vs_", 3))
      return vs_fail_at(err, (vs_where){deck->files[0], 1, 1}, "param %s: %s",
                        deck->section.fields[k].key, OURS);
  vs_status status = vs_export_machine_check(&scene->setup, err);
  for (size_t k = 0; k < count && !status; k++) {
    const char *name = columns[k].name;
    bool twice = false;
    for (size_t j = 0; j < k; j++) twice = twice || !strcasecmp(columns[j].name, name);
    for (int j = 0; j < N_MEASURED; j++) twice = twice || !strcasecmp(measured[j], name);
    status = twice ? vs_fail_at(err, (vs_where){deck->files[0], 1, 1},
                                "probe: %s stands in the export already; give the probe another "
                                "name",
                                name)
                   : check_column(deck, name, err);
  }
  return status;
}

/* ---- the pieces of the deck, in their order ---- */

static void add_head(vs_text *t, const vs_scene *scene, const char *deck_name,
                     const char *table_name) {
  const vs_deck *deck = &scene->setup.deck;
  const vs_machine *machine = scene->setup.model.machine;
  vs_text_add(t, "%s: a machine and its converter, for ngspice\n", deck_name);
  vs_text_add(t, "* Exported by vibrospice %s. Machine: %s. Converter: %s.\n", VS_VERSION,
              machine->title, *deck->title ? deck->title : "no title");
  vs_text_add(t, "*\n* Run it:   ngspice %s%s%s-b %s\n", *deck->compat ? "-D ngbehavior=" : "",
              deck->compat, *deck->compat ? "a " : "", deck_name);
  vs_text_add(
      t,
      "* It prints a few measures (first peak: the gap's first %s after firing, once the travel\n"
      "* is above %g %% of its largest) and writes a table in the working directory, %s:\n"
      "* columns between blanks, names first, a row every vs_sample seconds. A name ends in its\n"
      "* unit. z: air gap; lambda i v_eva: of the coil; force: on the armature; before them the\n"
      "* machine's coordinates, behind them what the converter declares. A run that ends early or\n"
      "* meets the pole gives no table and exit status 1.\n",
      opens_the_gap(&scene->setup.model) ? "maximum" : "minimum", 100 * vs_measures_ripple,
      table_name);
  for (int k = 0; k < machine->dof; k++)
    vs_text_add(t, "* %s: %s\n", machine->coordinates[k].name, machine->coordinates[k].text);
}

typedef struct param {
  const char *name;
  double value;
  const char *text;
} param;

static void add_params(vs_text *t, const param *rows, size_t count) {
  for (size_t k = 0; k < count; k++)
    vs_text_add(t, ".param %s=%.17g ; %s\n", rows[k].name, rows[k].value, rows[k].text);
}

/* The scene's values that stand in no parameter of the netlist's own. */
static void add_scene(vs_text *t, const vs_setup *s) {
  const vs_firing_values *firing = &s->timeline.firing;
  const vs_actuator_values *eva = &s->model.actuator;
  const param ROWS[] = {
      {"vs_angle", firing->angle.first, "rad, of firing, from the rising zero of the mains"},
      {"vs_pulse", firing->pulse_width_s, "s, length of a gate pulse"},
      {"vs_first", firing->first_cycle, "cycle of the first pulse, from 1"},
      {"vs_every", firing->every, "cycles from pulse to pulse; 0: one pulse only"},
      {"vs_burst", firing->burst_hz, "Hz, of sub-pulses"},
      {"vs_burst_duty", firing->burst_duty, "part of a sub-pulse's period that it is there"},
      {"vs_d", eva->gap_m, "m, D, from the armature to the pole cover"},
      {"vs_gap", s->model.coil.gap_rest_m, "m, D + d, the air gap at rest"},
      {"vs_until", s->run.until_s, "s, end of the run"},
      {"vs_sample", fmin(s->run.sample_s, s->run.until_s), "s, from row to row of the table"},
      {"vs_step", largest_step(s), "s, the largest step; the error falls with its square"},
  };
  vs_text_add(t, "*\n* The scene, in SI. Change a value and run again.\n");
  add_params(t, ROWS, sizeof ROWS / sizeof *ROWS);
  for (int k = 0; k < 2 * s->model.dof; k++)
    vs_text_add(t, ".param vs_%s0=%.17g ; SI, %s\n", vs_export_machine_state(&s->model, k),
                s->start.x[k], s->model.machine->start.fields[k].text);
  vs_export_machine_params(t, &s->model);
}

/* The source of a port, or one of the EVA's (port: NULL), in the place of "NAME n m external". */
static void add_source(vs_text *t, const char *line, const vs_port *port, const vs_setup *s) {
  char name[VS_DECK_NAME], plus[VS_DECK_NAME], minus[VS_DECK_NAME];
  sscanf(line, "%63s %63s %63s", name, plus, minus);
  if (port)
    spice_sources_write(t, &(spice_source){name, plus, minus, &port->signal, vs_setup_stands(s)},
                        &s->timeline, s->run.until_s);
  else
    vs_export_machine_motion(t, s, name, (const char *[]){plus, minus});
}

/* The netlist with its external sources replaced. The EVA's stands after the deck's own lines. */
static vs_status add_netlist(vs_text *t, const vs_setup *s, vs_error *err) {
  vs_deck_value standard[VS_STANDARD];
  char **lines;
  size_t count;
  vs_setup_standard(s, standard);
  vs_text_add(t, "*\n* The converter.\n");
  vs_status status = spice_sources_check(&s->timeline, &s->deck, s->run.until_s, err);
  if (status) return status;
  status =
      vs_netlist_make(&s->deck, &s->circuit_values, standard, VS_STANDARD, &lines, &count, err);
  for (size_t k = 1; k < count && !status; k++) { /* the first is its title */
    char name[VS_DECK_NAME], word[VS_DECK_NAME];
    if (sscanf(lines[k], "%63s %*s %*s %63s", name, word) != 2 || strcasecmp(word, "external")) {
      vs_text_add(t, "%s\n", lines[k]);
      continue;
    }
    if (strchr("iI", *name)) continue; /* the EVA's, by which the program leads ngspice */
    size_t p = 0;
    while (p < s->deck.n_ports && strcasecmp(s->deck.ports[p].source, name)) p++;
    add_source(t, lines[k], p < s->deck.n_ports ? &s->deck.ports[p] : NULL, s);
  }
  vs_netlist_free(lines, count);
  return status;
}

static void add_saved(vs_text *t, const char *signal) {
  if (strcmp(signal, "v(0)")) vs_text_add(t, ".save %s\n", signal);
}

/* Absolute tolerances and trtol are tier circuit's. With ngspice's own the run of halfwave_paper
 * ends where the thyristor fires, as no step is short enough, and a chopper's takes eight times as
 * long.
 */
static void add_analysis(vs_text *t, const vs_setup *s) {
  const vs_pace pace = vs_pace_of(s);
  vs_text_add(t,
              "*\n.options method=%s reltol=%g abstol=%.3g vntol=%.3g chgtol=%.3g trtol=%g "
              "pivrel=%g\n",
              s->run.gear ? "gear" : "trap", RELTOL, pace.current_a, pace.voltage_v, pace.charge_c,
              pace.truncation, s->run.pivrel);
  const vs_deck *deck = &s->deck;
  const vs_model *m = &s->model;
  const bool stands = vs_setup_stands(s);
  vs_text_add(t, ".tran {vs_sample} {vs_until} 0 {vs_step}%s\n", stands ? "" : " uic");
  for (int k = 0; stands && k < 2 * m->dof; k++) {
    const char *state = vs_export_machine_state(m, k);
    vs_text_add(t, "%s v(vs_%s)={1000*vs_%s0}%s", k ? "" : ".ic", state, state,
                k == 2 * m->dof - 1 ? "\n" : "");
  }
  vs_text_add(t, ".save");
  for (int k = 0; k < m->dof; k++) vs_text_add(t, " v(vs_%s)", vs_export_machine_state(m, k));
  if (vs_export_machine_travel_is(m) < 0)
    vs_text_add(t, " v(vs_%s)", vs_export_machine_node(m, false));
  vs_text_add(t, " v(vs_%s) v(vs_f) v(%s.z) v(%s.lam)%s\n", vs_export_machine_node(m, true),
              deck->eva, deck->eva, m->coil.square && !m->coil.eddies ? "" : " v(vs_i)");
  for (int k = 0; k < m->machine->n_probes; k++) vs_text_add(t, ".save v(vs_probe%d)\n", k + 1);
  char signal[VS_DECK_NAME + 4];
  for (int k = 0; k < 2; k++) {
    snprintf(signal, sizeof signal, "v(%s)", k ? deck->eva_minus : deck->eva_plus);
    add_saved(t, signal);
  }
  for (size_t k = 0; k < deck->n_probes; k++) {
    add_saved(t, deck->terms[deck->probes[k].term].plus);
    add_saved(t, deck->terms[deck->probes[k].term].minus);
  }
  vs_text_add(t, ".csparam vs_until={vs_until}\n.csparam vs_fired={vs_fired+vs_step}\n"
                 ".csparam vs_d={vs_d}\n");
  if (m->coil.square) vs_text_add(t, ".csparam vs_a={eva_a}\n");
}

/* What follows the run: a run that ended early, or that left what the model holds for, gives no
 * table and exit status 1. */
static void add_validity(vs_text *t, const vs_model *m, const char *travel) {
  bool stopped = false;
  for (int k = 0; k < m->stops.count; k++) stopped = stopped || m->stops.item[k].side > 0;
  if (!m->coil.law->poles) return;
  if (!stopped)
    vs_text_add(
        t,
        "if vecmin(%s) < -vs_d\n  echo \"ERROR: the armature meets the pole cover (%s = -D) "
        "and there is no stop; this is not physical\"\n  quit 1\nend\n",
        travel, vs_export_machine_travel(m));
  vs_text_add(t, "if vecmin(z_m) <= 0\n  echo \"ERROR: the gap is closed\"\n  quit 1\nend\n");
}

static void add_commands(vs_text *t, const vs_scene *scene, const column *columns, size_t count,
                         const char *table_name) {
  const vs_model *m = &scene->setup.model;
  int one = vs_export_machine_travel_is(m);
  const char *travel = one < 0 ? "vs_travel" : columns[one].name;
  measured_name measured[N_MEASURED];
  name_measured(scene, measured);
  vs_text_add(t, ".control\nrun\nlet vs_reached = 0\nlet vs_reached = vecmax(time)\n"
                 "if vs_reached < 0.999999*vs_until\n"
                 "  echo \"ERROR: ngspice gave up before the end of the run\"\n  quit 1\nend\n");
  for (size_t k = 0; k < count; k++)
    vs_text_add(t, "let %s = %s\n", columns[k].name, columns[k].value.text);
  if (one < 0) vs_text_add(t, "let vs_travel = v(vs_%s)/1000\n", vs_export_machine_node(m, false));
  add_validity(t, m, travel);
  vs_text_add(t,
              "let vs_way = abs(%s)*(time ge vs_fired)\n"
              "let vs_moves = vecmin(time+vs_until*(vs_way lt %g*vecmax(vs_way)))\n"
              "meas tran %s find %s when v(vs_%s)=0 %s=1 td=$&vs_moves\n",
              travel, vs_measures_ripple, measured[MEASURED_FIRST], travel,
              vs_export_machine_node(m, true), opens_the_gap(m) ? "fall" : "rise");
  vs_text_add(t, "meas tran %s min %s\n", measured[MEASURED_LEAST], travel);
  vs_text_add(t, "let vs_size = abs(i_a)\nmeas tran %s max vs_size\n", measured[MEASURED_I]);
  if (opens_the_gap(m)) vs_text_add(t, "let vs_force = abs(force_n)\n");
  vs_text_add(t, "meas tran %s max %s\n", measured[MEASURED_FORCE],
              opens_the_gap(m) ? "vs_force" : "force_n");
  vs_text_add(t, "linearize");
  for (size_t k = 0; k < count; k++) vs_text_add(t, " %s", columns[k].name);
  vs_text_add(t, "\nset wr_singlescale\nset wr_vecnames\nset numdgt=9\nwrdata %s", table_name);
  for (size_t k = 0; k < count; k++) vs_text_add(t, " %s", columns[k].name);
  vs_text_add(t, "\n* without the next line ngspice, started without -b, stays and can plot\nquit "
                 "0\n.endc\n.end\n");
}

/* ---- the command ---- */

/* What ngspice's commands would not take as part of a file's name becomes '_'. */
static void tame(char *name) {
  for (; *name; name++)
    if (!isalnum((unsigned char)*name) && !strchr("._-", *name)) *name = '_';
}

/* The deck as text; its file is called name, its table NAME.txt, and X.txt for X.cir. */
static vs_status write_text(vs_text *t, const vs_scene *scene, const char *name, vs_error *err) {
  char deck_name[VS_NAME_SIZE], table_name[VS_NAME_SIZE + 8];
  snprintf(deck_name, sizeof deck_name, "%s", name);
  tame(deck_name);
  const char *ending = strrchr(deck_name, '.');
  size_t stem = strlen(deck_name) - (ending && !strcmp(ending, ".cir") ? 4 : 0);
  snprintf(table_name, sizeof table_name, "%.*s.txt", (int)stem, deck_name);
  column *columns = vs_alloc(MOST_COLUMNS, sizeof *columns);
  size_t count = find_columns(scene, columns);
  vs_status status = check_names(scene, columns, count, err);
  add_head(t, scene, deck_name, table_name);
  add_scene(t, &scene->setup);
  spice_sources_timing(t, &scene->setup.timeline, &scene->setup.deck, scene->setup.run.until_s);
  if (!status) status = add_netlist(t, &scene->setup, err);
  vs_export_machine_write(t, &scene->setup);
  add_analysis(t, &scene->setup);
  add_commands(t, scene, columns, count, table_name);
  for (size_t k = 0; k < count; k++) vs_text_free(&columns[k].value);
  free(columns);
  return status;
}

static vs_status write_deck(const vs_scene *scene, const char *output, vs_error *err) {
  const char *slash = strrchr(output, '/'), *name = slash ? slash + 1 : output;
  char folder[VS_PATH_SIZE] = "";
  struct stat s;
  if (!*name || strlen(output) >= sizeof folder || (!stat(output, &s) && S_ISDIR(s.st_mode)))
    return vs_fail(err, VS_INPUT, "-o %s: the name of a file is wanted", output);
  if (slash)
    snprintf(folder, sizeof folder, "%.*s", (int)(slash - output + (slash == output)), output);
  vs_text text = {0};
  vs_status status = write_text(&text, scene, name, err);
  if (!status) status = vs_file_write(folder, name, text.text, err);
  vs_text_free(&text);
  return status;
}

/* What the netlist would leave out without a word is refused. */
static vs_status check_whole(const vs_scene *scene, vs_error *err) {
  const vs_events *events = &scene->setup.timeline.events;
  const vs_node *control = vs_tree_child(scene->tree.root, vs_control_section.name);
  if (events->count)
    return vs_fail_at(err, events->item[0].where,
                      "export: a netlist for plain ngspice has no events; leave %s out",
                      events->item[0].name);
  if (scene->control.regulator)
    return vs_fail_at(err, control->key_where,
                      "export: control: a netlist has one angle for all firings, and a control "
                      "decides each; leave the section out");
  if (scene->setup.steady)
    return vs_fail_at(
        err, vs_tree_place(scene->tree.root, "start"),
        "export: the orbit that start: steady begins on is not exported; leave it out, or "
        "write the coordinates at the start as start: {NAME: VALUE, ...}");
  return vs_setup_require_fraction(&scene->setup, vs_tree_place(scene->tree.root, "load.fraction"),
                                   "export", err);
}

vs_status vs_export_command(const char *name, char *const *sets, size_t n_sets, const char *output,
                            vs_error *err) {
  vs_scene *scene = vs_alloc(1, sizeof *scene);
  vs_status status =
      vs_scene_read(name, sets, n_sets, vs_setup_tier_words[VS_TIER_CIRCUIT], scene, err);
  if (!status) vs_scene_warn(scene);
  if (!status) status = check_whole(scene, err);
  if (!status) status = write_deck(scene, output, err);
  if (!status) printf("written: %s\n", output);
  vs_scene_free(scene);
  free(scene);
  return status;
}

/* ---- the command line ---- */

typedef struct export_line {
  vs_arguments common;
  vs_export_fmu_options unit;
} export_line;

static vs_status export_command(const void *given, vs_error *err) {
  const export_line *line = given;
  const vs_arguments *a = &line->common;
  if (!a->output)
    return vs_fail(err, VS_INPUT, "export: wants -o FILE; see vibrospice export --help");
  const size_t length = strlen(a->output);
  if (length > 4 && !strcmp(a->output + length - 4, ".fmu"))
    return vs_export_fmu_command(vs_command_name(a), a->sets, a->n_sets, a->output, &line->unit,
                                 err);
  if (line->unit.with_program)
    return vs_fail(err, VS_INPUT, "export: --with-program is for a unit: -o FILE.fmu");
  return vs_export_command(vs_command_name(a), a->sets, a->n_sets, a->output, err);
}

static const vs_option EXPORT_OPTIONS[] = {
    VS_OPTIONS_SET,
    VS_OPTIONS_OUTPUT("FILE", "writes the netlist there; the unit where it ends with .fmu"),
    VS_OPTIONS_WHOLE(export_line, unit.fmi, 2, 3, "fmi", "N",
                     "version of the unit's standard: 2 (default) or 3"),
    VS_OPTIONS_FLAG(export_line, unit.with_program, "with-program",
                    "packs the program into the unit, which then needs no other"),
    VS_OPTIONS_JAIL,
    VS_OPTIONS_END};

const vs_command vs_export_cli = {
    .name = "export",
    .argument = "SCENE",
    .text = "writes one netlist for plain ngspice: the scene's circuit tier, with the machine in "
            "it; or "
            "a unit for masters of co-simulation (FMI)",
    .examples = "  vibrospice export paper -o paper.cir && ngspice -b paper.cir\n"
                "  vibrospice export my.yaml --set run.until=0.1s -o my.cir\n"
                "  vibrospice export my.yaml -o my.fmu --fmi 3 --with-program\n",
    .options = EXPORT_OPTIONS,
    .size = sizeof(export_line),
    .defaults = &(const export_line){.unit.fmi = 2},
    .run = export_command};
