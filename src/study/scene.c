/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "study/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/units.h"

const vs_shelf vs_scene_shelf = {"scene", "scenes", ".yaml"},
               vs_study_shelf = {"study", "studies", ".yaml"};

vs_scene_part vs_scene_part_at(const vs_scene *s, int index) {
  const vs_setup *u = &s->setup;
#define PART(section, values)                                                                      \
  { &section, &values, sizeof values }
  const vs_scene_part parts[VS_SCENE_PARTS] = {PART(vs_machine_section, u->model.machine),
                                               PART(vs_actuator_section, u->model.actuator),
                                               PART(vs_load_section, u->model.load),
                                               PART(vs_supply_section, u->timeline.supply),
                                               PART(vs_firing_section, u->timeline.firing),
                                               PART(u->deck.section, u->circuit_values),
                                               PART(vs_run_section, u->run),
                                               PART(vs_start_section, u->start),
                                               PART(vs_measure_section, u->measure)};
#undef PART
  return parts[index];
}

/* Keys of sections that every tier has, but that only the circuit tier obeys: alone it has a
 * source's impedance, ngspice, a gate drive that is fed with bursts, and devices with means and
 * ratings. What is on no other tier either way (run.verify: never) is no conflict. */
typedef struct circuit_key {
  const char *section, *key;
  const char *value; /* only this one; NULL: any */
} circuit_key;
static const circuit_key CIRCUIT_KEYS[] = {
    {"supply", "resistance", NULL},    {"supply", "inductance", NULL},
    {"run", "method", NULL},           {"run", "trtol", NULL},
    {"run", "pivrel", NULL},           {"run", "leave_circuit", NULL},
    {"run", "ladder", NULL},           {"run", "verify", "always"},
    {"firing", "burst_frequency", NULL}, {"firing", "burst_duty", NULL},
    {"measure", "from", NULL},         {"measure", "to", NULL},
    {"measure", "last", NULL},
};
enum { N_CIRCUIT_KEYS = sizeof CIRCUIT_KEYS / sizeof *CIRCUIT_KEYS };

static const vs_node *node_of(const vs_scene *s, const circuit_key *k) {
  const vs_node *node = vs_node_child(vs_node_child(s->tree.root, k->section), k->key);
  if (!node || !k->value) return node;
  return node->kind == VS_NODE_TEXT && !strcmp(node->text, k->value) ? node : NULL;
}

/* Its first probe that only the circuit tier has; NULL: none. */
static const char *probe_of_circuit(const vs_scene *s) {
  const vs_node *record = vs_node_child(s->tree.root, "record");
  const vs_frame circuit_frame = vs_tier_circuit.frame(&s->setup);
  const vs_node *item = record && record->kind == VS_NODE_LIST ? record->child : record;
  for (; item; item = item->next)
    if (item->kind == VS_NODE_TEXT && vs_channel_find(&circuit_frame, item->text) >= VS_CH_DECK)
      return item->text;
  return NULL;
}

/* Of the scene's events the first that no other tier has; if there is none, the first; NULL: it has
 * no events. */
static const vs_occurrence *first_event(const vs_scene *s) {
  const vs_events *events = &s->setup.timeline.events;
  for (size_t k = 0; k < events->count; k++)
    if (!events->item[k].kind->ideal) return &events->item[k];
  return events->count ? events->item : NULL;
}

/* Why the scene needs the circuit tier: what it names that only that one has, or tells all of.
 * NULL: it does not. */
static const char *needs_circuit(const vs_scene *s, char *buffer, size_t size) {
  static const char *const HAS = "which only this tier has";
  const vs_node *circuit = vs_node_child(s->tree.root, "circuit");
  const vs_occurrence *event = first_event(s);
  const char *probe = probe_of_circuit(s);
  const circuit_key *key = NULL;
  for (size_t k = 0; k < N_CIRCUIT_KEYS && !key; k++)
    if (node_of(s, &CIRCUIT_KEYS[k])) key = &CIRCUIT_KEYS[k];
  if (circuit && circuit->child)
    snprintf(buffer, size, "circuit.%s, %s", circuit->child->key, HAS);
  else if (key)
    snprintf(buffer, size, "%s.%s, %s", key->section, key->key, HAS);
  else if (event)
    snprintf(buffer, size, "events.%s, %s", event->name,
             event->kind->ideal ? "and only this tier tells how the devices bear it" : HAS);
  else if (probe)
    snprintf(buffer, size, "probe %s, %s", probe, HAS);
  else
    return NULL;
  return buffer;
}

