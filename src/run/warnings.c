/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/warnings.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/units.h"
#include "engine/firing.h"
#include "engine/wave.h"
#include "netlist/devices.h"
#include "netlist/netlist.h"
#include "netlist/parts.h"

/* ---- the list ---- */

void vs_warnings_free(vs_warnings *w) {
  free(w->item);
  *w = (vs_warnings){0};
}

vs_error *vs_warnings_add(vs_warnings *w) {
  if (w->count == w->capacity) {
    vs_error *old = w->item;
    w->capacity = 2 * w->capacity + 8;
    w->item = vs_alloc(w->capacity, sizeof *w->item);
    if (w->count) memcpy(w->item, old, w->count * sizeof *old);
    free(old);
  }
  w->item[w->count] = (vs_error){0};
  return &w->item[w->count++];
}

const char *vs_warnings_text(const vs_error *warning) {
  return warning->text + (warning->elsewhere ? 0 : warning->place_size);
}

/* ---- a scene ---- */

static vs_where place_of_value(const vs_node *node) {
  return node ? node->where : (vs_where){0};
}

/* The lower end of the control range is theta = atan(w L(0)/R_c) <= alpha* (Eqs. 92, 93). */
static void warn_below_theta(const vs_node *root, const vs_setup *s, vs_warnings *w) {
  double theta =
      atan2(s->timeline.omega_rad_s * s->model.actuator.inductance_h, s->model.coil.resistance_ohm);
  const vs_node *angle = vs_tree_child(vs_tree_child(root, "firing"), "angle");
  double range[2];
  vs_firing_range(&s->timeline, range);
  if (range[0] >= theta) return;
  vs_fail_at(vs_warnings_add(w), place_of_value(angle),
             "firing.angle = %.6g deg is below theta = %.6g deg, the lower end of the control "
             "range (Eq. 92): "
             "the thyristor conducts as Eq. 91 says, for more than 180 deg",
             range[0] / vs_units_factor("deg"), theta / vs_units_factor("deg"));
}

/* The deck's device that conducts both ways and has a gate, a triac; NULL: it has none. */
static const vs_device *fired_both_ways(const vs_deck *deck) {
  for (size_t k = 0; k < deck->n_devices; k++)
    if (deck->devices[k].kind && deck->devices[k].kind->both_ways && deck->devices[k].kind->gated)
      return &deck->devices[k];
  return NULL;
}

/* A pulse that lasts until its thyristor has forward voltage again fires it there, at once. A triac
 * has voltage of the other sign half a cycle earlier. */
static void warn_of_long_pulses(const vs_node *root, const vs_setup *s, vs_warnings *w) {
  const vs_timeline *t = &s->timeline;
  const vs_node *firing = vs_tree_child(root, "firing");
  const vs_node *width = vs_tree_child(firing, "pulse_width");
  double range[2];
  vs_firing_range(t, range);
  double ends_s = range[1] / t->omega_rad_s + t->firing.pulse_width_s;
  if (t->firing.no_valve || t->supply.direct) return;
  const vs_device *triac = fired_both_ways(&s->deck);
  if (triac && ends_s > t->period_s / 2) {
    char advice[48] = "fire earlier";
    double room_ms = floor(1e4 * (t->period_s / 2 - range[1] / t->omega_rad_s)) / 10;
    if (room_ms > 0) snprintf(advice, sizeof advice, "take %.3g ms or less", room_ms);
    vs_fail_at(vs_warnings_add(w), place_of_value(width ? width : vs_tree_child(firing, "angle")),
               "firing.pulse_width: the pulse lasts until %.6g ms, and the mains change sign at "
               "%.6g ms: once the current of %s ends it is fired again, the other way, whatever "
               "firing.angle says; %s",
               1e3 * ends_s, 1e3 * t->period_s / 2, triac->name, advice);
    return;
  }
  if (!t->firing.every || ends_s <= t->period_s) return;
  vs_fail_at(vs_warnings_add(w), place_of_value(width ? width : vs_tree_child(firing, "angle")),
             "firing.pulse_width: the pulse lasts until %.6g ms, and forward voltage is back at "
             "%.6g ms: it may fire there, whatever firing.angle says; a shorter pulse does not",
             1e3 * ends_s, 1e3 * t->period_s);
}

