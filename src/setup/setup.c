/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "setup/setup.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "bounds/expansion.h"
#include "deck/eva.h"
#include "deck/netlist.h"
#include "deck/parts.h"
#include "dialect/words.h"
#include "drive/events.h"
#include "drive/firing.h"
#include "drive/signals.h"
#include "machine/blueprint.h"
#include "machine/build.h"
#include "machine/mechanics.h"
#include "setup/naming.h"
#include "syntax/units.h"

const char vs_setup_steady[] = "steady";

/* ---- the machine ---- */

/* The scene's node of the key machine.model, and the name that it gives. */
static const vs_node *machine_node(const vs_node *scene) {
  return vs_tree_child(vs_tree_child(scene, "machine"), vs_machine_key.key);
}

/* Reads the machine's file into an empty machine, of which a check has as much as can be read. */
static vs_status read_machine(const vs_node *scene, vs_machine *machine, vs_error *err) {
  const vs_node *named = machine_node(scene);
  const vs_section only_model = {"machine", &vs_machine_key, 1};
  const vs_node word = vs_tree_word(NULL, vs_machine_key.default_text, (vs_where){0});
  char path[VS_PATH_SIZE];
  vs_machine_values values;
  vs_machine_begin(machine);
  machine->lost = true;
  vs_status s = vs_field_read(&only_model, &vs_machine_key, named ? named : &word, &values, err);
  if (!s)
    s = vs_path_find(&vs_machine_shelf, values.model, named ? named->where : (vs_where){0}, path,
                     err);
  if (!s) s = vs_blueprint_read(path, machine, err);
  return s ? s : vs_naming_machine(machine, err);
}

/* True if the scene names the machine that the setup has. */
static bool keeps_machine(const vs_node *scene, const vs_setup *setup) {
  const vs_node *named = machine_node(scene);
  const char *had = setup->model.parameters.model;
  if (!setup->machine || setup->machine->lost || (named && named->kind != VS_NODE_TEXT))
    return false;
  return !strcmp(had, named ? named->text : vs_machine_key.default_text);
}

static void free_machine(vs_setup *setup) {
  if (!setup->machine) return;
  vs_machine_free(setup->machine);
  free(setup->machine);
  setup->machine = NULL;
}

static void forget(vs_setup *setup) {
  vs_actuator_end(&setup->model.coil);
  setup->model.coil = (vs_coil){0};
  vs_text_free(&setup->written);
  vs_memo_free(&setup->memo);
}

/* ---- the circuit ---- */

/* Reads the values of the section circuit, whose keys are its deck's parameters. */
static vs_status read_values(const vs_node *map, vs_setup *setup, vs_error *err) {
  vs_circuit_values *values = &setup->circuit_values;
  if (setup->deck.lost & VS_LOST_PARAM) map = NULL; /* a key may be that one's */
  vs_status s = vs_memo_read(&setup->memo, &setup->deck.section, map, values, sizeof *values, err);
  vs_deck_value standard[VS_STANDARD];
  vs_setup_standard(setup, standard);
  size_t found = vs_error_count(err);
  if (!s) s = vs_deck_bind(&setup->deck, values, standard, VS_STANDARD, err);
  return s || vs_error_count(err) > found ? s
                                          : vs_parts_require_hold(&setup->deck, values, map, err);
}

/* Reads the section circuit: first its key `deck`, then all of it, as that deck's parameters are
 * its other keys. */
static vs_status read_circuit(const vs_node *scene, vs_setup *setup, vs_error *err) {
  const vs_node *map = vs_tree_child(scene, "circuit"),
                *named = vs_tree_child(map, vs_deck_key.key);
  const vs_section only_deck = {"circuit", &vs_deck_key, 1};
  const vs_node word = vs_tree_word(NULL, vs_deck_key.default_text, (vs_where){0});
  char path[VS_PATH_SIZE];
  vs_circuit_values *values = &setup->circuit_values;
  vs_status s = vs_field_read(&only_deck, &vs_deck_key, named ? named : &word, values, err);
  if (!s)
    s = vs_path_find(&vs_deck_shelf, values->deck, named ? named->where : (vs_where){0}, path, err);
  if (!s) s = vs_netlist_read(path, &setup->deck, err);
  if (s) {
    setup->deck.lost = VS_LOST_ALL;
    return s;
  }
  s = vs_netlist_read_parts(&setup->deck, map, err);
  if (!s) s = vs_naming_deck(&setup->model, &setup->deck, err);
  return s ? s : read_values(map, setup, err);
}

