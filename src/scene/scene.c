/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "scene/scene.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "actuator/coil.h"
#include "deck/devices.h"
#include "deck/parts.h"
#include "scene/sections.h"
#include "syntax/units.h"

const vs_shelf vs_scene_shelf = {"scene", "scenes", ".yaml"},
               vs_scene_study_shelf = {"study", "studies", ".yaml"},
               vs_scene_fit_shelf = {"fit", "fits", ".yaml"};

/* True if switches of the deck are modulated, which no ideal tier can do. */
static bool is_modulated(const vs_scene *s) {
  return vs_deck_has_port(&s->setup.deck, vs_port_is_modulated);
}

/* Where the scene has that key; NULL: nowhere, or it has another word, or the key is obeyed on
 * every tier: `measure` is, where the scene asks for the quality of currents. */
static const vs_node *node_of(const vs_scene *s, const vs_tier_key *k) {
  const vs_node *node = vs_tree_child(vs_tree_child(s->tree.root, k->section), k->key);
  bool is_stretch = !strcmp(k->section, vs_setup_measure_section.name);
  if (is_stretch && vs_tree_child(s->tree.root, "quality")) return NULL;
  if (!node || !k->value) return node;
  return node->kind == VS_NODE_TEXT && !strcmp(node->text, k->value) ? node : NULL;
}

/* The first key, of those that this tier obeys and others do not, that the scene has; NULL: none.
 */
static const vs_tier_key *own_key(const vs_scene *s, const vs_tier *tier) {
  for (const vs_tier_key *k = tier->keys; k && k->section; k++)
    if (node_of(s, k)) return k;
  return NULL;
}

static bool obeys(const vs_tier *tier, const vs_tier_key *key) {
  for (const vs_tier_key *k = tier->keys; k && k->section; k++)
    if (!strcmp(k->section, key->section) && !strcmp(k->key, key->key)) return true;
  return false;
}

/* The scene's first probe that only a tier with a circuit has, which it records or measures, or
 * whose quality it asks for; NULL: none. */