/* ---- what a tier that was asked for would ignore ---- */

static vs_status ignored_key(const vs_scene *s, const char *section, const vs_node *node,
                             vs_error *err) {
  if (!node) return VS_OK;
  return vs_carry_on(err, vs_fail_at(err, node->key_where,
                                     "%s.%s: tier %s (%s) has no circuit and would ignore it; take "
                                     "tier circuit or auto, or leave the key out",
                                     section, node->key, s->tier->name, s->why));
}

static vs_status ignored_event(const vs_scene *s, const vs_occurrence *e, vs_error *err) {
  bool other = !isnan(e->gate_rad) && !vs_event_at_gate(e, 0);
  if (e->kind->ideal && !other) return VS_OK;
  if (e->kind->ideal)
    vs_fail_at(err, e->where,
               "events.%s.gate: tier %s (%s) has one thyristor, whose gate is 'gate', and would "
               "ignore %s; take tier circuit or auto",
               e->name, s->tier->name, s->why, e->v.gate);
  else
    vs_fail_at(err, e->where,
               "events.%s: tier %s (%s) has an ideal thyristor between mains and coil, to which a "
               "%s is nothing; take tier circuit or auto",
               e->name, s->tier->name, s->why, e->kind->name);
  return vs_carry_on(err, VS_INPUT);
}

/* The deck's name alone is no conflict: it says what the tiers stand for. */
static vs_status check_ignored(const vs_scene *s, vs_error *err) {
  const vs_node *circuit = vs_node_child(s->tree.root, "circuit");
  const vs_events *events = &s->setup.timeline.events;
  vs_status status = VS_OK;
  if (s->tier == &vs_tier_circuit) return VS_OK;
  for (const vs_node *n = circuit ? circuit->child : NULL; n && !status; n = n->next)
    if (strcmp(n->key, vs_deck_key.key)) status = ignored_key(s, "circuit", n, err);
  for (size_t k = 0; k < N_CIRCUIT_KEYS && !status; k++)
    status = ignored_key(s, CIRCUIT_KEYS[k].section, node_of(s, &CIRCUIT_KEYS[k]), err);
  for (size_t k = 0; k < events->count && !status; k++)
    status = ignored_event(s, &events->item[k], err);
  return status;
}

/* A check carries on from a run.tier that is none; what is meant is then not known. */
static bool tier_is_known(const vs_scene *s) {
  const vs_node *word = vs_node_child(vs_node_child(s->tree.root, "run"), "tier");
  return !word || s->setup.run.tier > 0 ||
         (word->kind == VS_NODE_TEXT && !strcmp(word->text, "auto"));
}

static vs_status choose_tier(vs_scene *s, const char *named, vs_error *err) {
  char what[200];
  int choice = s->setup.run.tier;
  if (named && !strcmp(named, "auto"))
    choice = 0;
  else if (named) {
    s->tier = vs_tier_find(named);
    if (!s->tier)
      return vs_fail(err, VS_INPUT, "--tier %s: there are: auto, analytic, switched, circuit",
                     named);
    snprintf(s->why, sizeof s->why, "asked for by --tier");
    return VS_OK;
  }
  if (choice > 0) {
    s->tier = vs_tiers[choice - 1];
    snprintf(s->why, sizeof s->why, "asked for by run.tier");
  } else if (!tier_is_known(s)) {
    s->tier = &vs_tier_circuit; /* it has all probes */
  } else if (needs_circuit(s, what, sizeof what)) {
    s->tier = &vs_tier_circuit;
    snprintf(s->why, sizeof s->why, "auto: the scene names %s", what);
  } else {
    s->tier = &vs_tier_switched;
    snprintf(s->why, sizeof s->why, "auto: nothing in the scene needs the circuit tier");
  }
  return VS_OK;
}