/* The energy drawn from the mains is what the port mains gives. */
const char *vs_warnings_without_mains(const vs_deck *deck) {
  if (deck->lost & VS_LOST_PORT) return NULL;
  for (size_t k = 0; k < deck->n_ports; k++)
    if (deck->ports[k].signal.drive == VS_PORT_MAINS) return NULL;
  return "no port mains, so that energy_in, what is drawn from the mains, is 0 J, and "
         "supply.voltage "
         "drives nothing";
}

static void warn_of_mains(const vs_deck *deck, vs_warnings *w) {
  const char *text = vs_warnings_without_mains(deck);
  const char *file = deck->n_files ? deck->files[0] : NULL;
  if (text) vs_fail_at(vs_warnings_add(w), (vs_where){.file = file}, "the deck has %s", text);
}

void vs_warnings_of_limits(const vs_deck *deck, vs_warnings *w) {
  enum { MOST = 8 }; /* a part of another kind may have dozens */
  char text[VS_DECK_TEXT + VS_NAME_SIZE];
  size_t said = 0;
  for (size_t k = 0; k < deck->n_limits && said < MOST; k++)
    if (vs_parts_limit_is_idle(deck, k, text, sizeof text)) {
      vs_fail_at(vs_warnings_add(w), deck->limits[k].where, "%s", text);
      said++;
    }
}

void vs_warnings_of_netlist(const vs_deck *deck, vs_warnings *w) {
  for (size_t k = 0; deck->remarks && k < deck->remarks->count; k++)
    *vs_warnings_add(w) = deck->remarks->item[k];
}

/* Parts that the supply is too much for, series that have no such value, and fuses that do not
 * protect what they are to. */
static void warn_of_parts(const vs_node *circuit, const vs_setup *s, double mains_v,
                          vs_warnings *w) {
  const vs_deck *deck = &s->deck;
  char text[2 * VS_DECK_TEXT + VS_NAME_SIZE];
  for (size_t p = 0; p < deck->n_parts; p++)
    if (vs_parts_below_mains(deck, p, mains_v, text, sizeof text) ||
        vs_netlist_beyond_series(deck, &s->circuit_values, p, text, sizeof text))
      vs_fail_at(vs_warnings_add(w), place_of_value(vs_tree_child(circuit, deck->parts[p].name)),
                 "%s", text);
  for (size_t d = 0; d < deck->n_devices; d++)
    if (vs_devices_fails_ward(deck, d, text, sizeof text)) {
      const char *part = deck->parts[deck->devices[d].part].name;
      vs_fail_at(vs_warnings_add(w), place_of_value(vs_tree_child(circuit, part)), "%s", text);
    }
}

static bool is_high_pwm(const vs_signal *signal) {
  return signal->drive == VS_PORT_PWM;
}
static bool is_low_pwm(const vs_signal *signal) {
  return signal->drive == VS_PORT_PWM_LOW;
}

/* Sub-pulses that drive no source of the deck. */
static void warn_of_bursts(const vs_node *firing, const vs_deck *deck, vs_warnings *w) {
  static const char *const KEYS[] = {"burst_frequency", "burst_duty"};
  const vs_node *node = NULL;
  for (size_t k = 0; k < sizeof KEYS / sizeof *KEYS && !node; k++)
    node = vs_tree_child(firing, KEYS[k]);
  if (!node || (deck->lost & VS_LOST_PORT)) return;
  for (size_t k = 0; k < deck->n_ports; k++)
    if (deck->ports[k].signal.drive == VS_PORT_BURST) return;
  vs_fail_at(vs_warnings_add(w), node->key_where,
             "firing.%s: the deck has no port burst, so that nothing is driven with sub-pulses",
             node->key);
}

/* A frequency of direct voltage. */
static void warn_of_frequency(const vs_node *supply, const vs_setup *s, vs_warnings *w) {
  const vs_node *node = vs_tree_child(supply, "frequency");
  if (node && s->timeline.supply.direct)
    vs_fail_at(vs_warnings_add(w), node->key_where,
               "supply.frequency: with supply.kind: step the voltage is direct; it counts the "
               "cycles of events and means alone");
}

