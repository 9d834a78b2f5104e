/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "ignored.h"

#include <math.h>
#include <string.h>

#include "plant/coil.h"
#include "netlist/parts.h"
#include "run/choice.h"

/* A scene, a tier that is asked for, and why. */
typedef struct asked {
  const vs_node *root;
  const vs_setup *setup;
  const vs_tier *tier;
  const char *why;
} asked;

static bool obeys(const vs_tier *tier, const vs_tier_key *key) {
  for (const vs_tier_key *k = tier->keys; k && k->section; k++)
    if (!strcmp(k->section, key->section) && !strcmp(k->key, key->key)) return true;
  return false;
}

static vs_status ignored_key(const asked *s, const char *section, const vs_node *node,
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
                      section, node->key, s->tier->name, s->why, vs_tiers_circuit()));
}

static vs_status ignored_event(const asked *s, const vs_occurrence *e, vs_error *err) {
  bool other = !isnan(e->gate_rad) && !vs_occurrence_at_gate(e, 0);
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
  return vs_error_carry_on(err, VS_INPUT);
}

/* The keys of the scene that other tiers obey and this one does not. Where pulses come from ports
 * pwm alone, direct voltage and firing.valve: none are obeyed. */
static vs_status check_ignored_keys(const asked *s, vs_error *err) {
  vs_status status = VS_OK;
  bool all =
      vs_choice_is_modulated(s->setup) && !vs_deck_has_port(&s->setup->deck, vs_port_is_gated);
  for (int t = 0; t < VS_TIERS; t++)
    for (const vs_tier_key *k = vs_tiers_all[t]->keys; k && k->section && !status; k++)
      if (!obeys(s->tier, k) && !(all && s->tier->has_circuit))
        status = ignored_key(s, k->section, vs_choice_node(s->root, s->setup, k), err);
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
static vs_status check_law(const asked *s, vs_error *err) {
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
  return vs_error_carry_on(err, VS_INPUT);
}

/* Refuses a tier without a circuit where elements of the deck read the machine's motion, as such a
 * circuit is no mains with an ideal thyristor. */
static vs_status check_feedback(const asked *s, vs_error *err) {
  const vs_deck *deck = &s->setup->deck;
  if (s->tier->has_circuit || !deck->reads_eva.file) return VS_OK;
  return vs_error_carry_on(
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
      status = vs_error_carry_on(
          err, vs_fail_at(err, node->key_where,
                          "%s: tier %s (%s) has no devices %s; take tier %s or auto, or leave the "
                          "key out",
                          OF[k].key, s->tier->name, s->why, OF[k].what, vs_tiers_circuit()));
  }
  return status;
}

vs_status vs_ignored_check(const vs_node *root, const vs_setup *setup, const vs_tier *tier,
                           const char *why, vs_error *err) {
  const asked all = {root, setup, tier, why}, *s = &all;
  const vs_node *circuit = vs_tree_child(s->root, "circuit");
  const vs_events *events = &s->setup->timeline.events;
  vs_status status = check_law(s, err);
  if (!status) status = check_feedback(s, err);
  if (status || s->tier->has_circuit) return status ? status : check_ignored_keys(s, err);
  if (vs_choice_is_modulated(s->setup))
    return vs_fail_at(err, vs_tree_place(s->root, "circuit.deck"),
                      "circuit.deck: tier %s (%s) has no port pwm; take tier %s or auto",
                      s->tier->name, s->why, vs_tiers_circuit());
  for (const vs_node *n = circuit ? circuit->child : NULL; n && !status; n = n->next)
    if (n->key && strcmp(n->key, vs_deck_key.key)) /* a list has none, and is refused elsewhere */
      status = ignored_key(s, "circuit", n, err);
  if (!status) status = check_ignored_keys(s, err);
  if (!status) status = refuse_of_devices(s, err);
  for (size_t k = 0; k < events->count && !status; k++)
    status = ignored_event(s, &events->item[k], err);
  return status;
}