static vs_status unknown_probe(const vs_scene *s, const vs_node *node, vs_error *err) {
  vs_frame full = vs_tier_circuit.frame(&s->setup);
  const char *names[VS_CH_MOST];
  size_t n = 0;
  const char *name = node->kind == VS_NODE_TEXT ? node->text : "a list or map";
  if (s->setup.deck.lost & VS_LOST_PROBE) return VS_OK; /* a check carries on: it may be that one */
  if (vs_channel_find(&full, name) >= 0)
    return vs_fail_at(err, node->where,
                      "record: probe %s exists only on tier circuit, and this is tier %s", name,
                      s->tier->name);
  for (int k = 0; k < vs_channel_count(&full); k++)
    if (vs_channel_at(&full, k).listed) names[n++] = vs_channel_at(&full, k).name;
  const char *nearest = vs_nearest(name, names, n);
  return vs_fail_at(err, node->where, "record: no probe '%s'%s%s%s", name,
                    nearest ? "; did you mean '" : "", nearest ? nearest : "",
                    nearest ? "'?" : "; see 'vibrospice list probes'");
}

static vs_status take_probe(vs_scene *s, const vs_node *node, vs_error *err) {
  int channel = node->kind == VS_NODE_TEXT ? vs_channel_find(&s->frame, node->text) : -1;
  if (channel < 0) return unknown_probe(s, node, err);
  for (int k = 0; k < s->n_record; k++)
    if (s->record[k] == channel)
      return vs_fail_at(err, node->where, "record: probe %s stands here a second time", node->text);
  s->record[s->n_record++] = channel;
  return VS_OK;
}

/* record: all | [NAME, ...] */
static vs_status read_record(vs_scene *s, vs_error *err) {
  const vs_node *node = vs_node_child(s->tree.root, "record");
  if (!node || (node->kind == VS_NODE_TEXT && (!*node->text || !strcmp(node->text, "all")))) {
    for (int k = 0; k < vs_channel_count(&s->frame); k++)
      if (vs_channel_at(&s->frame, k).listed) s->record[s->n_record++] = k;
    return VS_OK;
  }
  if (node->kind == VS_NODE_MAP || (node->kind == VS_NODE_LIST && !node->child))
    return vs_fail_at(err, node->where,
                      "record: 'all' or a list of probes is wanted: [p, i, v_ak]");
  if (node->kind == VS_NODE_TEXT) return take_probe(s, node, err);
  vs_status status = VS_OK;
  for (const vs_node *item = node->child; item && !status; item = item->next)
    status = vs_carry_on(err, take_probe(s, item, err));
  return status;
}

/* measured: {NAME: VALUE UNIT, ...} */
static vs_status read_measured(vs_scene *s, vs_error *err) {
  const vs_node *map = vs_node_child(s->tree.root, "measured");
  const char *names[VS_MEASURES];
  if (map && map->kind == VS_NODE_TEXT && !*map->text) map = NULL;
  if (map && map->kind != VS_NODE_MAP)
    return vs_fail_at(err, map->where, "measured: a map is wanted: {i_peak: 0.95 A, ...}");
  for (size_t k = 0; k < VS_MEASURES; k++) names[k] = vs_measures_known[k].name;
  vs_status status = vs_known_keys(map, "measured", names, VS_MEASURES, err);
  for (size_t k = 0; k < VS_MEASURES && !status; k++) {
    const vs_node *node = vs_node_child(map, names[k]);
    char why[256];
    if (!node) continue;
    s->measured[k].known = true;
    if (node->kind != VS_NODE_TEXT ||
        !vs_quantity(node->text, vs_measures_known[k].unit, &s->measured[k].value, why, sizeof why))
      status =
          vs_carry_on(err, vs_fail_at(err, node->where, "measured.%s: %s", names[k],
                                      node->kind == VS_NODE_TEXT ? why : "one value is wanted"));
  }
  return status;
}

static vs_status check_tolerance(const vs_scene *s, vs_error *err) {
  const vs_node *node = vs_node_child(vs_node_child(s->tree.root, "run"), "tolerance");
  if (s->setup.run.tolerance >= s->tier->finest || !tier_is_known(s)) return VS_OK;
  return vs_fail_at(err, node ? node->where : (vs_where){0},
                    "run.tolerance: %g is finer than tier %s can hold; allowed there: %g..0.1",
                    s->setup.run.tolerance, s->tier->name, s->tier->finest);
}

enum { MOST_ROWS = 1000000000 }; /* of run.csv: some hundred gigabytes */

static vs_status check_rows(const vs_scene *s, vs_error *err) {
  const vs_run_values *run = &s->setup.run;
  const vs_node *map = vs_node_child(s->tree.root, "run"), *node = vs_node_child(map, "sample");
  if (run->until_s / run->sample_s <= MOST_ROWS) return VS_OK;
  if (!node) node = vs_node_child(map, "until");
  return vs_fail_at(err, node ? node->where : (vs_where){0},
                    "run.sample: %g ms makes %.3g rows up to run.until = %g s; allowed there: "
                    "at least %g ms, for %d rows",
                    1e3 * run->sample_s, run->until_s / run->sample_s, run->until_s,
                    1e3 * run->until_s / MOST_ROWS, MOST_ROWS);
}