/* Pulses that drive no source of the deck, and those that the dead time leaves out. */
static void warn_of_pwm(const vs_node *pwm, const vs_timeline *t, const vs_deck *deck,
                        vs_warnings *w) {
  const vs_node *dead = vs_tree_child(pwm, "dead_time");
  char text[256];
  if (deck->lost & VS_LOST_PORT) return;
  if (!vs_deck_has_port(deck, vs_port_is_modulated)) {
    if (pwm && pwm->child)
      vs_fail_at(vs_warnings_add(w), pwm->child->key_where,
                 "pwm.%s: the deck has no port pwm, so that nothing is modulated", pwm->child->key);
    return;
  }
  for (int low = 0; low < 2; low++)
    if (vs_deck_has_port(deck, low ? is_low_pwm : is_high_pwm) &&
        vs_pwm_drops(&t->pwm, low, text, sizeof text))
      vs_fail_at(vs_warnings_add(w), place_of_value(dead ? dead : pwm), "%s", text);
}

/* What the coil's law has to say, such as how far a table's forces are from its flux linkages. */
static void warn_of_law(const vs_node *root, const vs_coil *coil, vs_warnings *w) {
  char text[640];
  const char *note = coil->law && coil->law->note ? coil->law->note(coil, text, sizeof text) : NULL;
  if (note)
    vs_fail_at(vs_warnings_add(w),
               place_of_value(vs_tree_child(vs_tree_child(root, "actuator"), "law")),
               "actuator.law: %s", note);
}

/* A machine whose damping feeds it. A motion that only grows tells nothing of a machine. */
static void warn_of_growth(const vs_node *root, const vs_model *m, vs_warnings *w) {
  if (m->growth_1_s > 0)
    vs_fail_at(
        vs_warnings_add(w), place_of_value(vs_tree_child(root, "machine")),
        "machine: a mode of the machine grows by itself, by a factor of e in %.3g s; look at "
        "the signs of its damping",
        1 / m->growth_1_s);
}

static double load_kg(const vs_model *m) {
  return m->riding * m->load.density_kg_m3 * m->load.volume_m3;
}

/* True: the model's share is the one that load.fraction: auto is still to find. */
static bool is_sought(const vs_setup *s, const vs_model *m) {
  return s->wants_fraction && isnan(m->load.fraction);
}

/* Writes the load's mass where it is the same in both; false: it is not, or that is not known. */
static bool is_same_load(const vs_setup *s, const vs_model *a, const vs_model *b, char *text,
                         size_t size) {
  double kg = load_kg(a);
  bool sought = is_sought(s, a);
  if (kg != load_kg(b) || (kg != 0 && sought != is_sought(s, b))) return false;
  snprintf(text, size, "%.6g kg", kg);
  if (kg != 0 && sought) snprintf(text, size, "the same");
  return true;
}

/* Events that change the load to what it is already, as where load.density is 0. */
static void warn_of_loads(const vs_setup *s, vs_warnings *w) {
  const vs_model *before = &s->model;
  for (size_t k = 0; k < s->loads.count; k++) {
    const vs_model *after = &s->loads.item[k].model;
    const vs_scene_event *e = vs_setup_load_event(&s->timeline.events, s->loads.item[k].at_s);
    char text[32];
    if (is_same_load(s, before, after, text, sizeof text))
      vs_fail_at(vs_warnings_add(w), e->where,
                 "events.%s: the load is %s before and after it, so that nothing changes; look "
                 "at load.density, load.volume and load.fraction",
                 e->name, text);
    before = after;
  }
}

/* Where the scene says when an event begins. */
static vs_where place_of_beginning(const vs_node *root, const vs_scene_event *e) {
  const vs_node *map = vs_tree_child(vs_tree_child(root, "events"), e->name);
  const vs_node *at = vs_tree_child(map, "at"), *cycle = vs_tree_child(map, "cycle");
  return at || cycle ? place_of_value(at ? at : cycle) : e->where;
}

/* Events that would begin once the run is over. Who turns one off knows. */
static void warn_of_late_events(const vs_node *root, const vs_setup *s, vs_warnings *w) {
  const vs_events *events = &s->timeline.events;
  for (size_t k = 0; k < events->n_unbuilt; k++)
    if (!events->unbuilt[k].v.off)
      vs_fail_at(vs_warnings_add(w), place_of_beginning(root, &events->unbuilt[k]),
                 "events.%s: it would begin at %.9g s, and the run ends at run.until = %.9g s: it "
                 "is not built, and the run is the one without it",
                 events->unbuilt[k].name, events->unbuilt[k].start_s, s->run.until_s);
}

