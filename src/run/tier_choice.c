/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/tier_choice.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "measure/instruments.h"
#include "plant/coil.h"

/* ---- which tier ---- */

/* True if switches of the scene's deck are modulated, which no ideal tier can do. */
static bool is_deck_modulated(const vs_setup *setup) {
  return vs_deck_has_port(&setup->deck, vs_port_is_modulated);
}

/* The key of the scene; or of its machine, where that says by a word how it is fed or fired. */
static const vs_node *find_tier_key(const vs_node *root, const vs_setup *setup,
                                    const vs_tier_key *k) {
  const vs_node *node = vs_tree_child(vs_tree_child(root, k->section), k->key);
  const vs_machine *m = setup->machine;
  if (node || !m || m->lost || !k->value) return node;
  if (!strcmp(k->section, vs_feed_supply.name)) return vs_tree_child(m->own_supply, k->key);
  if (!strcmp(k->section, vs_feed_firing.name)) return vs_tree_child(m->own_firing, k->key);
  return NULL;
}

/* Returns the scene's value of that key, or its machine's. NULL: they do not have the key, or has
 * another word there, or every tier obeys it, as `measure` in a scene that asks for the quality of
 * currents. */
static const vs_node *node_of_key(const vs_node *root, const vs_setup *setup,
                                  const vs_tier_key *k) {
  const vs_node *node = find_tier_key(root, setup, k);
  bool is_stretch = !strcmp(k->section, vs_setup_measure_keys.name);
  if (is_stretch && vs_tree_child(root, "quality")) return NULL;
  if (!node || !k->value) return node;
  return node->kind == VS_NODE_TEXT && !strcmp(node->text, k->value) ? node : NULL;
}

/* The first key, of those that this tier obeys and others do not, that the scene has; NULL: none.
 */
static const vs_tier_key *first_own_key(const vs_node *root, const vs_setup *setup,
                                        const vs_tier *tier) {
  for (const vs_tier_key *k = tier->keys; k && k->section; k++)
    if (node_of_key(root, setup, k)) return k;
  return NULL;
}

/* The scene's first probe that only a tier with a circuit has, which it records or measures, or
 * whose quality it asks for; NULL: none. */
static const char *probe_of_circuit(const vs_node *root, const vs_setup *setup) {
  static const char *const LISTS[] = {"record", "quality"};
  const vs_frame circuit_frame = vs_sim_frame(vs_tiers_automatic(true), setup);
  int first = vs_channel_deck(&setup->model);
  for (size_t k = 0; k < sizeof LISTS / sizeof *LISTS; k++) {
    const vs_node *list = vs_tree_child(root, LISTS[k]);
    const vs_node *item = list && list->kind == VS_NODE_LIST ? list->child : list;
    for (; item; item = list->kind == VS_NODE_LIST ? item->next : NULL)
      if (item->kind == VS_NODE_TEXT && vs_channel_find(&circuit_frame, item->text) >= first)
        return item->text;
  }
  const vs_node *instruments = vs_tree_child(root, "instruments"), *at = NULL;
  const char *name;
  while ((name = vs_instruments_names(instruments, &at)))
    if (vs_channel_find(&circuit_frame, name) >= first) return name;
  return NULL;
}

/* True if a name is a probe's, one of its two extremes, or a measure of a device of the deck. */
static bool is_of_circuit(const char *name, const vs_setup *setup) {
  const vs_deck *deck = &setup->deck;
  for (size_t k = 0; k < deck->n_probes; k++) {
    size_t n = strlen(deck->probes[k].name);
    if (!strncmp(name, deck->probes[k].name, n) &&
        (!name[n] || !strcmp(name + n, "_min") || !strcmp(name + n, "_max")))
      return true;
  }
  for (size_t k = 0; k < deck->n_devices; k++) {
    size_t n = strlen(deck->devices[k].name);
    if (!strncmp(name, deck->devices[k].name, n) && (!name[n] || name[n] == '.')) return true;
  }
  return false;
}

/* The scene's first rating of what only a tier with a circuit has; NULL: none. */
static const char *rating_of_circuit(const vs_node *root, const vs_setup *setup) {
  const vs_node *ratings = vs_tree_child(root, "ratings");
  for (const vs_node *n = ratings && ratings->kind == VS_NODE_MAP ? ratings->child : NULL; n;
       n = n->next)
    if (is_of_circuit(n->key, setup)) return n->key;
  return NULL;
}

/* Of the scene's events the first that no other tier has; if there is none, the first; NULL: it has
 * no events. */