/* ngspice has no resistor of 0 ohm: it takes 1 mohm in its place. */
double vs_setup_source_ohm(const vs_setup *setup) {
  const double r_ohm = setup->timeline.supply.resistance_ohm;
  return r_ohm > 0 ? r_ohm : 1e-3;
}

void vs_setup_standard(const vs_setup *setup, vs_deck_value standard[VS_STANDARD]) {
  const vs_supply_values *supply = &setup->timeline.supply;
  const double values[] = {
      [VS_STANDARD_U_RMS] = supply->voltage_v,
      [VS_STANDARD_F_MAINS] = supply->frequency_hz,
      [VS_STANDARD_PHASE] = supply->phase_rad,
      [VS_STANDARD_R_SOURCE] = vs_setup_source_ohm(setup),
      [VS_STANDARD_L_SOURCE] = supply->inductance_h + supply->decoupling_h,
      [VS_STANDARD_EVA_RESISTANCE] = setup->model.actuator.resistance_ohm,
      [VS_STANDARD_EVA_A] = setup->model.coil.a_hm,
  };
  _Static_assert(sizeof values / sizeof *values == VS_STANDARD, "a value for each name");
  for (int k = 0; k < VS_STANDARD; k++)
    standard[k] = (vs_deck_value){vs_deck_standard_names[k], values[k]};
}

/* Error: a decoupling inductance for a deck whose elements do not use l_source, of which it is a
 * part. */
static vs_status check_decoupling(const vs_node *scene, const vs_setup *setup, vs_error *err) {
  const char *name = vs_deck_standard_names[VS_STANDARD_L_SOURCE];
  const vs_deck *deck = &setup->deck;
  if (!(setup->timeline.supply.decoupling_h > 0) || deck->lost) return VS_OK;
  for (size_t k = 0; k < deck->n_lines; k++)
    if (vs_words_find(deck->lines[k].text, deck->lines[k].text, name, strlen(name))) return VS_OK;
  return vs_fail_at(err, vs_tree_place(scene, "supply.decoupling"),
                    "supply.decoupling: the deck has no element of {%s}, of which it would be a "
                    "part; give the mains' lead one, as 'Lsource s1 a {%s} ic=0'",
                    name, name);
}

/* Error: load.fraction is auto, and the scene has no orbit with which it could be found. */
static vs_status check_fraction(const vs_node *scene, const vs_setup *setup, vs_error *err) {
  const vs_timeline *line = &setup->timeline;
  const char *why = NULL;
  if (!setup->wants_fraction) return VS_OK;
  if (line->supply.direct) why = "and direct voltage (supply.kind: step) has none";
  if (!line->firing.no_valve && !line->firing.every)
    why = "and firing.every is 'once'; write firing.every: 1";
  if (line->firing.angle.count > 0)
    why = "and firing.angle is a table over time, which has none; write one angle";
  if (vs_deck_has_port(&setup->deck, vs_port_is_modulated))
    why = "and no orbit is sought where the deck has a port pwm";
  if (!why) return VS_OK;
  return vs_fail_at(err, vs_tree_place(scene, "load.fraction"),
                    "load.fraction: auto is found on the machine's orbit, %s, or a number here",
                    why);
}

