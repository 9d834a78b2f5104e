/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "diagnosis/comparator.h"

#include <ctype.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "netlist/expr.h"

/* ---- feedback ---- */

/* Marks the nodes that voltage sources alone connect to ground: no element can move their voltage.
 */
static void mark_fixed(const vs_wiring *w, bool *fixed) {
  bool changed = true;
  fixed[0] = true;
  while (changed) {
    changed = false;
    for (size_t k = 0; k < w->count; k++) {
      const vs_wire *wire = &w->wires[k];
      if (wire->letter != 'v' || fixed[wire->pins[0]] == fixed[wire->pins[1]]) continue;
      fixed[wire->pins[0]] = fixed[wire->pins[1]] = changed = true;
    }
  }
}

/* True where a node that has moved so far affects the element: as a pin, as a controlling node, or
 * through a controlling current. */
static bool feels(const vs_wiring *w, const vs_wire *wire, const bool *moved) {
  for (int k = 0; k < wire->n_pins; k++)
    if (moved[wire->pins[k]]) return true;
  for (int k = 0; k < wire->n_looks; k++)
    if (moved[wire->looks[k]]) return true;
  for (size_t k = 0; k < w->count && wire->law && strstr(wire->law, "i("); k++)
    if (vs_wiring_senses(wire, &w->wires[k]))
      for (int p = 0; p < w->wires[k].n_pins; p++)
        if (moved[w->wires[k].pins[p]]) return true;
  return false;
}

static bool move_pins(const vs_wire *wire, const bool *fixed, bool *moved) {
  bool changed = false;
  for (int p = 0; p < wire->n_pins; p++) {
    int node = wire->pins[p];
    changed = changed || (!fixed[node] && !moved[node]);
    moved[node] = moved[node] || !fixed[node];
  }
  return changed;
}

/* True where the element's effect on its pins comes back to what controls it. */
static bool is_fed_back(const vs_wiring *w, const vs_wire *from) {
  bool *fixed = vs_alloc(w->n_nodes, 1), *moved = vs_alloc(w->n_nodes, 1), found = false;
  mark_fixed(w, fixed);
  bool changed = move_pins(from, fixed, moved);
  while (changed) {
    changed = false;
    for (size_t k = 0; k < w->count; k++)
      if (feels(w, &w->wires[k], moved) && move_pins(&w->wires[k], fixed, moved)) changed = true;
  }
  for (int k = 0; k < from->n_looks; k++) found = found || moved[from->looks[k]];
  for (size_t k = 0; k < w->count && !found; k++)
    if (vs_wiring_senses(from, &w->wires[k]))
      for (int p = 0; p < w->wires[k].n_pins; p++) found = found || moved[w->wires[k].pins[p]];
  free(fixed);
  free(moved);
  return found;
}

/* True where the element is controlled by the voltage across itself. */
static bool looks_at_itself(const vs_wire *wire) {
  return wire->n_looks == 2 && wire->n_pins == 2 && wire->looks[0] == wire->pins[0] &&
         wire->looks[1] == wire->pins[1];
}

static void add(const vs_wiring *w, const vs_wire *wire, const char *text, vs_comparators *all) {
  if (all->count == VS_COMPARATORS_MOST || !is_fed_back(w, wire)) return;
  vs_comparator *c = &all->item[all->count++];
  *c = (vs_comparator){.wire = wire, .own = looks_at_itself(wire)};
  snprintf(c->text, sizeof c->text, "%s", text);
}

/* ---- switches ---- */

static bool is_none(vs_word value) {
  const char *s = value.at;
  while (s < value.at + value.n && strchr("0.+-{}eE", *s)) s++;
  return s == value.at + value.n;
}

/* A switch whose model states no hysteresis, or one of 0. */
static void look_at_switch(const vs_wiring *w, const vs_wire *wire, vs_comparators *all) {
  const bool current = wire->letter == 'w';
  char text[256];
  if (!wire->model || !wire->law) return;
  const vs_word hysteresis = vs_cards_value(w->cards, wire->model, current ? "ih" : "vh"),
                type = wire->model->model;
  vs_word level = vs_cards_value(w->cards, wire->model, current ? "it" : "vt");
  if (!level.n) level = vs_words_of("0");
  snprintf(text, sizeof text, "(%s)-(%.*s)", wire->law, (int)level.n, level.at);
  const bool ideal = vs_words_is(type, "vswitch") || vs_words_is(type, "iswitch");
  if (!ideal && (!hysteresis.n || is_none(hysteresis))) add(w, wire, text, all);
}

/* ---- expressions ---- */

/* Finds comparisons a > b, nested ones too, and arguments of functions that jump. */
static void look_at_law(const vs_wiring *w, const vs_wire *wire, vs_comparators *all) {
  static const char *const JUMPS[] = {"u", "sgn", "stp"};
  vs_expr e;
  char text[256];
  vs_expr_read(&e, vs_words_of(wire->law));
  for (size_t k = 1; k < e.count; k++) {
    const vs_expr_node *n = &e.node[k];
    const vs_word a = e.node[n->child].whole, b = e.node[e.node[n->child].next].whole;
    if (n->kind == VS_EXPR_OPERATOR && strchr("<>", *n->word.at)) {
      snprintf(text, sizeof text, "(%.*s)-(%.*s)", (int)a.n, a.at, (int)b.n, b.at);
      add(w, wire, text, all);
    }
    for (size_t j = 0; j < sizeof JUMPS / sizeof *JUMPS && n->kind == VS_EXPR_CALL; j++) {
      if (!vs_words_is(n->word, JUMPS[j]) || !n->child) continue;
      snprintf(text, sizeof text, "%.*s", (int)a.n, a.at);
      add(w, wire, text, all);
    }
  }
  vs_expr_free(&e);
}

void vs_comparator_find(const vs_wiring *w, vs_comparators *all) {
  all->count = 0;
  for (size_t k = 0; k < w->count && w->whole; k++) {
    const vs_wire *wire = &w->wires[k];
    if (strchr("sw", wire->letter))
      look_at_switch(w, wire, all);
    else if (wire->law && strchr("begrc", wire->letter))
      look_at_law(w, wire, all);
  }
}

const char *vs_comparator_cure(const vs_comparator *c) {
  return c->wire->letter == 's'   ? "give its model a hysteresis, as vh=0.1"
         : c->wire->letter == 'w' ? "give its model a hysteresis, as ih=1m"
                                  : "write a slope in the place of the jump, as "
                                    "(1+tanh((a-b)/0.01))/2 for a > b";
}

void vs_comparator_note(const vs_comparators *all, vs_notes *notes) {
  for (size_t k = 0; k < all->count; k++) {
    const vs_comparator *c = &all->item[k];
    if (!c->own || c->wire->letter != 's') continue;
    vs_fail_at(&vs_note_add(notes, "comparator", "warning")->text, vs_wiring_where(c->wire),
               "%s conducts by its own voltage and has no hysteresis: conducting lowers that "
               "voltage, so that it may turn over at every step; %s",
               c->wire->name, vs_comparator_cure(c));
  }
}