static const char *probe_of_circuit(const vs_scene *s) {
  static const char *const LISTS[] = {"record", "quality"};
  const vs_frame circuit_frame = vs_sim_frame(vs_tiers_automatic(true), &s->setup);
  int first = vs_channel_deck(&s->setup.model);
  for (size_t k = 0; k < sizeof LISTS / sizeof *LISTS; k++) {
    const vs_node *list = vs_tree_child(s->tree.root, LISTS[k]);
    const vs_node *item = list && list->kind == VS_NODE_LIST ? list->child : list;
    for (; item; item = list->kind == VS_NODE_LIST ? item->next : NULL)
      if (item->kind == VS_NODE_TEXT && vs_channel_find(&circuit_frame, item->text) >= first)
        return item->text;
  }
  const vs_node *instruments = vs_tree_child(s->tree.root, "instruments");
  const char *name;
  for (int n = 0; (name = vs_instruments_names(instruments, n)); n++)
    if (vs_channel_find(&circuit_frame, name) >= first) return name;
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
  const vs_node *circuit = vs_tree_child(s->tree.root, "circuit");
  const vs_occurrence *event = first_event(s);
  const char *probe = probe_of_circuit(s);
  const vs_tier_key *key = own_key(s, vs_tiers_automatic(true));
  if (is_modulated(s))
    snprintf(buffer, size, "a deck with a port pwm, %s", HAS);
  else if (circuit && circuit->child)
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

/* The tier to take instead. */
static const char *circuit_tier(void) {
  return vs_tiers_automatic(true)->name;
}

static vs_status ignored_key(const vs_scene *s, const char *section, const vs_node *node,
                             vs_error *err) {
  if (!node) return VS_OK;
  if (s->tier->has_circuit)
    return vs_error_carry_on(
        err, vs_fail_at(err, node->key_where,
                        "%s.%s: tier %s (%s) has a deck between the mains and the coil and would "
                        "ignore %s; take tier %s, or leave the key out",
                        section, node->key, s->tier->name, s->why, node->text,
                        vs_tiers_automatic(false)->name));
  return vs_error_carry_on(
      err, vs_fail_at(err, node->key_where,
                      "%s.%s: tier %s (%s) has no circuit and would ignore it; take "
                      "tier %s or auto, or leave the key out",
                      section, node->key, s->tier->name, s->why, circuit_tier()));
}

static vs_status ignored_event(const vs_scene *s, const vs_occurrence *e, vs_error *err) {
  bool other = !isnan(e->gate_rad) && !vs_occurrence_at_gate(e, 0);
  if (e->kind->ideal && !other) return VS_OK;
  if (e->kind->ideal)
    vs_fail_at(err, e->where,
               "events.%s.gate: tier %s (%s) has one thyristor, whose gate is 'gate', and would "
               "ignore %s; take tier %s or auto",
               e->name, s->tier->name, s->why, e->v.gate, circuit_tier());
  else
    vs_fail_at(err, e->where,
               "events.%s: tier %s (%s) has an ideal thyristor between mains and coil, to which a "
               "%s is nothing; take tier %s or auto",
               e->name, s->tier->name, s->why, e->kind->name, circuit_tier());
  return vs_error_carry_on(err, VS_INPUT);
}

/* The keys of the scene that other tiers obey and this one does not. Where pulses come from ports
 * pwm alone, direct voltage and firing.valve: none are obeyed. */
static vs_status check_ignored_keys(const vs_scene *s, vs_error *err) {
  vs_status status = VS_OK;
  bool all = is_modulated(s) && !vs_deck_has_port(&s->setup.deck, vs_port_is_gated);
  for (int t = 0; t < VS_TIERS; t++)
    for (const vs_tier_key *k = vs_tiers_all[t]->keys; k && k->section && !status; k++)
      if (!obeys(s->tier, k) && !(all && s->tier->has_circuit))
        status = ignored_key(s, k->section, node_of(s, k), err);
  return status;
}

/* Where the scene says which law the coil has: by itself, or by its machine. */
static vs_where where_law(const vs_scene *s) {
  static const char *const KEYS[] = {"law", "saturation", "leakage"};
  const vs_node *map = vs_tree_child(s->tree.root, "actuator"), *law = NULL;
  for (size_t k = 0; k < sizeof KEYS / sizeof *KEYS && !law; k++) law = vs_tree_child(map, KEYS[k]);
  const vs_node *machine = vs_tree_child(vs_tree_child(s->tree.root, "machine"), "model");
  return law ? law->where : machine ? machine->where : (vs_where){0};
}

/* Is there no current without flux linkage, wherever the armature is? Tried at some gaps up to
 * twice the one at rest; 1e-9 A are rounding. */
static bool coil_is_dead(const vs_coil *coil) {
  char text[256];
  for (int k = 1; k <= 8; k++) {
    double z = coil->gap_rest_m * k / 4;
    bool known = !coil->law->beyond || !coil->law->beyond(coil, 0, z, text, sizeof text);
    if (known && !(fabs(vs_coil_current(coil, 0, z)) <= 1e-9)) return false;
  }
  return true;
}

/* Refuses a tier that cannot hold the coil's law. A circuit needs it as text for ngspice; the tier
 * with the gap at rest is made for one law; and an ideal thyristor that is off leaves the coil
 * without a voltage. */
static vs_status check_law(const vs_scene *s, vs_error *err) {
  const vs_coil *coil = &s->setup.model.coil;
  const vs_tier *tier = s->tier;
  const char *ideal = vs_tiers_automatic(false)->name;
  bool valve = !s->setup.timeline.firing.no_valve;
  if (!coil->law || coil->square) return VS_OK;
  if (tier->has_circuit && !coil->law->netlist)
    vs_fail_at(err, where_law(s),
               "actuator.law: tier %s (%s) has no netlist of the law %s; take tier %s", tier->name,
               s->why, coil->law->name, ideal);
  else if (tier->gap_at_rest)
    vs_fail_at(err, where_law(s),
               "actuator.law: tier %s (%s) knows i = lambda z/(2a) alone, and the coil has the law "
               "%s (%s); take tier %s",
               tier->name, s->why, coil->law->name, coil->law->text, ideal);
  else if (!tier->has_circuit && valve && !coil_is_dead(coil))
    vs_fail_at(err, where_law(s),
               "actuator.law: a coil with the law %s has a voltage while the thyristor of tier %s "
               "(%s) is off; write firing.valve: none, or take tier %s",
               coil->law->name, tier->name, s->why, circuit_tier());
  else
    return VS_OK;
  return vs_error_carry_on(err, VS_INPUT);
}

/* Refuses a tier without a circuit where elements of the deck read the machine's motion, as such a
 * circuit is no mains with an ideal thyristor. */
static vs_status check_feedback(const vs_scene *s, vs_error *err) {
  const vs_deck *deck = &s->setup.deck;
  if (s->tier->has_circuit || !deck->reads_eva.file) return VS_OK;
  return vs_error_carry_on(
      err, vs_fail_at(err, deck->reads_eva,
                      "an element reads the machine's motion at a node of %s, and tier %s (%s) has "
                      "no circuit; take tier %s or auto",
                      deck->eva, s->tier->name, s->why, circuit_tier()));
}

/* The deck's name alone is no conflict: it says what the tiers stand for. */
static vs_status check_ignored(const vs_scene *s, vs_error *err) {
  const vs_node *circuit = vs_tree_child(s->tree.root, "circuit");
  const vs_events *events = &s->setup.timeline.events;
  vs_status status = check_law(s, err);
  if (!status) status = check_feedback(s, err);
  if (status || s->tier->has_circuit) return status ? status : check_ignored_keys(s, err);
  if (is_modulated(s))
    return vs_fail_at(err, circuit ? circuit->where : (vs_where){0},
                      "circuit.deck: tier %s (%s) has no port pwm; take tier %s or auto",
                      s->tier->name, s->why, circuit_tier());
  for (const vs_node *n = circuit ? circuit->child : NULL; n && !status; n = n->next)
    if (strcmp(n->key, vs_deck_key.key)) status = ignored_key(s, "circuit", n, err);
  if (!status) status = check_ignored_keys(s, err);
  for (size_t k = 0; k < events->count && !status; k++)
    status = ignored_event(s, &events->item[k], err);
  return status;
}

/* A check carries on from a run.tier that is none; what is meant is then not known. */
static bool tier_is_known(const vs_scene *s) {
  const vs_node *word = vs_tree_child(vs_tree_child(s->tree.root, "run"), "tier");
  return !word || s->setup.run.tier > 0 ||
         (word->kind == VS_NODE_TEXT && !strcmp(word->text, "auto"));
}

static vs_status choose_tier(vs_scene *s, const char *named, vs_error *err) {
  const vs_tier_key *ideal = own_key(s, vs_tiers_automatic(false));
  char what[200];
  int choice = s->setup.run.tier;
  if (named && !strcmp(named, "auto"))
    choice = 0;
  else if (named) {
    s->tier = vs_tiers_find(named);
    if (!s->tier) return vs_fail(err, VS_INPUT, "--tier %s: there are: %s", named, vs_tiers_words);
    snprintf(s->why, sizeof s->why, "asked for by --tier");
    return VS_OK;
  }
  if (choice > 0) {
    s->tier = vs_tiers_all[choice - 1];
    snprintf(s->why, sizeof s->why, "asked for by run.tier");
  } else if (!tier_is_known(s)) {
    s->tier = vs_tiers_automatic(true); /* it has all probes */
  } else if (ideal && !is_modulated(s)) {
    s->tier = vs_tiers_automatic(false);
    snprintf(s->why, sizeof s->why, "auto: the scene names %s.%s: %s, which no circuit has",
             ideal->section, ideal->key, ideal->value ? ideal->value : "");
  } else if (needs_circuit(s, what, sizeof what)) {
    s->tier = vs_tiers_automatic(true);
    snprintf(s->why, sizeof s->why, "auto: the scene names %s", what);
  } else {
    s->tier = vs_tiers_automatic(false);
    snprintf(s->why, sizeof s->why, "auto: nothing in the scene needs the circuit tier");
  }
  return VS_OK;
}

static vs_status unknown_probe(const vs_scene *s, const vs_node *node, vs_error *err) {
  vs_frame full = vs_sim_frame(vs_tiers_automatic(true), &s->setup);
  const char *names[VS_CH_MOST];
  size_t n = 0;
  const char *name = node->kind == VS_NODE_TEXT ? node->text : "a list or map";
  if (s->setup.deck.lost & VS_LOST_PROBE) return VS_OK; /* a check carries on: it may be that one */
  if (vs_channel_find(&full, name) >= 0)
    return vs_fail_at(err, node->where,
                      "record: probe %s exists only on tier %s, and this is tier %s", name,
                      circuit_tier(), s->tier->name);
  int numbers[VS_CH_MOST], listed = vs_channel_listed(&full, numbers);
  for (int k = 0; k < listed; k++) names[n++] = vs_channel_at(&full, numbers[k]).name;
  for (int k = 0; k < s->instruments.count; k++)
    if (!strcmp(name, s->instruments.item[k].column))
      return vs_fail_at(err, node->where,
                        "record: %s is an instrument's column, which comes along by itself; leave "
                        "it out",
                        name);
  const char *nearest = vs_text_nearest(name, names, n);
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

const char vs_scene_all_probes[] = "all";

/* record: all | [NAME, ...] */
static vs_status read_record(vs_scene *s, vs_error *err) {
  const vs_node *node = vs_tree_child(s->tree.root, "record");
  if (!node ||
      (node->kind == VS_NODE_TEXT && (!*node->text || !strcmp(node->text, vs_scene_all_probes)))) {
    s->n_record = vs_channel_listed(&s->frame, s->record);
    return VS_OK;
  }
  if (node->kind == VS_NODE_MAP || (node->kind == VS_NODE_LIST && !node->child))
    return vs_fail_at(err, node->where,
                      "record: 'all' or a list of probes is wanted: [p, i, v_ak]");
  if (node->kind == VS_NODE_TEXT) return take_probe(s, node, err);
  vs_status status = VS_OK;
  for (const vs_node *item = node->child; item && !status; item = item->next)
    status = vs_error_carry_on(err, take_probe(s, item, err));
  return status;
}

/* measured: {NAME: VALUE UNIT, ...} */
static vs_status read_measured(vs_scene *s, vs_error *err) {
  const vs_node *map = vs_tree_child(s->tree.root, "measured");
  vs_measure all[VS_MOST_MEASURES];
  const char *names[VS_MOST_MEASURES];
  size_t count = 0;
  if (map && map->kind == VS_NODE_TEXT && !*map->text) map = NULL;
  if (map && map->kind != VS_NODE_MAP)
    return vs_fail_at(err, map->where, "measured: a map is wanted: {i_peak: 0.95 A, ...}");
  for (; vs_measure_at(&s->setup.model, (int)count, &all[count]); count++)
    names[count] = all[count].name;
  vs_status status = vs_field_known_keys(map, "measured", names, count, err);
  for (size_t k = 0; k < count && !status; k++) {
    const vs_node *node = vs_tree_child(map, names[k]);
    char why[256];
    if (!node) continue;
    s->measured[k].known = true;
    if (node->kind != VS_NODE_TEXT ||
        !vs_units_read(node->text, all[k].unit, &s->measured[k].value, why, sizeof why))
      status = vs_error_carry_on(
          err, vs_fail_at(err, node->where, "measured.%s: %s", names[k],
                          node->kind == VS_NODE_TEXT ? why : "one value is wanted"));
  }
  return status;
}

static vs_status check_tolerance(const vs_scene *s, vs_error *err) {
  const vs_node *node = vs_tree_child(vs_tree_child(s->tree.root, "run"), "tolerance");
  if (s->setup.run.tolerance >= s->tier->finest || !tier_is_known(s)) return VS_OK;
  return vs_fail_at(err, node ? node->where : (vs_where){0},
                    "run.tolerance: %g is finer than tier %s can hold; allowed there: %g..0.1",
                    s->setup.run.tolerance, s->tier->name, s->tier->finest);
}

enum { MOST_ROWS = 1000000000 }; /* of run.csv: some hundred gigabytes */

static vs_status check_rows(const vs_scene *s, vs_error *err) {
  const vs_run_values *run = &s->setup.run;
  const vs_node *map = vs_tree_child(s->tree.root, "run"), *node = vs_tree_child(map, "sample");
  if (run->until_s / run->sample_s <= MOST_ROWS) return VS_OK;
  if (!node) node = vs_tree_child(map, "until");
  return vs_fail_at(err, node ? node->where : (vs_where){0},
                    "run.sample: %g ms makes %.3g rows up to run.until = %g s; allowed there: "
                    "at least %g ms, for %d rows",
                    1e3 * run->sample_s, run->until_s / run->sample_s, run->until_s,
                    1e3 * run->until_s / MOST_ROWS, MOST_ROWS);
}

/* What the control's observer is not told. */
static void warn_of_observer(vs_scene *s) {
  const vs_node *section = vs_tree_child(s->tree.root, vs_control_section.name);
  const vs_observing *o = &s->control.observing;
  char text[512];
  if (o->system && vs_observing_note(o, &s->setup, text, sizeof text))
    vs_fail_at(vs_warnings_add(&s->warnings), section->key_where, "%s", text);
}

static void take_control_off(vs_scene *s) {
  const vs_node *section = vs_tree_child(s->tree.root, vs_control_section.name);
  if (!s->control.regulator) return;
  s->control.regulator = NULL;
  vs_fail_at(vs_warnings_add(&s->warnings), section->key_where,
             "control: it is off here: the orbit is that of the angle firing.angle = %g deg",
             s->setup.timeline.firing.angle.first / vs_units_factor("deg"));
}

/* Finds the warnings anew. */
static void warn(vs_scene *s) {
  s->warnings.count = 0;
  vs_warnings_of_scene(s->tree.root, &s->setup, &s->frame, &s->warnings);
  vs_warnings_of_instruments(&s->instruments, &s->warnings);
  vs_warnings_of_control(s->tree.root, &s->setup, &s->control, &s->instruments, &s->warnings);
  warn_of_observer(s);
  if (s->held) take_control_off(s);
}

void vs_scene_hold(vs_scene *s) {
  s->held = true;
  take_control_off(s);
}

void vs_scene_warn(const vs_scene *s) {
  for (size_t k = 0; k < s->warnings.count; k++)
    fprintf(stderr, "vibrospice: warning: %s\n", vs_warnings_text(&s->warnings.item[k]));
}

vs_status vs_scene_open(const char *name, vs_where where, vs_scene *s, vs_error *err) {
  if (s->opened) *s = (vs_scene){0};
  s->opened = true;
  vs_status status = vs_path_find(&vs_scene_shelf, name, where, s->path, err);
  return status ? status : vs_tree_read(s->path, &s->tree, err);
}

/* `start: steady` wants a tier that knows orbits. */
static vs_status check_start(const vs_scene *s, vs_error *err) {
  const vs_node *start = vs_tree_child(s->tree.root, "start");
  if (!s->setup.steady || !tier_is_known(s)) return VS_OK;
  return vs_tiers_require_orbits("start: steady", s->tier, s->why,
                                 start ? start->where : (vs_where){0}, err);
}

/* What follows from the setup. */
static vs_status conclude(vs_scene *s, const char *tier, vs_error *err) {
  vs_status status = choose_tier(s, tier, err);
  if (status) return status;
  s->frame = vs_sim_frame(s->tier, &s->setup);
  status = check_ignored(s, err);
  if (!status) status = vs_error_carry_on(err, check_start(s, err));
  if (!status) status = vs_error_carry_on(err, check_tolerance(s, err));
  if (!status) status = vs_error_carry_on(err, check_rows(s, err));
  return status;
}

/* Reads what names channels, of which another tier has others. */
static vs_status read_instruments(vs_scene *s, vs_error *err) {
  const vs_node *currents = vs_tree_child(s->tree.root, "quality");
  vs_status status = vs_quality_read(currents, &s->setup, &s->frame, &s->quality, err);
  if (status) return status;
  const vs_node *section = vs_tree_child(s->tree.root, "instruments");
  status = vs_instruments_read(section, &s->setup, &s->frame, &s->instruments, err);
  section = vs_tree_child(s->tree.root, vs_control_section.name);
  return status ? status : vs_control_read(section, &s->setup, &s->instruments, &s->control, err);
}

vs_status vs_scene_settle(vs_scene *s, const char *tier, vs_error *err) {
  vs_status status =
      vs_field_known_keys(s->tree.root, "a scene", vs_section_keys, VS_SECTION_KEYS, err);
  s->tier_named = tier;
  s->order = vs_tiers_order;
  if (!status) status = vs_setup_build(s->tree.root, &s->setup, err);
  if (!status) status = conclude(s, tier, err);
  if (status) return status;
  status = read_instruments(s, err);
  if (!status) status = vs_error_carry_on(err, read_record(s, err));
  if (!status) status = read_measured(s, err);
  warn(s);
  return status;
}

vs_status vs_scene_again(vs_scene *s, vs_error *err) {
  if (!vs_setup_keeps_deck(s->tree.root, &s->setup)) s->order.tried = false;
  vs_status status = vs_setup_again(s->tree.root, &s->setup, err);
  if (!status) status = conclude(s, NULL, err);
  if (!status) status = read_instruments(s, err);
  if (!status) warn(s);
  return status;
}

vs_status vs_scene_with(const vs_scene *s, const char *const *keys, size_t n_keys, vs_scene *other,
                        vs_error *err) {
  *other = (vs_scene){0};
  memcpy(other->path, s->path, sizeof other->path);
  other->allow_code = s->allow_code;
  other->held = s->held;
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
    status = vs_error_carry_on(err, vs_tree_set(&s->tree, sets[k], err));
  return status ? status : vs_scene_settle(s, tier, err);
}

vs_status vs_scene_take_circuit(vs_scene *s, const char *asks, vs_error *err) {
  const char *tier = s->tier_named;
  s->asks = asks;
  if (s->tier->has_circuit) return VS_OK;
  if (tier ? strcmp(tier, "auto") != 0 : s->setup.run.tier > 0)
    return vs_fail(err, VS_INPUT, "%s: only tier %s can do that, and this is tier %s (%s)", asks,
                   circuit_tier(), s->tier->name, s->why);
  s->tier = vs_tiers_automatic(true);
  snprintf(s->why, sizeof s->why, "auto: %s asks for it", asks);
  s->frame = vs_sim_frame(s->tier, &s->setup);
  warn(s);
  s->n_record = 0;
  vs_status status = check_ignored(s, err);
  if (!status) status = check_start(s, err);
  if (!status) status = check_tolerance(s, err);
  if (!status) status = read_instruments(s, err); /* another tier has other channels */
  return status ? status : read_record(s, err);
}

void vs_scene_free(vs_scene *s) {
  vs_control_free(&s->control);
  vs_instruments_free(&s->instruments);
  vs_warnings_free(&s->warnings);
  vs_setup_free(&s->setup);
  vs_tree_free(&s->tree);
}
