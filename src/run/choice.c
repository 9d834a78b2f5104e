/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "run/choice.h"

#include <stdio.h>
#include <string.h>

#include "measure/instruments.h"

bool vs_choice_is_modulated(const vs_setup *setup) {
  return vs_deck_has_port(&setup->deck, vs_port_is_modulated);
}

/* The key of the scene; or of its machine, where that says by a word how it is fed or fired. */
static const vs_node *find_key(const vs_node *root, const vs_setup *setup, const vs_tier_key *k) {
  const vs_node *node = vs_tree_child(vs_tree_child(root, k->section), k->key);
  const vs_machine *m = setup->machine;
  if (node || !m || m->lost || !k->value) return node;
  if (!strcmp(k->section, vs_feed_supply.name)) return vs_tree_child(m->own_supply, k->key);
  if (!strcmp(k->section, vs_feed_firing.name)) return vs_tree_child(m->own_firing, k->key);
  return NULL;
}

const vs_node *vs_choice_node(const vs_node *root, const vs_setup *setup, const vs_tier_key *k) {
  const vs_node *node = find_key(root, setup, k);
  bool is_stretch = !strcmp(k->section, vs_setup_measure_keys.name);
  if (is_stretch && vs_tree_child(root, "quality")) return NULL;
  if (!node || !k->value) return node;
  return node->kind == VS_NODE_TEXT && !strcmp(node->text, k->value) ? node : NULL;
}

/* The first key, of those that this tier obeys and others do not, that the scene has; NULL: none.
 */
static const vs_tier_key *own_key(const vs_node *root, const vs_setup *setup, const vs_tier *tier) {
  for (const vs_tier_key *k = tier->keys; k && k->section; k++)
    if (vs_choice_node(root, setup, k)) return k;
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
static const vs_occurrence *first_event(const vs_setup *setup) {
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
  const vs_occurrence *event = first_event(setup);
  const char *probe = probe_of_circuit(root, setup), *rating = rating_of_circuit(root, setup);
  const char *judged = vs_tree_child(root, "expect")  ? "expect"
                       : vs_tree_child(root, "waive") ? "waive"
                                                      : NULL;
  const vs_tier_key *key = own_key(root, setup, vs_tiers_automatic(true));
  if (vs_choice_is_modulated(setup))
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

bool vs_choice_is_known(const vs_node *root, const vs_setup *setup) {
  const vs_node *word = vs_tree_child(vs_tree_child(root, "run"), "tier");
  return !word || setup->run.tier > 0 ||
         (word->kind == VS_NODE_TEXT && !strcmp(word->text, "auto"));
}

vs_status vs_choice_make(const vs_node *root, const vs_setup *setup, const char *named,
                         const vs_tier **tier, char why[VS_CHOICE_WHY], vs_error *err) {
  const vs_tier_key *ideal = own_key(root, setup, vs_tiers_automatic(false));
  char what[200];
  int choice = setup->run.tier;
  if (named && !strcmp(named, "auto"))
    choice = 0;
  else if (named) {
    *tier = vs_tiers_find(named);
    if (!*tier) return vs_fail(err, VS_INPUT, "--tier %s: there are: %s", named, vs_tiers_words);
    snprintf(why, VS_CHOICE_WHY, "asked for by --tier");
    return VS_OK;
  }
  if (choice > 0) {
    *tier = vs_tiers_all[choice - 1];
    snprintf(why, VS_CHOICE_WHY, "asked for by run.tier");
  } else if (!vs_choice_is_known(root, setup)) {
    *tier = vs_tiers_automatic(true); /* it has all probes */
  } else if (ideal && !vs_choice_is_modulated(setup)) {
    const bool own = vs_tree_child(vs_tree_child(root, ideal->section), ideal->key);
    const vs_node *deck = vs_tree_child(vs_tree_child(root, "circuit"), "deck");
    *tier = vs_tiers_automatic(false);
    snprintf(why, VS_CHOICE_WHY, "auto: %s %s.%s: %s, which no circuit has",
             own ? "the scene names" : "its machine's file says", ideal->section, ideal->key,
             ideal->value ? ideal->value : "");
    if (!own && deck)
      return vs_fail_at(err, deck->where,
                        "circuit.deck: its machine's file says %s.%s: %s, which no circuit has; "
                        "give supply and firing for this deck, or leave circuit out",
                        ideal->section, ideal->key, ideal->value ? ideal->value : "");
  } else if (needs_circuit(root, setup, what, sizeof what)) {
    *tier = vs_tiers_automatic(true);
    snprintf(why, VS_CHOICE_WHY, "auto: the scene names %s", what);
  } else {
    *tier = vs_tiers_automatic(false);
    snprintf(why, VS_CHOICE_WHY, "auto: nothing in the scene needs the circuit tier");
  }
  return VS_OK;
}