static const vs_scene_event *first_event(const vs_setup *setup) {
  const vs_events *events = &setup->timeline.events;
  for (size_t k = 0; k < events->count; k++)
    if (!events->item[k].kind->ideal) return &events->item[k];
  return events->count ? events->item : NULL;
}

/* Why the scene needs the circuit tier: what it names that only that one has, or tells all of.
 * NULL: it does not. */
static const char *needs_circuit(const vs_node *root, const vs_setup *setup, char *buffer,
                                 size_t size) {
  static const char *const HAS = "which only this tier has";
  const vs_node *circuit = vs_tree_child(root, "circuit");
  const vs_scene_event *event = first_event(setup);
  const char *probe = probe_of_circuit(root, setup), *rating = rating_of_circuit(root, setup);
  const char *judged = vs_tree_child(root, "expect")  ? "expect"
                       : vs_tree_child(root, "waive") ? "waive"
                                                      : NULL;
  const vs_tier_key *key = first_own_key(root, setup, vs_tiers_automatic(true));
  if (is_deck_modulated(setup))
    snprintf(buffer, size, "a deck with a port pwm, %s", HAS);
  else if (circuit && circuit->child)
    snprintf(buffer, size, "circuit.%s, %s", circuit->child->key, HAS);
  else if (key)
    snprintf(buffer, size, "%s.%s, %s", key->section, key->key, HAS);
  else if (event)
    snprintf(buffer, size, "events.%s, %s", event->name,
             event->kind->ideal ? "and only this tier tells how the devices bear it" : HAS);
  else if (judged)
    snprintf(buffer, size, "%s, and only this tier has devices", judged);
  else if (setup->cooling.stated)
    snprintf(buffer, size, "%s, and only this tier has devices",
             vs_tree_child(root, "ambient") ? "ambient" : "heatsink");
  else if (probe)
    snprintf(buffer, size, "probe %s, %s", probe, HAS);
  else if (rating)
    snprintf(buffer, size, "ratings.%s, %s", rating, HAS);
  else
    return NULL;
  return buffer;
}

bool vs_tier_choice_is_known(const vs_node *root, const vs_setup *setup) {
  const vs_node *word = vs_tree_child(vs_tree_child(root, "run"), "tier");
  return !word || setup->run.tier > 0 ||
         (word->kind == VS_NODE_TEXT && !strcmp(word->text, "auto"));
}

/* "asked for by run.tier". A circuit that ngspice does not solve is told besides: a study has some
 * of its cases judged by ngspice (study/judge.h), a run has not. */
static void tell_who_asked(const vs_tier *tier, const char *who, char why[VS_TIER_CHOICE_WHY]) {
  snprintf(why, VS_TIER_CHOICE_WHY, "asked for by %s%s", who,
           tier->has_circuit && !tier->by_ngspice
               ? "; solved by the program itself, not by ngspice, which judges it in studies alone"
               : "");
}

vs_status vs_tier_choice_make(const vs_node *root, const vs_setup *setup, const char *named,
                              const vs_tier **tier, char why[VS_TIER_CHOICE_WHY], vs_error *err) {
  const vs_tier_key *ideal = first_own_key(root, setup, vs_tiers_automatic(false));
  char what[200];
  int choice = setup->run.tier;
  if (named && !strcmp(named, "auto"))
    choice = 0;
  else if (named) {
    *tier = vs_tiers_find(named);
    if (!*tier) return vs_fail(err, VS_INPUT, "--tier %s: there are: %s", named, vs_tiers_words);
    tell_who_asked(*tier, "--tier", why);
    return VS_OK;
  }
  if (choice > 0) {
    *tier = vs_tiers_all[choice - 1];
    tell_who_asked(*tier, "run.tier", why);
  } else if (!vs_tier_choice_is_known(root, setup)) {
    *tier = vs_tiers_automatic(true); /* it has all probes */
  } else if (ideal && !is_deck_modulated(setup)) {
    const bool own = vs_tree_child(vs_tree_child(root, ideal->section), ideal->key);
    const vs_node *deck = vs_tree_child(vs_tree_child(root, "circuit"), "deck");
    *tier = vs_tiers_automatic(false);
    snprintf(why, VS_TIER_CHOICE_WHY,
             "auto: %s %s.%s: %s, which of all decks only those with a port pwm have",
             own ? "the scene names" : "its machine's file says", ideal->section, ideal->key,
             ideal->value ? ideal->value : "");
    if (!own && deck)
      return vs_fail_at(err, deck->where,
                        "circuit.deck: its machine's file says %s.%s: %s, which of all decks only "
                        "those with a port pwm have; take such a deck, give supply and firing for "
                        "this one, or leave circuit out",
                        ideal->section, ideal->key, ideal->value ? ideal->value : "");
  } else if (needs_circuit(root, setup, what, sizeof what)) {
    *tier = vs_tiers_automatic(true);
    snprintf(why, VS_TIER_CHOICE_WHY, "auto: the scene names %s", what);
  } else {
    *tier = vs_tiers_automatic(false);
    snprintf(why, VS_TIER_CHOICE_WHY, "auto: nothing in the scene needs the circuit tier");
  }
  return VS_OK;
}