/* Refuses, where the key stands or else at `map`, what leaves `start: steady` without a meaning. */
static vs_status check_steady(const vs_node *scene, const vs_setup *setup, const vs_node *map,
                              vs_error *err) {
  const vs_timeline *line = &setup->timeline;
  const vs_firing_values *firing = &line->firing;
  const char *section = "firing", *key = "every", *why = NULL;
  if (vs_deck_has_port(&setup->deck, vs_port_is_modulated))
    section = "circuit", key = "deck",
    why = "no orbit is sought where the deck has a port pwm; write start: {NAME: VALUE, ...}";
  else if (line->supply.direct)
    section = "supply", key = "kind", why = "direct voltage has no cycles, and so no orbit";
  else if (!firing->no_valve && !firing->every)
    why = "an orbit wants a firing in every cycle, and this is 'once'; write firing.every: 1";
  else if (firing->angle.count > 0)
    key = "angle", why = "an orbit has one angle, and this is a table over time";
  else if (!firing->no_valve && firing->first_cycle != 1)
    key = "first_cycle", why = "an orbit has a firing in the first cycle; leave the key out";
  else if (line->supply.phase_rad != 0)
    section = "supply", key = "phase",
    why = "an orbit begins at the mains' rise through zero; write 0 deg, or leave the key out";
  if (!why) return VS_OK;
  const vs_node *node = vs_tree_child(vs_tree_child(scene, section), key);
  return vs_fail_at(err, node ? node->where : map->where, "%s.%s: start is steady: %s", section,
                    key, why);
}

/* Reads `start: steady`. Error: another word stands there. */
static vs_status read_steady(const vs_node *scene, const vs_node *map, vs_setup *setup,
                             vs_error *err) {
  vs_status s = VS_OK;
  if (strcmp(map->text, vs_setup_steady))
    s = vs_fail_at(err, map->where,
                   "start: '%s' is neither 'steady' nor a map of coordinates: {%s: 0, ...}",
                   map->text, setup->machine->coordinates[0].name);
  setup->steady = !s;
  if (!s) s = check_steady(scene, setup, map, err);
  return vs_error_carry_on(err, s);
}

/* Reads the section start. Error: the armature would begin beyond the pole cover, or beyond the
 * iron where there is a stop. */
static vs_status read_start(const vs_node *scene, vs_setup *setup, vs_error *err) {
  const vs_model *m = &setup->model;
  const vs_section *section = &m->machine->start;
  const vs_node *map = vs_tree_child(scene, section->name), *key = NULL;
  const vs_actuator_values *a = &m->actuator;
  vs_status s = VS_OK;
  setup->steady = setup->at_work = false;
  if (m->machine->lost) return VS_OK;
  if (map && map->kind == VS_NODE_TEXT && *map->text) {
    s = read_steady(scene, map, setup, err);
    map = NULL;
  }
  if (!s) s = vs_memo_read(&setup->memo, section, map, &setup->start, sizeof setup->start, err);
  if (s || vs_error_count(err) || !m->coil.law->poles) return s; /* of the gap, perhaps */
  double least = -(a->gap_m + (m->stops.count ? a->pole_cover_m : 0));
  double g = vs_mechanics_travel(m, setup->start.x);
  if (g > least) return s;
  for (int i = 0; i < m->dof && !key; i++)
    if (m->along[i] != 0) key = vs_tree_child(map, m->machine->coordinates[i].name);
  return vs_fail_at(err, key ? key->where : vs_tree_place(scene, section->name),
                    "start.%s: %g mm is beyond the pole cover%s; allowed: more than %g mm",
                    key ? key->key : "", 1e3 * g, m->stops.count ? " and the iron" : "",
                    1e3 * least);
}

/* Reads the section measure. Errors: those of vs_manner_means. */
static vs_status read_means(const vs_node *scene, vs_setup *setup, vs_error *err) {
  const vs_node *map = vs_tree_child(scene, vs_manner_measure.name);
  vs_measure_values *v = &setup->measure;
  double until_s = setup->run.until_s;
  setup->means = (vs_span_s){0, until_s};
  size_t found = vs_error_count(err);
  vs_status s = vs_memo_read(&setup->memo, &vs_manner_measure, map, v, sizeof *v, err);
  if (s || vs_error_count(err) > found || !map || map->kind != VS_NODE_MAP) return s;
  return vs_manner_means(v, map, until_s, setup->timeline.period_s, &setup->means, err);
}