/* Generators whose networks lie on the line together. In a laboratory there is one at a time. */
static void warn_of_generators(const vs_setup *s, vs_warnings *w) {
  const vs_events *events = &s->timeline.events;
  const vs_scene_event *before = NULL;
  for (size_t k = 0; k < events->count; k++) {
    const vs_scene_event *e = &events->item[k];
    if (!e->kind->network) continue;
    double both_s = before ? fmax(e->on_line_s, before->on_line_s) : 0;
    if (before)
      vs_fail_at(vs_warnings_add(w), e->where,
                 "events.%s: its network lies on the line together with that of events.%s, from "
                 "%.9g s on: each loads the other's wave, and no standard has two; leave one of "
                 "them out (off: true), or let the later one load nothing before its own wave "
                 "(from: strike)",
                 e->name, before->name, both_s);
    before = e;
  }
}

/* True for a device with a limit for the heat of one pulse, and no table over their number. */
static bool bears_one_pulse(const vs_deck *deck, const vs_device *d) {
  bool one = false, table = false;
  for (size_t k = 0; d->kind && k < d->kind->n_measures; k++) {
    const vs_device_measure *m = &d->kind->measures[k];
    const vs_limit *limit = vs_devices_limit(deck, d, m);
    one = one || (m->how == VS_R_HEAT && limit && isfinite(limit->value));
    table = table || (m->how == VS_R_DERATED && vs_devices_least_pulse(deck, d) > 0);
  }
  return one && !table;
}

/* Devices of which nothing is known for more than one pulse. */
static void warn_of_repetition(const vs_node *root, const vs_setup *s, vs_warnings *w) {
  const vs_scene_event *e = vs_scene_event_repeated(&s->timeline.events);
  const vs_deck *deck = &s->deck;
  for (size_t k = 0; e && k < deck->n_devices; k++) {
    if (!bears_one_pulse(deck, &deck->devices[k])) continue;
    const vs_node *map = vs_tree_child(vs_tree_child(root, "events"), e->name);
    vs_fail_at(vs_warnings_add(w), place_of_value(vs_tree_child(map, "times")),
               "events.%s.times: %d pulses; %s states no derating over number (pulse), so its "
               "limits for one pulse were used",
               e->name, e->v.times, deck->devices[k].name);
  }
}

/* A circuit whose supply is to have no resistance. */
static void warn_of_supply(const vs_node *root, const vs_setup *s, vs_warnings *w) {
  const vs_supply_values *supply = &s->timeline.supply;
  const double r_ohm = vs_setup_source_ohm(s);
  if (r_ohm != supply->resistance_ohm)
    vs_fail_at(vs_warnings_add(w),
               place_of_value(vs_tree_child(vs_tree_child(root, "supply"), "resistance")),
               "supply.resistance: ngspice has no resistor of 0 ohm and takes %g mohm in its place",
               1e3 * r_ohm);
}

/* Warns of a file that is taken from the working folder, as none of that name lies beside the file
 * that names it. */
static void warn_of_folder(const vs_node *named, vs_warnings *w) {
  if (!named || named->kind != VS_NODE_TEXT || !vs_path_is_fallback(named->text, named->where))
    return;
  vs_fail_at(vs_warnings_add(w), named->where,
             "%s is taken from the folder where the program runs, as none lies beside the file "
             "that names it; put it there, or write a path that starts there",
             named->text);
}

static void warn_of_folders(const vs_node *root, const vs_deck *deck, vs_warnings *w) {
  static const char *const KEYS[][2] = {
      {"machine", "model"}, {"actuator", "law"}, {"instruments", "set"}};
  const vs_node *circuit = vs_tree_child(root, "circuit");
  for (size_t k = 0; k < sizeof KEYS / sizeof *KEYS; k++)
    warn_of_folder(vs_tree_child(vs_tree_child(root, KEYS[k][0]), KEYS[k][1]), w);
  if (!deck) return;
  warn_of_folder(vs_tree_child(circuit, vs_deck_key.key), w);
  for (size_t p = 0; p < deck->n_parts; p++) {
    const vs_node *named = vs_tree_child(circuit, deck->parts[p].name);
    const char *file = deck->parts[p].file; /* NULL: it was not found */
    if (named && named->text && file && !strcmp(named->text, file)) warn_of_folder(named, w);
  }
}

