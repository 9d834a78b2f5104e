/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnosis/floating.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/disjoint_sets.h"

/* Puts each node into a set of its own. */
static vs_disjoint_sets sets_of(const vs_wiring *w) {
  vs_disjoint_sets sets = {0};
  for (size_t k = 0; k < w->n_nodes; k++) vs_disjoint_sets_add(&sets);
  return sets;
}

/* Joins the sets of two pins; false: they were in one set already. */
static bool join(vs_disjoint_sets *sets, int a, int b) {
  return vs_disjoint_sets_join(sets, (size_t)a, (size_t)b);
}

/* ---- a way to ground ---- */

static bool looks_at(const vs_wire *wire, int node) {
  for (int k = 0; k < wire->n_looks; k++)
    if (wire->looks[k] == node) return true;
  return false;
}

/* True for an element that determines the voltage between its pins: by a conductance, a charge or a
 * source. A current source does so if its current depends on its own voltage. */
static bool holds(const vs_wire *wire) {
  if (wire->voltage || !strchr("bgif", wire->letter)) return true;
  for (int k = 0; k < wire->n_pins; k++)
    if (wire->pins[k] != 0 && looks_at(wire, wire->pins[k])) return true;
  return false;
}

static const vs_wire *first_at(const vs_wiring *w, vs_disjoint_sets *sets, size_t root) {
  for (size_t k = 0; k < w->count; k++)
    for (int p = 0; p < w->wires[k].n_pins; p++)
      if (vs_disjoint_sets_find(sets, (size_t)w->wires[k].pins[p]) == root) return &w->wires[k];
  return NULL;
}

static const vs_wire *first_looking(const vs_wiring *w, int node) {
  for (size_t k = 0; k < w->count; k++)
    if (looks_at(&w->wires[k], node)) return &w->wires[k];
  return NULL;
}

/* Adds the names of the first four nodes of a set. */
static void name_nodes(const vs_wiring *w, vs_disjoint_sets *sets, size_t root, vs_text *names) {
  int count = 0;
  for (size_t k = 1; k < w->n_nodes; k++)
    if (vs_disjoint_sets_find(sets, k) == root && count++ < 4)
      vs_text_add(names, "%s%s", count > 1 ? ", " : "", w->nodes[k]);
  if (count > 4) vs_text_add(names, " and %d more", count - 4);
}

/* True for a node inside the EVA, such as its gap. The EVA is the program's own subcircuit, which
 * is not opened. */
static bool is_in_eva(const vs_wiring *w, size_t node) {
  size_t n = strlen(w->deck->eva);
  return n > 0 && !strncmp(w->nodes[node], w->deck->eva, n) && w->nodes[node][n] == '.';
}

static void tell_group(const vs_wiring *w, vs_disjoint_sets *sets, size_t root, vs_notes *notes) {
  const vs_wire *at = first_at(w, sets, root), *looking = first_looking(w, (int)root);
  vs_text names = {0};
  name_nodes(w, sets, root, &names);
  if (at)
    vs_fail_at(&vs_note_add(notes, "floating", "warning")->text, vs_wiring_where(at),
               "%s: nothing but current sources leads to ground from node %s, so that no voltage "
               "there is right or wrong: ngspice ends with 'singular matrix', or takes any; one "
               "element mends it, as 'Rfloat %s 0 1G'",
               at->name, names.text, w->nodes[root]);
  else if (looking)
    vs_fail_at(&vs_note_add(notes, "floating", "warning")->text, vs_wiring_where(looking),
               "%s looks at node %s, which no element is connected to; is it misspelt?",
               looking->name, names.text);
  vs_text_free(&names);
}

static void find_groups(const vs_wiring *w, vs_notes *notes) {
  vs_disjoint_sets sets = sets_of(w);
  for (size_t k = 0; k < w->count; k++)
    for (int p = 1; p < w->wires[k].n_pins && holds(&w->wires[k]); p++)
      join(&sets, w->wires[k].pins[0], w->wires[k].pins[p]);
  for (size_t k = 1; k < w->n_nodes; k++)
    if (vs_disjoint_sets_find(&sets, k) == k && !is_in_eva(w, k)) tell_group(w, &sets, k, notes);
  vs_disjoint_sets_free(&sets);
}

/* ---- open ends ---- */

/* True where the deck itself uses the node's voltage. */
static bool is_probed(const vs_deck *deck, const char *node) {
  char signal[VS_DECK_NAME + 4];
  snprintf(signal, sizeof signal, "v(%.60s)", node);
  for (size_t k = 0; k < deck->n_terms; k++)
    if (!strcmp(deck->terms[k].plus, signal) || !strcmp(deck->terms[k].minus, signal)) return true;
  return false;
}

/* Notes elements with two pins of which one is connected to nothing else: they carry no current.
 * Open ends inside an instance are left to the author of the subcircuit. */
static void find_open_ends(const vs_wiring *w, vs_notes *notes) {
  int *ends = vs_alloc(w->n_nodes, sizeof *ends);
  for (size_t k = 0; k < w->count; k++) {
    for (int p = 0; p < w->wires[k].n_pins; p++) ends[w->wires[k].pins[p]]++;
    for (int p = 0; p < w->wires[k].n_looks; p++) ends[w->wires[k].looks[p]]++;
  }
  for (size_t k = 0; k < w->count; k++) {
    const vs_wire *wire = &w->wires[k];
    for (int p = 0; p < wire->n_pins && strchr("rlcds", wire->letter); p++) {
      const char *node = w->nodes[wire->pins[p]];
      if (!wire->pins[p] || ends[wire->pins[p]] > 1 || strchr(node, '.') ||
          is_probed(w->deck, node))
        continue;
      vs_fail_at(&vs_note_add(notes, "open", "warning")->text, vs_wiring_where(wire),
                 "%s: nothing else is connected to node %s, so that it carries no current; is the "
                 "node misspelt?",
                 wire->name, node);
    }
  }
  free(ends);
}

/* ---- loops ---- */

/* Notes loops that consist of voltage sources alone: their currents have no solution, or infinitely
 * many. */
static void find_loops(const vs_wiring *w, vs_notes *notes) {
  vs_disjoint_sets sets = sets_of(w);
  for (size_t k = 0; k < w->count; k++) {
    const vs_wire *wire = &w->wires[k];
    if (!wire->voltage || wire->n_pins < 2 || join(&sets, wire->pins[0], wire->pins[1])) continue;
    vs_fail_at(
        &vs_note_add(notes, "loop", "warning")->text, vs_wiring_where(wire),
        "%s closes a loop of voltage sources, nodes %s and %s: no current there is right or "
        "wrong, and ngspice ends with 'singular matrix'; a resistance in series mends it, as "
        "1 mohm",
        wire->name, w->nodes[wire->pins[0]], w->nodes[wire->pins[1]]);
  }
  vs_disjoint_sets_free(&sets);
}

void vs_floating_find(const vs_wiring *w, vs_notes *notes) {
  if (!w->whole) return;
  find_groups(w, notes);
  find_open_ends(w, notes);
  find_loops(w, notes);
}