/* Eqs. 92, 93: theta = atan(w L(0)/R_c) <= alpha* */
static void warn_below_theta(vs_scene *s) {
  const vs_setup *u = &s->setup;
  double theta = atan2(u->timeline.omega_rad_s * u->model.actuator.inductance_h,
                       u->model.actuator.resistance_ohm);
  const vs_node *angle = vs_node_child(vs_node_child(s->tree.root, "firing"), "angle");
  if (u->timeline.firing.angle_rad >= theta) return;
  vs_fail_at(&s->warnings[s->n_warnings++], angle ? angle->where : (vs_where){0},
             "firing.angle = %.6g deg is below theta = %.6g deg, the lower end of the control "
             "range (Eq. 92): "
             "the thyristor conducts as Eq. 91 says, for more than 180 deg",
             u->timeline.firing.angle_rad / vs_unit_factor("deg"), theta / vs_unit_factor("deg"));
}

/* The energy drawn from the mains is what the port mains gives. */
const char *vs_scene_without_mains(const vs_deck *deck) {
  if (deck->lost & VS_LOST_PORT) return NULL;
  for (size_t k = 0; k < deck->n_ports; k++)
    if (deck->ports[k].signal.drive == VS_DRIVE_MAINS) return NULL;
  return "no port mains, so that energy_in, what is drawn from the mains, is 0 J, and "
         "supply.voltage "
         "drives nothing";
}

static void warn_of_mains(vs_scene *s) {
  const vs_deck *deck = s->frame.deck;
  const char *text = deck ? vs_scene_without_mains(deck) : NULL;
  const char *file = deck && deck->n_files ? deck->files[0] : NULL;
  if (text)
    vs_fail_at(&s->warnings[s->n_warnings++], (vs_where){.file = file}, "the deck has %s", text);
}

/* Sub-pulses that no source of the deck's is driven with. */
static void warn_of_bursts(vs_scene *s) {
  static const char *const KEYS[] = {"burst_frequency", "burst_duty"};
  const vs_node *firing = vs_node_child(s->tree.root, "firing");
  const vs_deck *deck = s->frame.deck;
  const vs_node *node = NULL;
  for (size_t k = 0; k < sizeof KEYS / sizeof *KEYS && !node; k++)
    node = vs_node_child(firing, KEYS[k]);
  if (!deck || !node || (deck->lost & VS_LOST_PORT)) return;
  for (size_t k = 0; k < deck->n_ports; k++)
    if (deck->ports[k].signal.drive == VS_DRIVE_BURST) return;
  vs_fail_at(&s->warnings[s->n_warnings++], node->key_where,
             "firing.%s: the deck has no port burst, so that nothing is driven with sub-pulses",
             node->key);
}

static void warn_of_limits(vs_scene *s) {
  const vs_deck *deck = s->frame.deck;
  char text[VS_DECK_TEXT + VS_NAME_SIZE];
  size_t said = 0;
  for (size_t k = 0; deck && k < deck->n_limits && said < VS_IDLE_LIMITS; k++)
    if (vs_limit_is_idle(deck, k, text, sizeof text)) {
      vs_fail_at(&s->warnings[s->n_warnings++], deck->limits[k].where, "%s", text);
      said++;
    }
}

static void warn_of_parts(vs_scene *s) {
  const vs_deck *deck = s->frame.deck;
  const vs_node *map = vs_node_child(s->tree.root, "circuit");
  char text[2 * VS_DECK_TEXT + VS_NAME_SIZE];
  for (size_t p = 0; deck && p < deck->n_parts; p++) {
    const vs_node *named = vs_node_child(map, deck->parts[p].name);
    if (vs_part_below_mains(deck, p, s->setup.timeline.supply.voltage_v, text, sizeof text))
      vs_fail_at(&s->warnings[s->n_warnings++], named ? named->where : (vs_where){0}, "%s", text);
  }
  for (size_t d = 0; deck && d < deck->n_devices; d++)
    if (vs_device_fails_ward(deck, d, text, sizeof text)) {
      const vs_node *named = vs_node_child(map, deck->parts[deck->devices[d].part].name);
      vs_fail_at(&s->warnings[s->n_warnings++], named ? named->where : (vs_where){0}, "%s", text);
    }
  warn_of_mains(s);
  warn_of_bursts(s);
  warn_of_limits(s);
}

