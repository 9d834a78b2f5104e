/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "probes.h"

#include <stdio.h>
#include <string.h>

#include "base/disjoint_sets.h"
#include "base/names.h"
#include "base/units.h"
#include "netlist/cards.h"
#include "netlist/words.h"

/* The nodes of a deck, but for those within subcircuits, and which of them branches join: a current
 * flows from each node of a group to each other one, and not by way of ground alone. */
typedef struct groups {
  vs_names numbers;      /* of the nodes, in the order in which they are named */
  vs_disjoint_sets sets; /* of these numbers; each is a group */
} groups;

/* The number of a node. One that no line has named yet is a group of its own. */
static size_t number_of(groups *g, vs_word node) {
  size_t k;
  if (vs_names_find(&g->numbers, node.at, node.n, &k)) return k;
  k = vs_disjoint_sets_add(&g->sets);
  vs_names_put(&g->numbers, node.at, node.n, k);
  return k;
}

/* The number that stands for the group of a node. */
static size_t group_of(groups *g, vs_word node) {
  const size_t k = number_of(g, node);
  return vs_disjoint_sets_find(&g->sets, k);
}

/* Takes the two nodes of a branch for one group. */
static void join_nodes(groups *g, vs_word a, vs_word b) {
  if (vs_words_is_ground(a) || vs_words_is_ground(b)) return;
  const size_t of_a = number_of(g, a), of_b = number_of(g, b);
  vs_disjoint_sets_join(&g->sets, of_a, of_b);
}

/* How many nodes of an element a current flows between; 0: none that is known. Sources that are
 * controlled, and instances, may have nodes of signals. */
static size_t pins_of(const vs_netlist_card *card) {
  if (card->kind != VS_CARDS_ELEMENT) return 0;
  return strchr("rcldvsw", card->letter) ? 2 : strchr("qjmz", card->letter) ? 3 : 0;
}

static void find_groups(const vs_cards *c, groups *g) {
  for (size_t k = 0; k < c->count; k = vs_cards_next(c, k)) {
    const vs_netlist_card *card = &c->card[k];
    for (size_t p = 1; p < pins_of(card); p++)
      for (size_t q = 0; q < p; q++)
        join_nodes(g, vs_cards_word(c, card, p), vs_cards_word(c, card, q));
  }
}

/* True where a current of the mains' or of the EVA's can flow through the node. */
static bool carries(const vs_deck *deck, groups *g, vs_word node) {
  const char *ends[] = {deck->eva_plus, deck->eva_minus};
  const vs_cards *c = vs_deck_cards(deck);
  if (vs_words_is_ground(node)) return false;
  const size_t group = group_of(g, node);
  for (size_t k = 0; k < 2; k++) {
    const vs_word eva = vs_words_of(ends[k]);
    if (!vs_words_is_ground(eva) && group_of(g, eva) == group) return true;
  }
  for (size_t k = 0; k < deck->n_lines; k++) {
    if (!vs_cards_is_external(c, &c->card[k])) continue;
    for (size_t p = 0; p < deck->n_ports; p++) {
      if (deck->ports[p].signal.drive != VS_PORT_MAINS) continue;
      if (!vs_words_is(c->card[k].name, deck->ports[p].source)) continue;
      for (size_t e = 0; e < 2; e++) {
        const vs_word end = vs_cards_word(c, &c->card[k], e);
        if (!vs_words_is_ground(end) && group_of(g, end) == group) return true;
      }
    }
  }
  return false;
}

/* The name in "v(NAME)" or "i(NAME)". */
static vs_word name_in(const char *term) {
  return (vs_word){term + 2, strcspn(term + 2, ")")};
}

/* True for the voltage of a node, or the current of a source, that lies between mains and EVA. */
static bool is_of_the_circuit(const vs_deck *deck, groups *g, const vs_term *term) {
  const vs_word name = name_in(term->plus);
  const vs_cards *c = vs_deck_cards(deck);
  if (*term->plus == 'v')
    return carries(deck, g, name) || (*term->minus && carries(deck, g, name_in(term->minus)));
  for (size_t k = 0; k < c->count; k++) {
    const vs_netlist_card *card = &c->card[k];
    if (card->kind != VS_CARDS_ELEMENT || vs_words_compare(card->name, name)) continue;
    if (carries(deck, g, vs_cards_word(c, card, 0)) || carries(deck, g, vs_cards_word(c, card, 1)))
      return true;
  }
  return false;
}

static vs_status check_unit(const vs_deck *deck, groups *g, const vs_probe *probe, vs_error *err) {
  const vs_term *term = &deck->terms[probe->term];
  const bool voltage = *term->plus == 'v';
  const char *unit = voltage ? "V" : "A";
  if (vs_units_same_kind(probe->unit, unit))
    return !strcmp(probe->unit, unit) || vs_units_factor(probe->unit) == 1
               ? VS_OK
               : vs_fail_at(err, probe->unit_at,
                            "probe %s: it is measured in %s, and '%s' would make another number of "
                            "it; write %s",
                            probe->name, unit, probe->unit, unit);
  if (!g->sets.count) find_groups(vs_deck_cards(deck), g);
  if (!is_of_the_circuit(deck, g, term) && (voltage || !vs_units_same_kind(probe->unit, "V")))
    return VS_OK;
  return vs_fail_at(err, probe->unit_at,
                    voltage ? "probe %s: this is a voltage, and '%s' is no unit of one; V is "
                              "wanted here, or i(V...) for a current"
                            : "probe %s: this is a current, and '%s' is no unit of one; A is "
                              "wanted here, or v(NODE) for a voltage",
                    probe->name, probe->unit);
}

vs_status vs_probes_check_units(const vs_deck *deck, vs_error *err) {
  groups g = {0};
  vs_status status = VS_OK;
  for (size_t k = 0; k < deck->n_probes && !status; k++)
    status = vs_error_keep(err, check_unit(deck, &g, &deck->probes[k], err));
  vs_names_free(&g.numbers);
  vs_disjoint_sets_free(&g.sets);
  return status;
}