/* ---- what a tier would ignore, or could not hold: keys, events, the coil's law ---- */

/* A scene, a tier that is asked for, and why. */
typedef struct asked {
  const vs_node *root;
  const vs_setup *setup;
  const vs_tier *tier;
  const char *why;
} asked;

/* Keys of the section run that are ngspice's settings, or say what is done in its place. */
static bool is_of_ngspice(const vs_tier_key *key) {
  static const char *const KEYS[] = {"method", "first_step",    "trtol",
                                     "pivrel", "leave_circuit", "ladder"};
  bool is = false;
  for (size_t k = 0; k < sizeof KEYS / sizeof *KEYS; k++) is = is || !strcmp(key->key, KEYS[k]);
  return is && !strcmp(key->section, "run");
}

static bool obeys(const vs_tier *tier, const vs_tier_key *key) {
  if (tier->has_circuit && !tier->by_ngspice && is_of_ngspice(key)) return false;
  for (const vs_tier_key *k = tier->keys; k && k->section; k++)
    if (!strcmp(k->section, key->section) && !strcmp(k->key, key->key)) return true;
  return false;
}

/* The default of a key of the section run; empty: it is no such key. */
static const char *default_of(const char *section, const vs_node *node) {
  const vs_section *run = &vs_setup_run_keys;
  for (size_t k = 0; k < run->count && !strcmp(section, run->name); k++)
    if (!strcmp(run->fields[k].key, node->key)) return run->fields[k].default_text;
  return "";
}

/* A key of the section run that the scene gives its default: to ignore it changes nothing. A study
 * of a scene with another value takes it back so. */
static bool is_default(const char *section, const vs_node *node) {
  return node->kind == VS_NODE_TEXT && *node->text &&
         !strcmp(default_of(section, node), node->text);
}

static vs_status refuse_ignored_key(const asked *s, const char *section, const vs_node *node,
                                    vs_error *err) {
  if (!node || (s->tier->has_circuit && is_default(section, node))) return VS_OK;
  if (s->tier->has_circuit && !strcmp(section, "run"))
    return vs_error_keep(
        err, vs_fail_at(err, node->key_where,
                        "%s.%s: tier %s (%s) does not run ngspice and would ignore it; take tier "
                        "%s, or the key's default: --set %s.%s=%s",
                        section, node->key, s->tier->name, s->why, vs_tiers_circuit(), section,
                        node->key, default_of(section, node)));
  if (s->tier->has_circuit)
    return vs_error_keep(
        err, vs_fail_at(err, node->key_where,
                        "%s.%s: tier %s (%s) has a deck between the mains and the coil and would "
                        "ignore %s; take tier %s, or leave the key out",
                        section, node->key, s->tier->name, s->why, node->text,
                        vs_tiers_automatic(false)->name));
  return vs_error_keep(err,
                       vs_fail_at(err, node->key_where,
                                  "%s.%s: tier %s (%s) has no circuit and would ignore it; take "
                                  "tier %s or auto, or leave the key out",
                                  section, node->key, s->tier->name, s->why, vs_tiers_circuit()));
}

static vs_status refuse_ignored_event(const asked *s, const vs_scene_event *e, vs_error *err) {
  bool other = !isnan(e->gate_rad) && !vs_scene_event_at_gate(e, 0);
  if (e->kind->ideal && !other) return VS_OK;
  if (e->kind->ideal)
    vs_fail_at(err, e->where,
               "events.%s.gate: tier %s (%s) has one thyristor, whose gate is 'gate', and would "
               "ignore %s; take tier %s or auto",
               e->name, s->tier->name, s->why, e->v.gate, vs_tiers_circuit());
  else
    vs_fail_at(err, e->where,
               "events.%s: tier %s (%s) has an ideal thyristor between mains and coil, to which a "
               "%s is nothing; take tier %s or auto",
               e->name, s->tier->name, s->why, e->kind->name, vs_tiers_circuit());
  return vs_error_keep(err, VS_INPUT);
}