/* Reads the section limits, and holds a deck that was just read to it. */
static vs_status read_limits(const vs_node *scene, vs_setup *setup, bool has_deck, vs_error *err) {
  const vs_node *map = vs_tree_child(scene, vs_limits_section.name);
  vs_limits_values *v = &setup->limits;
  size_t found = vs_error_count(err);
  vs_status s = vs_memo_read(&setup->memo, &vs_limits_section, map, v, sizeof *v, err);
  if (s || has_deck || vs_error_count(err) > found) return s;
  return vs_error_carry_on(err, vs_expansion_check(&setup->deck, v->devices, err));
}

/* The EVA begins without a current. */
static void begin_eva(vs_setup *setup) {
  const vs_model *m = &setup->model;
  setup->deck.eva_flux_wb = vs_coil_idle_flux(&m->coil, vs_mechanics_gap(m, setup->start.x));
}

/* A run in which something happens after the circuit may have been left wants an EVA that can be
 * led back. Leaving takes a few cycles, so fewer than four between two firings are not worth it. An
 * EVA that an event has put in its place stays. has_motions: the deck's motions are known already.
 */
static vs_status choose_eva(vs_setup *setup, bool has_motions, vs_error *err) {
  bool again = setup->timeline.firing.every >= 4 || setup->timeline.events.count;
  setup->deck.eva_led = again && !setup->deck.eva_file && setup->model.coil.square;
  if (vs_error_count(err)) return VS_OK; /* there may be no coil */
  vs_eva_take_law(&setup->deck, &setup->model.coil);
  begin_eva(setup);
  vs_status s = vs_error_carry_on(err, vs_eva_check_names(&setup->deck, &setup->model.coil, err));
  if (!s && !has_motions)
    s = vs_error_carry_on(err, vs_eva_take_motions(&setup->deck, setup->machine, err));
  return s;
}

/* Builds all of it; with has_deck the deck's text is there already, and so is a machine that the
 * setup has. */
static vs_status build(const vs_node *scene, vs_setup *setup, bool has_deck, vs_error *err) {
  vs_status s = VS_OK;
  const bool has_machine = setup->machine;
  if (!has_machine) {
    setup->machine = vs_alloc(1, sizeof *setup->machine);
    s = vs_error_carry_on(err, read_machine(scene, setup->machine, err));
  }
  if (!s)
    s = vs_error_carry_on(
        err, vs_build_again(scene, setup->machine, &setup->model, &setup->written, err));
  if (!s)
    s = vs_error_carry_on(
        err, vs_timeline_build(scene, setup->machine, &setup->timeline, &setup->memo, err));
  if (!s && has_deck)
    s = read_values(vs_tree_child(scene, "circuit"), setup, err);
  else if (!s)
    s = vs_error_carry_on(err, read_circuit(scene, setup, err));
  if (!s)
    s = vs_memo_read(&setup->memo, &vs_manner_run, vs_tree_child(scene, "run"), &setup->run,
                     sizeof setup->run, err);
  if (!s) s = read_limits(scene, setup, has_deck, err);
  vs_timeline *line = &setup->timeline;
  if (!s)
    s = vs_error_carry_on(err, vs_timeline_settle(scene, setup->machine, line, &setup->deck, err));
  if (!s)
    s = vs_events_read(vs_tree_child(scene, "events"), line, setup->run.until_s, &line->events,
                       err);
  if (!s) s = vs_error_carry_on(err, check_decoupling(scene, setup, err));
  if (!s) s = vs_cooling_read(scene, &setup->deck, &setup->cooling, err);
  if (!s) s = vs_events_wire(&line->events, &setup->deck, err);
  if (!s && !setup->machine->lost && !vs_error_count(err))
    s = vs_error_carry_on(
        err, vs_loads_make(&line->events, setup->machine, &setup->model, &setup->loads, err));
  setup->wants_fraction = isnan(setup->model.load.fraction);
  if (!s) s = vs_error_carry_on(err, check_fraction(scene, setup, err));
  if (!s) s = vs_error_carry_on(err, read_start(scene, setup, err));
  if (!s) s = vs_error_carry_on(err, read_means(scene, setup, err));
  if (!s) s = choose_eva(setup, has_deck && has_machine, err);
  return s;
}