void vs_warnings_of_scene(const vs_node *root, const vs_setup *s, const vs_frame *frame,
                          vs_warnings *w) {
  const vs_deck *deck = frame->deck;
  warn_of_folders(root, deck, w);
  warn_below_theta(root, s, w);
  warn_of_long_pulses(root, s, w);
  warn_of_frequency(vs_tree_child(root, "supply"), s, w);
  warn_of_law(root, &s->model.coil, w);
  warn_of_growth(root, &s->model, w);
  warn_of_loads(s, w);
  warn_of_late_events(root, s, w);
  if (!deck) return;
  warn_of_generators(s, w);
  warn_of_repetition(root, s, w);
  vs_warnings_of_netlist(deck, w);
  /* a direct voltage is its own peak */
  double rms_v = s->timeline.supply.voltage_v / (s->timeline.supply.direct ? M_SQRT2 : 1);
  warn_of_parts(vs_tree_child(root, "circuit"), s, rms_v, w);
  warn_of_mains(deck, w);
  warn_of_supply(root, s, w);
  warn_of_bursts(vs_tree_child(root, "firing"), deck, w);
  warn_of_pwm(vs_tree_child(root, vs_pwm_section.name), &s->timeline, deck, w);
  vs_warnings_of_limits(deck, w);
}

/* A pulse at the control's largest angle may last until forward voltage is back, where one at
 * firing.angle does not. */
static void warn_of_late_pulses(const vs_node *section, const vs_setup *s, const vs_control *c,
                                vs_warnings *w) {
  const vs_timeline *t = &s->timeline;
  const vs_node *angle = vs_tree_child(section, "angle");
  double range[2], width_s = t->firing.pulse_width_s, latest_rad = c->v.angle_rad[1];
  vs_firing_range(t, range);
  double ends_s = latest_rad / t->omega_rad_s + width_s;
  if (ends_s <= t->period_s || range[1] / t->omega_rad_s + width_s > t->period_s) return;
  vs_fail_at(
      vs_warnings_add(w), angle ? angle->where : section->key_where,
      "control.angle: at %.6g deg the pulse lasts until %.6g ms, and forward voltage is back "
      "at %.6g ms: it may fire there, whatever the control decides; a shorter "
      "firing.pulse_width does not",
      latest_rad / vs_units_factor("deg"), 1e3 * ends_s, 1e3 * t->period_s);
}

void vs_warnings_of_control(const vs_node *root, const vs_setup *s, const vs_control *c,
                            const vs_instruments *instruments, vs_warnings *w) {
  const vs_node *section = vs_tree_child(root, vs_control_section.name);
  char text[512];
  if (!c->regulator) return;
  warn_of_late_pulses(section, s, c, w);
  if (vs_control_note(c, s, instruments, text, sizeof text))
    vs_fail_at(vs_warnings_add(w), place_of_value(vs_tree_child(section, "sensor")), "%s", text);
}

void vs_warnings_of_instruments(const vs_instruments *all, vs_warnings *w) {
  char text[512];
  const vs_instrument *first = vs_instruments_alias(all, text, sizeof text);
  if (first)
    vs_fail_at(vs_warnings_add(w), first->where,
               "instruments: the bandwidth is above half the rate of samples, so that faster parts "
               "of a signal show as slow ones (aliasing): %s",
               text);
}

/* ---- what can fire ---- */

/* No junction of silicon conducts where the mains drive less than this. An ideal thyristor does. */
static const double FAINT_V = 0.7;
static const char NO_CHANCE[] = "no gate pulse meets forward mains voltage";
static const char NO_CHANCE_OF_SILICON[] = "no gate pulse meets forward mains voltage above 0.7 V";

double vs_warnings_first_chance(const vs_setup *s, const vs_frame *frame, double until_s) {
  const vs_deck *deck = frame->deck;
  bool asked = !deck;
  double first_s = deck ? INFINITY : vs_wave_chance(&s->timeline, 0, 0, until_s);
  for (size_t k = 0; deck && k < deck->n_ports; k++) {
    const vs_signal *signal = &deck->ports[k].signal;
    if (signal->drive != VS_PORT_GATE && signal->drive != VS_PORT_BURST) continue;
    asked = true;
    first_s = fmin(first_s, vs_wave_chance(&s->timeline, signal->shift_rad, FAINT_V, until_s));
  }
  return asked ? first_s : NAN;
}

const char *vs_warnings_no_chance(const vs_frame *frame) {
  return frame->deck ? NO_CHANCE_OF_SILICON : NO_CHANCE;
}