/* The keys of the scene that other tiers obey and this one does not. Where pulses come from ports
 * pwm alone, direct voltage and firing.valve: none are obeyed. */
static vs_status check_ignored_keys(const asked *s, vs_error *err) {
  vs_status status = VS_OK;
  bool all = is_deck_modulated(s->setup) && !vs_deck_has_port(&s->setup->deck, vs_port_is_gated);
  for (int t = 0; t < VS_TIERS; t++)
    for (const vs_tier_key *k = vs_tiers_all[t]->keys; k && k->section && !status; k++)
      if (!obeys(s->tier, k) && !(all && s->tier->has_circuit))
        status = refuse_ignored_key(s, k->section, node_of_key(s->root, s->setup, k), err);
  return status;
}

/* Where the scene says which law the coil has: by itself, or by its machine. */
static vs_where where_law(const asked *s) {
  static const char *const KEYS[] = {"law", "saturation", "leakage"};
  const vs_node *map = vs_tree_child(s->root, "actuator"), *law = NULL;
  for (size_t k = 0; k < sizeof KEYS / sizeof *KEYS && !law; k++) law = vs_tree_child(map, KEYS[k]);
  return law ? law->where : vs_tree_place(s->root, "machine.model");
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
static vs_status check_law_on_tier(const asked *s, vs_error *err) {
  const vs_coil *coil = &s->setup->model.coil;
  const vs_tier *tier = s->tier;
  const char *ideal = vs_tiers_automatic(false)->name;
  bool valve = !s->setup->timeline.firing.no_valve;
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
               coil->law->name, tier->name, s->why, vs_tiers_circuit());
  else
    return VS_OK;
  return vs_error_keep(err, VS_INPUT);
}

/* Refuses a tier without a circuit where elements of the deck read the machine's motion, as such a
 * circuit is no mains with an ideal thyristor. */
static vs_status check_feedback(const asked *s, vs_error *err) {
  const vs_deck *deck = &s->setup->deck;
  if (s->tier->has_circuit || !deck->reads_eva.file) return VS_OK;
  return vs_error_keep(
      err, vs_fail_at(err, deck->reads_eva,
                      "an element reads the machine's motion at a node of %s, and tier %s (%s) has "
                      "no circuit; take tier %s or auto",
                      deck->eva, s->tier->name, s->why, vs_tiers_circuit()));
}

/* Keys that are of the devices of a circuit. */
static vs_status refuse_of_devices(const asked *s, vs_error *err) {
  static const struct {
    const char *key, *what;
  } OF[] = {{"expect", "to which anything could happen"},
            {"ambient", "that could become hot"},
            {"heatsink", "that could become hot"}};
  vs_status status = VS_OK;
  for (size_t k = 0; k < sizeof OF / sizeof *OF && !status; k++) {
    const vs_node *node = vs_tree_child(s->root, OF[k].key);
    if (node)
      status = vs_error_keep(
          err, vs_fail_at(err, node->key_where,
                          "%s: tier %s (%s) has no devices %s; take tier %s or auto, or leave the "
                          "key out",
                          OF[k].key, s->tier->name, s->why, OF[k].what, vs_tiers_circuit()));
  }
  return status;
}

vs_status vs_tier_choice_check(const vs_node *root, const vs_setup *setup, const vs_tier *tier,
                               const char *why, vs_error *err) {
  const asked all = {root, setup, tier, why}, *s = &all;
  const vs_node *circuit = vs_tree_child(s->root, "circuit");
  const vs_events *events = &s->setup->timeline.events;
  vs_status status = check_law_on_tier(s, err);
  if (!status) status = check_feedback(s, err);
  if (status || s->tier->has_circuit) return status ? status : check_ignored_keys(s, err);
  if (is_deck_modulated(s->setup))
    return vs_fail_at(err, vs_tree_place(s->root, "circuit.deck"),
                      "circuit.deck: tier %s (%s) has no port pwm; take tier %s or auto",
                      s->tier->name, s->why, vs_tiers_circuit());
  for (const vs_node *n = circuit ? circuit->child : NULL; n && !status; n = n->next)
    if (n->key && strcmp(n->key, vs_deck_key.key)) /* a list has none, and is refused elsewhere */
      status = refuse_ignored_key(s, "circuit", n, err);
  if (!status) status = check_ignored_keys(s, err);
  if (!status) status = refuse_of_devices(s, err);
  for (size_t k = 0; k < events->count && !status; k++)
    status = refuse_ignored_event(s, &events->item[k], err);
  return status;
}