vs_status vs_setup_build(const vs_node *scene, vs_setup *setup, vs_error *err) {
  if (setup->begun) *setup = (vs_setup){0};
  setup->begun = true;
  vs_status s = build(scene, setup, false, err);
  if (s) setup->deck.lost = VS_LOST_ALL; /* so that vs_setup_again reads it anew */
  return s;
}

bool vs_setup_keeps_deck(const vs_node *scene, const vs_setup *setup) {
  const vs_node *map = vs_tree_child(scene, "circuit"), *events = vs_tree_child(scene, "events");
  const vs_deck *deck = &setup->deck;
  if (!deck->n_files || deck->lost || setup->timeline.events.count || (events && events->child))
    return false;
  for (size_t k = 0; k < deck->section.count; k++) {
    const vs_field *field = &deck->section.fields[k];
    const vs_node *node = vs_tree_child(map, field->key);
    const char *had = (const char *)&setup->circuit_values + field->offset;
    if (field->kind != VS_NAME) continue;
    if (node && node->kind != VS_NODE_TEXT) return false;
    if (strcmp(had, node ? node->text : field->default_text) != 0) return false;
  }
  return true;
}

vs_status vs_setup_again(const vs_node *scene, vs_setup *setup, vs_error *err) {
  bool keeps = vs_setup_keeps_deck(scene, setup);
  if (!keeps || !keeps_machine(scene, setup)) forget(setup);
  if (!keeps_machine(scene, setup)) free_machine(setup);
  vs_loads_free(&setup->loads);
  if (!keeps) {
    vs_deck_free(&setup->deck);
    *setup = (vs_setup){.begun = true, .machine = setup->machine};
  }
  vs_status s = build(scene, setup, keeps, err);
  if (s) setup->deck.lost = VS_LOST_ALL; /* so that it is read anew the next time */
  return s;
}

void vs_setup_free(vs_setup *setup) {
  forget(setup);
  free_machine(setup);
  vs_loads_free(&setup->loads);
  vs_deck_free(&setup->deck);
}

vs_setup vs_setup_varied(const vs_setup *from, const vs_run_values *run,
                         const double x[VS_MOST_STATES]) {
  vs_setup setup = *from;
  setup.run = *run;
  if (run->until_s != from->run.until_s) setup.means = (vs_span_s){0, run->until_s};
  if (x) memcpy(setup.start.x, x, sizeof setup.start.x);
  if (x) setup.steady = false;
  begin_eva(&setup);
  return setup;
}

double vs_setup_edge(const vs_setup *setup, double t_s) {
  double next_s = vs_events_edge(&setup->timeline.events, t_s);
  for (size_t k = 0; k < setup->deck.n_ports; k++) {
    const vs_signal *s = &setup->deck.ports[k].signal;
    next_s = fmin(next_s, vs_signals_edge(&setup->timeline, s, t_s));
  }
  double known_s = vs_firing_known_s(&setup->timeline);
  return known_s > t_s + vs_occurrence_rounding(t_s) ? fmin(next_s, known_s) : next_s;
}

bool vs_setup_found_fraction(const vs_setup *setup) {
  return isnan(setup->model.load.fraction) && !setup->wants_fraction;
}

vs_status vs_setup_require_fraction(const vs_setup *setup, vs_where where, const char *who,
                                    vs_error *err) {
  if (!setup->wants_fraction) return VS_OK;
  return vs_fail_at(err, where,
                    "load.fraction: auto: %s wants a number; run, studies and steady find one, and "
                    "print it",
                    who);
}

double vs_setup_jams(const vs_setup *setup) {
  const vs_events *events = &setup->timeline.events;
  double first_s = INFINITY;
  for (size_t k = 0; k < events->count; k++)
    if (events->item[k].kind->jams) first_s = fmin(first_s, events->item[k].start_s);
  return first_s;
}

double vs_setup_coil_cut(const vs_setup *setup) {
  const vs_events *events = &setup->timeline.events;
  double first_s = INFINITY;
  for (size_t k = 0; k < events->count; k++) {
    const vs_occurrence *e = &events->item[k];
    if (e->kind->cuts && !strcasecmp(e->kind->element(e, &setup->deck), setup->deck.eva))
      first_s = fmin(first_s, e->start_s);
  }
  return first_s;
}