/* All that can be warned of before a run. */
static void warn(vs_scene *s) {
  s->n_warnings = 0;
  warn_below_theta(s);
  warn_of_parts(s);
}

void vs_scene_warn(const vs_scene *s) {
  for (size_t k = 0; k < s->n_warnings; k++)
    fprintf(stderr, "vibrospice: warning: %s\n", s->warnings[k].text + s->warnings[k].place_size);
}

vs_status vs_scene_open(const char *name, vs_where where, vs_scene *s, vs_error *err) {
  *s = (vs_scene){0};
  vs_status status = vs_find(&vs_scene_shelf, name, where, s->path, err);
  return status ? status : vs_tree_read(s->path, &s->tree, err);
}

/* What follows from the setup. */
static vs_status conclude(vs_scene *s, const char *tier, vs_error *err) {
  vs_status status = choose_tier(s, tier, err);
  if (status) return status;
  s->frame = s->tier->frame(&s->setup);
  status = check_ignored(s, err);
  if (!status) status = vs_carry_on(err, check_tolerance(s, err));
  if (!status) status = vs_carry_on(err, check_rows(s, err));
  return status;
}

vs_status vs_scene_settle(vs_scene *s, const char *tier, vs_error *err) {
  static const char *const TOP[] = {"machine", "actuator", "load",     "supply",
                                    "firing",  "circuit",  "events",   "run",
                                    "start",   "record",   "measured", "measure"};
  vs_status status = vs_known_keys(s->tree.root, "a scene", TOP, sizeof TOP / sizeof *TOP, err);
  s->tier_named = tier;
  if (!status) status = vs_setup_build(s->tree.root, &s->setup, err);
  if (!status) status = conclude(s, tier, err);
  if (status) return status;
  status = vs_carry_on(err, read_record(s, err));
  if (!status) status = read_measured(s, err);
  warn(s);
  return status;
}

vs_status vs_scene_again(vs_scene *s, vs_error *err) {
  vs_status status = vs_setup_again(s->tree.root, &s->setup, err);
  if (!status) status = conclude(s, NULL, err);
  if (!status) warn(s);
  return status;
}

vs_status vs_scene_with(const vs_scene *s, const char *const *keys, size_t n_keys, vs_scene *other,
                        vs_error *err) {
  *other = (vs_scene){0};
  memcpy(other->path, s->path, sizeof other->path);
  vs_tree_copy(&s->tree, &other->tree);
  vs_status status = VS_OK;
  for (size_t k = 0; k < n_keys && !status; k++) status = vs_tree_set(&other->tree, keys[k], err);
  if (!status) status = vs_scene_settle(other, s->tier_named, err);
  return status || !s->asks ? status : vs_scene_take_circuit(other, s->asks, err);
}

vs_status vs_scene_read(const char *name, char *const *sets, size_t n_sets, const char *tier,
                        vs_scene *s, vs_error *err) {
  vs_status status = vs_scene_open(name, (vs_where){0}, s, err);
  for (size_t k = 0; k < n_sets && !status; k++)
    status = vs_carry_on(err, vs_tree_set(&s->tree, sets[k], err));
  return status ? status : vs_scene_settle(s, tier, err);
}

vs_status vs_scene_take_circuit(vs_scene *s, const char *asks, vs_error *err) {
  const char *tier = s->tier_named;
  s->asks = asks;
  if (s->tier == &vs_tier_circuit) return VS_OK;
  if (tier ? strcmp(tier, "auto") != 0 : s->setup.run.tier > 0)
    return vs_fail(err, VS_INPUT, "%s: only tier circuit can do that, and this is tier %s (%s)",
                   asks, s->tier->name, s->why);
  s->tier = &vs_tier_circuit;
  snprintf(s->why, sizeof s->why, "auto: %s asks for it", asks);
  s->frame = s->tier->frame(&s->setup);
  warn(s);
  s->n_record = 0;
  vs_status status = check_tolerance(s, err);
  return status ? status : read_record(s, err);
}

void vs_scene_free(vs_scene *s) {
  vs_setup_free(&s->setup);
  vs_tree_free(&s->tree);
}
